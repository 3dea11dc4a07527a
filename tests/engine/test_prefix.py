"""What all candidates share is run once, and no number changes by it."""

import numpy as np
import pytest

from pzt_ident.engine import prefix
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.block import Addition, Operator, Place, Term
from pzt_ident.model.registry import blocks
from rig import candidates, model, record

T = 1e-3 * np.arange(500)
DRIVES = 50 + 50 * np.sin(2 * np.pi * 7 * T), 60 * np.sin(2 * np.pi * 11 * T)
FORMS = [item for word in blocks.effects() for item in blocks.forms(word) if not issubclass(blocks[item], Term)]


def sharing(*words, axes=2, count=30):
    """A model, a record, and candidates in which only the last word's parameters differ."""
    made = model(*blocks.chain(words), axes=axes)
    measured = record(*DRIVES[:axes], response=1e-7 * np.array(DRIVES[:axes]))
    theta = candidates(made, np.array(DRIVES[:axes]), count, seed=4, response=1e-5)
    same = [entry.block is not blocks[words[-1]] for entry in made.entries]
    theta[:, same] = theta[0, same]
    return Simulator(made, measured), theta


def results(simulator, theta):
    return simulator.simulate(theta), simulator.errors(theta)[:, :, simulator.record.settle :], simulator.squares(theta)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("base", ["bouc_wen", "prandtl_ishlinskii"])
def test_what_is_shared_leaves_every_bit_as_it_is(base, form, monkeypatch):
    simulator, theta = sharing(base, form)
    found = [results(simulator, rows) for rows in (theta, theta[:5], theta[5:9], theta)]
    behind = blocks[form].place > Place.OPERATOR and not issubclass(blocks[form], Addition)
    assert not behind or any(kept is not None for kept in prefix.SIGNALS[simulator.record].values())
    monkeypatch.setattr(prefix, "MOST_SAMPLES", 0)
    apart = [results(simulator, rows) for rows in (theta, theta[:5], theta[5:9], theta)]
    for some, others in zip(found, apart, strict=True):
        for one, other in zip(some, others, strict=True):
            np.testing.assert_array_equal(one, other)


def test_an_operator_that_differs_is_not_shared():
    simulator, theta = sharing("creep", "bouc_wen")
    assert issubclass(blocks["bouc_wen"], Operator)
    results(simulator, theta)
    assert simulator.record not in prefix.SIGNALS


def test_few_candidates_are_shared_from_the_second_time_on_and_the_last_ones_are_kept():
    simulator, theta = sharing("bouc_wen", "creep", count=5)
    for number in range(2 * prefix.KEPT):
        changed = theta * (1 + 0.01 * number)
        simulator.simulate(changed)
        kept = [*prefix.SIGNALS[simulator.record].values()]
        assert kept[-1] is None
        simulator.simulate(changed)
        assert [*prefix.SIGNALS[simulator.record].values()][-1] is not None
        assert len(kept) <= prefix.KEPT
