"""Plays in the prompt response: they close nested loops, whatever the memory of the operator does."""

import numpy as np

from pzt_ident.effects.distributed_memory import PLAYS
from pzt_ident.model.registry import blocks
from rig import path, response
from twins.prandtl_ishlinskii_twin import prandtl_ishlinskii

KNOWN = {"bouc_wen.gain": 0.1, "bouc_wen.alpha": 0.4, "bouc_wen.beta": 0.04, "bouc_wen.gamma": -0.01}
WEIGHTS, REACH = 0.1 + 0.1 * np.sin(np.arange(PLAYS)), 30.0
WEIGHED = {"distributed_memory.reach": REACH} | {f"distributed_memory.weight_{i + 1}": w for i, w in enumerate(WEIGHTS)}
DRIVE = path(0, 90, 20, 60, 40, 50, 10, 100, -30, points=60)


def test_alone_it_is_the_drive_and_its_plays():
    expected = prandtl_ishlinskii(DRIVE, 1.0, WEIGHTS, REACH * np.arange(1, PLAYS + 1) / PLAYS)
    np.testing.assert_allclose(response(["distributed_memory"], WEIGHED, DRIVE), expected, rtol=0, atol=1e-12)


def test_stops_are_what_plays_leave_of_the_drive_and_keep_the_gain_of_a_long_stroke():
    found = response(["distributed_memory.stops"], WEIGHED, DRIVE)
    plays = prandtl_ishlinskii(DRIVE, 0.0, WEIGHTS, REACH * np.arange(1, PLAYS + 1) / PLAYS)
    np.testing.assert_allclose(found, DRIVE * (1 - WEIGHTS.sum()) + plays, rtol=0, atol=1e-12)
    np.testing.assert_allclose(np.diff(found)[40:59], np.diff(DRIVE)[40:59], rtol=1e-12)


def test_it_adds_to_the_prompt_response_and_leaves_the_memory():
    alone = response(["distributed_memory"], WEIGHED, DRIVE)
    both = response(["bouc_wen", "distributed_memory"], KNOWN | WEIGHED, DRIVE)
    plain = response(["bouc_wen"], KNOWN, DRIVE)
    np.testing.assert_allclose(both - plain, 0.1 * (alone - DRIVE), rtol=0, atol=1e-12)


def test_a_nested_loop_comes_back_to_where_it_left():
    found = response(["distributed_memory"], WEIGHED, path(0, 90, 20, 60, 30, 60, 20, 90, points=60))
    assert abs(found[60 * 5] - found[60 * 3]) < 1e-12
    assert abs(found[60 * 7] - found[60]) < 1e-12
    assert np.ptp(found[60 * 3 : 60 * 5]) > 30


def test_two_plays_have_half_widths_and_weights_of_their_own():
    known = {"weight_1": 0.3, "weight_2": -0.2, "reach": 30.0, "inner": 0.4}
    expected = prandtl_ishlinskii(DRIVE, 1.0, np.array([0.3, -0.2]), np.array([12.0, 30.0]))
    found = response(["distributed_memory.two_plays"], {f"distributed_memory.{k}": v for k, v in known.items()}, DRIVE)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)
    names = blocks["distributed_memory.two_plays"].parameters()
    assert [name for name in names if name.startswith("weight")] == ["weight_1", "weight_2"]
