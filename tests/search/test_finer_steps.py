"""How much of a response is the step of its simulation: nothing where it is exact, a quarter in half steps."""

from dataclasses import replace

import numpy as np
import pytest

import rig
import stage
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks
from pzt_ident.run.collect import coarse
from pzt_ident.search.finer_steps import MOST, change_in_finer_steps, finer_steps
from pzt_ident.search.problem import Problem

HEAVY = {"lumped.mass": 1500.0, "lumped.damping": 1e5}  # rings at 34 Hz


def stage_of(model, values, steps):
    """The problem of a stage on a drive of samples of 1 ms, its record in so many steps, and its parameters."""
    drive = rig.path(0, 100, 20, 80, 0, points=25)
    chain = Chain([blocks[word] for word in model], ["x"], [0])
    theta = np.array([[(stage.STAGE | values)[name] for name in chain.names]])
    record = replace(rig.record(drive, response=[drive * 1e-7], dt=1e-3), steps=steps)
    return Problem(chain, [record], {}), record, theta


def changes(model, steps):
    """Of a stage whose mode is slow beside the samples, each step halved."""
    found = []
    for count in steps:
        problem, record, theta = stage_of(model, HEAVY, count)
        assert finer_steps(problem, record, theta) == 2 * count
        found.append(change_in_finer_steps(problem, record, replace(record, steps=2 * count), theta)[0])
    return np.array(found)


@pytest.mark.parametrize(("mode", "steps", "times"), [(900.0, 1, 2), (1950.0, 1, MOST), (1950.0, 2, 2)])
def test_steps_in_which_a_mode_rings_are_compared_with_shorter_ones(mode, steps, times):
    values = {"lumped.mass": stage.STAGE["lumped.stiffness"] / (2 * np.pi * mode) ** 2, "lumped.damping": 1.0}
    problem, record, theta = stage_of(["bouc_wen", "lumped"], values, steps)
    assert finer_steps(problem, record, theta) == times * steps


def test_half_steps_do_not_tell_what_a_mode_at_twice_the_rate_does_in_both():
    values = {"lumped.mass": stage.STAGE["lumped.stiffness"] / (2 * np.pi * 1950) ** 2, "lumped.damping": 100.0}
    problem, record, theta = stage_of(["bouc_wen", "lumped"], values, 1)
    by_count = {n: change_in_finer_steps(problem, record, replace(record, steps=n), theta)[0] for n in (2, 4, 32)}
    assert by_count[2] < 0.2 * by_count[32] and by_count[4] > 0.6 * by_count[32]


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
