"""An axis is simulated once for all candidates that have it alike, and no number changes by it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pzt_ident.engine import gather
from pzt_ident.engine.distinct import columns_of_axes, distinct
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.block import Coupling, Term
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks, word_of
from rig import candidates, model, record

T = 1e-3 * np.arange(500)
DRIVES = 50 + 50 * np.sin(2 * np.pi * 7 * T), 60 * np.sin(2 * np.pi * 11 * T)
FORMS = [item for word in blocks.effects() for item in blocks.forms(word)]
COUNT = 12


def stepped(*words):
    """A simulator of two axes, and candidates of which each differs from the first in one parameter."""
    made = model(*blocks.chain(words), axes=2)
    start, other = candidates(made, np.array(DRIVES), 2, seed=4, response=1e-5)
    theta = np.tile(start, (1 + len(made.entries), 1))
    theta[1:][np.diag_indices(len(made.entries))] = other
    return Simulator(made, record(*DRIVES, response=1e-7 * np.array(DRIVES))), theta


def results(simulator, theta):
    return simulator.simulate(theta), simulator.errors(theta)[:, :, simulator.record.settle :], simulator.squares(theta)


def weights_of(count):
    """The difference of each candidate from the first, and the first."""
    weights = np.eye(count)
    weights[1:, 0] = -1
    return weights


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("beside", [["bouc_wen"], ["prandtl_ishlinskii"], ["bouc_wen", "drift"]], ids=" ".join)
def test_what_is_simulated_once_leaves_every_bit_as_it_is(beside, form, monkeypatch):
    if issubclass(blocks[form], Term) and not any(block.holds(blocks[form]) for block in blocks.chain(beside)):
        return
    if word_of(form) in beside:
        return
    simulator, theta = stepped(*beside, form)
    apart = not any(issubclass(block, Coupling) for block in simulator.model.blocks)
    fewer = simulator.distinct(theta)
    assert (len(fewer.theta) < len(theta)) == apart
    found = results(simulator, theta)
    parts, failed = gather.rotated(simulator, theta, weights_of(len(theta)))
    monkeypatch.setattr(simulator, "_columns", [])
    for one, other in zip(found, results(simulator, theta), strict=True):
        np.testing.assert_array_equal(one, other)
    whole, broken = gather.rotated(simulator, theta, weights_of(len(theta)))
    np.testing.assert_array_equal(failed, broken)
    if not failed.any():
        for one, other in zip(parts, whole, strict=True):
            size = np.sqrt(np.diag(other.T @ other))
            np.testing.assert_allclose(one.T @ one, other.T @ other, rtol=0, atol=1e-9 * np.outer(size, size).max())


@given(st.integers(0, 10_000), st.integers(1, 4), st.integers(1, 4), st.integers(1, 3))
def test_each_candidate_has_its_axes_among_the_fewest(seed, first, second, kinds):
    """Candidates of a few kinds of each axis."""
    rng = np.random.default_rng(seed)
    columns = np.split(rng.permutation(first + second), [first])
    theta = np.empty((COUNT, first + second))
    for own in columns:
        theta[:, own] = rng.normal(size=(kinds, own.size))[rng.integers(0, kinds, COUNT)]
    fewer = distinct(theta, columns)
    assert len(fewer.theta) <= kinds
    for number, own in enumerate(columns):
        np.testing.assert_array_equal(fewer.theta[:, own][fewer.rows[number]], theta[:, own])
        np.testing.assert_array_equal(fewer.chosen(number) @ fewer.theta[:, own], theta[:, own])


def test_axes_that_share_a_parameter_are_not_taken_apart():
    chain = blocks.chain(["bouc_wen"])
    assert [own.size for own in columns_of_axes(Chain(chain, "xy", [0, 1]))] == [4, 4]
    assert columns_of_axes(Chain(chain, "xy", [0, 1], shared=["bouc_wen.alpha"])) == []
