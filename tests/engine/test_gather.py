"""Inner products gathered stretch by stretch are those of all samples together."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pzt_ident.engine import gather, simulator
from pzt_ident.engine.gather import Remainder, Triangle
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks
from rig import record

TIME = np.arange(700) * 1e-2
DRIVES = 50 * (1 - np.cos(2 * TIME)), 30 * np.sin(3 * TIME) ** 2
CHAINS = {
    "an offset": ["bouc_wen", "lumped"],
    "drift and hum": ["bouc_wen", "lumped", "drift", "periodic_disturbance"],
    "ripple and drift": ["bouc_wen", "lumped", "drift", "periodic_disturbance.ripple"],
}


def made(words, **more):
    """Two axes with responses that no candidate gives, and candidates."""
    rng = np.random.default_rng(5)
    chain = Chain(blocks.chain(words), ["x", "y"], [0, 1])
    response = 1e-7 * np.array(DRIVES) + 3e-6 + rng.normal(0, 1e-7, (2, TIME.size))
    where = Simulator(chain, record(*DRIVES, response=response, dt=1e-2, settle=37, **more))
    own = {"gain": 1e-7, "alpha": 0.5, "beta": 0.02, "gamma": 0.01, "mass": 0.2, "damping": 50.0, "stiffness": 7e7}
    own |= {"tau": 3.0, "frequency": 11.0}
    theta = np.array([[own[entry.word] for entry in chain.entries]]) * rng.uniform(0.9, 1.1, (5, len(chain.entries)))
    return where, theta


@given(st.integers(1, 9), st.lists(st.integers(1, 30), min_size=1, max_size=6), st.integers(0, 999))
@settings(max_examples=30, deadline=None)
def test_a_triangle_has_the_inner_products_of_its_columns(columns, lengths, seed):
    rows = np.random.default_rng(seed).normal(size=(columns, sum(lengths)))
    triangle = Triangle(columns)
    for part in np.split(rows, np.cumsum(lengths)[:-1], axis=1):
        triangle.add(part.copy())
    np.testing.assert_allclose(triangle.r.T @ triangle.r, rows @ rows.T, atol=1e-12 * np.square(rows).sum())


@given(st.integers(1, 3), st.lists(st.integers(1, 30), min_size=1, max_size=6), st.integers(0, 999))
@settings(max_examples=30, deadline=None)
def test_a_remainder_is_that_of_least_squares(count, lengths, seed):
    rng = np.random.default_rng(seed)
    basis, signals = rng.normal(size=(count, 9 + sum(lengths))), rng.normal(size=(4, 9 + sum(lengths)))
    remainder = Remainder(count, 4)
    for part in np.split(np.arange(basis.shape[1]), np.cumsum(lengths)):
        remainder.add(basis[:, part], signals[:, part])
    amounts = np.linalg.lstsq(basis.T, signals.T, rcond=None)[0]
    np.testing.assert_allclose(remainder.amounts, amounts, atol=1e-9)
    np.testing.assert_allclose(remainder.squares, np.square(signals.T - basis.T @ amounts).sum(axis=0), rtol=1e-9)


@pytest.mark.parametrize("words", CHAINS.values(), ids=CHAINS)
@pytest.mark.parametrize("more", [{}, {"steps": 2}, {"run_in": 1}], ids=["plain", "finer steps", "run-in"])
def test_squares_and_rotated_errors_are_those_of_the_residuals(words, more):
    where, theta = made(words, **more)
    residuals = where.errors(theta)[:, :, where.record.settle :]
    expected = np.einsum("mas,nas->amn", residuals, residuals)
    np.testing.assert_allclose(gather.squares(where, theta), expected.diagonal(axis1=1, axis2=2).T, rtol=1e-9)
    np.testing.assert_allclose(where.squares(theta), expected.diagonal(axis1=1, axis2=2).T, rtol=1e-9)
    weights = np.random.default_rng(0).normal(size=(3, len(theta)))
    parts, failed = gather.rotated(where, theta, weights)
    for part, products in zip(parts, expected, strict=True):
        np.testing.assert_allclose(part.T @ part, weights @ products @ weights.T, rtol=1e-8, atol=1e-9 * products.max())
    assert not failed.any()


@pytest.mark.parametrize("words", CHAINS.values(), ids=CHAINS)
@pytest.mark.parametrize("length", [64, 192, 4096])
def test_the_length_of_a_stretch_changes_nothing(words, length, monkeypatch):
    monkeypatch.setattr(simulator, "STRETCH", length)
    where, theta = made(words)
    whole = where.simulate(where.amounts.complete(theta)) - where.record.response
    tiles = np.concatenate([error for _, error in where.tiles(theta)], axis=2)
    np.testing.assert_array_equal(tiles, whole[:, :, where.record.settle :])
    found = [
        np.concatenate([error for i, error in gather.stretches(where, theta) if i == axis], axis=1) for axis in (0, 1)
    ]
    residuals = where.errors(theta)[:, :, where.record.settle :]
    np.testing.assert_allclose(np.swapaxes(found, 0, 1), residuals, atol=1e-9 * np.abs(residuals).max())


def test_a_candidate_that_fails_spoils_no_other():
    where, theta = made(CHAINS["an offset"])
    theta[2] = np.nan
    parts, failed = gather.rotated(where, theta, np.eye(len(theta)))
    assert failed.tolist() == [False, False, True, False, False]
    assert np.isfinite(parts).all()
    assert np.isnan(where.squares(theta)[2]).all() and np.isfinite(np.delete(where.squares(theta), 2, 0)).all()


def test_squares_of_which_rounding_leaves_little_are_those_of_the_errors():
    """A response that a model meets to one part in a million million."""
    made, drive = Chain(blocks.chain(["bouc_wen"]), ["x"], [0]), 50 * np.abs(np.sin(np.linspace(0, 9, 3000)))
    theta = np.array([[1e-7, 0.5, 0.02, 0.05]]) * (1 + np.array([[0], [1e-12], [1e-3]]))
    response = Simulator(made, record(drive)).simulate(theta)[0, 0] + 5e-5
    simulator = Simulator(made, record(drive, response=response[None]))
    errors = np.square(simulator.errors(theta)[:, :, simulator.record.settle :]).sum(axis=2)
    np.testing.assert_allclose(simulator.sure_squares(theta), errors, rtol=1e-7, atol=1e-28 * response.size)
    assert abs(simulator.squares(theta)[1] / errors[1] - 1) > 1e-3
