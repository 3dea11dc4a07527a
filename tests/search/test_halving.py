"""How much of a response is the step of its simulation: nothing where it is exact, a quarter in half steps."""

from dataclasses import replace

import numpy as np
import pytest

import rig
import stage
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks
from pzt_ident.run.collect import coarse
from pzt_ident.search.halving import change_by_halving
from pzt_ident.search.problem import Problem


def changes(model, steps):
    """Of a stage that rings at 34 Hz in a few steps of 1 ms, each of them halved."""
    drive = rig.path(0, 100, 20, 80, 0, points=25)
    chain = Chain([blocks[word] for word in model], ["x"], [0])
    heavy = stage.STAGE | {"lumped.mass": 1500.0, "lumped.damping": 1e5}
    values = np.array([heavy[name] for name in chain.names])
    made = [replace(rig.record(drive, response=[drive * 1e-7], dt=1e-3), steps=count) for count in steps]
    found = []
    for record in made:
        problem = Problem(chain, [record], {})
        finer = replace(record, steps=2 * record.steps)
        found.append(change_by_halving(problem, record, finer, values[None])[0])
    return np.array(found)


def test_where_the_step_is_exact_nothing_changes():
    assert changes(["bouc_wen"], [1])[0] < 1e-9 * stage.NOISE


def test_each_half_changes_a_quarter():
    found = changes(["bouc_wen", "lumped"], [2, 4, 8])
    assert found[0] > 1e-12
    np.testing.assert_allclose(found[1:] / found[:-1], 0.25, rtol=0.15)


@pytest.mark.parametrize(("change", "said"), [(0.19, []), (0.6, ["0.6 noise floors: give the record `steps: 8`"])])
def test_what_costs_much_of_the_noise_is_said(change, said):
    record = replace(rig.record(np.zeros(4), response=[np.zeros(4)]), steps=2)
    assert [note.partition("response by ")[2] for note in coarse(record, change)] == said
