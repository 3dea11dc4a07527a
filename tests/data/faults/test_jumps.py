"""Readings that jump and a drive that does not are told, by where they do."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from data.faults.motions import MOTIONS, TRIANGLE, T, followed, measured
from pzt_ident.data.faults.jumps import (
    FEW,
    LONGEST,
    drive_dropouts,
    drive_holds,
    dropout_phrase,
    dropouts,
    hold_phrase,
    join_phrase,
    joins,
)

smooth = st.sampled_from(["triangle", "sine"])
seeds = st.integers(0, 10**6)
GAPS = {"kind": smooth, "seed": seeds, "first": st.integers(20, 500), "length": st.integers(2, LONGEST)}


@settings(max_examples=60, deadline=None)
@given(**GAPS, kept=st.booleans(), step=st.sampled_from([0.0, 2e-9]))
def test_a_sensor_that_drops_out_is_told_from_its_first_to_its_last_sample(kind, seed, first, length, kept, step):
    """At a value that it cannot have, or away by as much as it moves in the record."""
    record = measured(kind, seed, step=step)
    gap = slice(first, first + length)
    record.response[0, gap] = record.response[0, gap] + 9e-6 if kept else -2e-5
    assert dropouts(record, 0) == [(first, first + length - 1)] and not joins(record)
    assert not join_phrase(record) and dropout_phrase(record).startswith("the readings of x from ")


@settings(max_examples=60, deadline=None)
@given(**GAPS, value=st.sampled_from([-90.0, 300.0]))
def test_a_drive_that_is_read_wrong_for_a_while_is_told_and_one_that_the_stage_follows_is_not(
    kind, seed, first, length, value
):
    record = measured(kind, seed)
    moves = np.diff(record.drive[0, first - 9 : first + length + 9])
    assume(np.all(moves * moves[0] > 0))
    gap = slice(first, first + length)
    record.drive[0, gap] = value
    assert drive_dropouts(record, 0) == [(first, first + length - 1)] and not joins(record)
    phrase = dropout_phrase(record)
    assert phrase.startswith("the drive of x from ") and " s jumps away and back: " in phrase
    assert ("mend the file" in phrase) == (length <= FEW) != ("a channel most likely dropped out" in phrase)
    record.response[0, gap] = 1e-7 * value
    assert not drive_dropouts(record, 0)


@settings(max_examples=60, deadline=None)
@given(kind=smooth, seed=seeds, first=st.integers(20, 500), length=st.integers(20, LONGEST))
def test_a_drive_that_is_held_is_told_and_one_that_rests_and_jumps_with_the_stage_is_not(kind, seed, first, length):
    record = measured(kind, seed)
    moves = np.diff(record.drive[0, first - 9 : first + length + 9])
    assume(np.all(moves * moves[0] > 0))
    record.drive[0, first : first + length] = record.drive[0, first]
    assert drive_holds(record, 0) == [(first, first + length - 1)] and not joins(record)
    assert " s stands still until it jumps, and the readings do not: a sensor or" in hold_phrase(record)
    record.response[0, first : first + length] = record.response[0, first]
    assert not drive_holds(record, 0)


@pytest.mark.parametrize("noise", [0.0, 0.05])
@pytest.mark.parametrize("kind", ["pulses", "steps", "sawtooth"])
def test_a_drive_that_jumps_is_no_fault_however_noisy_it_is(kind, noise):
    """Nor where the stage is slow to follow."""
    record = measured(kind, 11)
    record.drive[0] += np.random.default_rng(12).normal(0, noise, T.size)
    assert not drive_dropouts(record, 0) and not drive_holds(record, 0) and not joins(record)
    record.response[0] = 1e-9 * np.cumsum(record.drive[0])
    assert not drive_dropouts(record, 0) and not joins(record)


@pytest.mark.parametrize("kind", ["sawtooth", "steps"])
def test_a_dropout_is_told_among_jumps_of_the_drive(kind):
    record = measured(kind, 13)
    record.response[0, 230:260] = -3e-6
    assert dropouts(record, 0) == [(230, 259)] and not joins(record)


@settings(max_examples=60, deadline=None)
@given(kind=smooth, place=st.integers(20, 580), seed=seeds, moved=st.sampled_from([-3e-6, 2e-6, 2e-5]))
def test_readings_that_jump_without_the_drive_are_told(kind, place, seed, moved):
    record = measured(kind, seed)
    record.response[0, place:] += moved
    assert joins(record) == [place] and not dropouts(record, 0)


@settings(max_examples=60, deadline=None)
@given(first=st.integers(100, 160), second=st.integers(10, 60), seed=seeds)
def test_measurements_that_were_joined_are_told_where_the_drive_moves_on_both_sides(first, second, seed):
    """The drive goes on from another value, and the response with it."""
    record = followed(np.concatenate([TRIANGLE[:first], TRIANGLE[second : second + 130]]), seed)
    assert joins(record) == [first]
    assert f"in one sample at {record.time[first]:.6g} s, as where measurements were joined" in join_phrase(record)


@pytest.mark.parametrize("rest", [0.0, 20.0])
def test_one_that_broke_off_and_one_that_begins_with_a_rest_are_told(rest):
    record = followed(np.concatenate([TRIANGLE[:130], np.full(80, rest), TRIANGLE]), 5)
    assert joins(record) == [130]


def test_a_ramp_that_ends_with_a_drop_and_a_rest_is_one_measurement():
    assert not joins(followed(np.concatenate([TRIANGLE[:200], np.zeros(300)]), 6))


@pytest.mark.parametrize("kind", [*MOTIONS])
def test_a_response_that_follows_the_drive_at_once_is_one_measurement(kind):
    assert not joins(measured(kind, 7))


def test_one_step_of_the_drive_is_one_measurement():
    assert not joins(followed(np.where(T < 3, 0.0, 40.0), 8))


def test_the_largest_jump_of_several_axes_is_told():
    import rig

    response = 1e-7 * MOTIONS["sine"] + np.random.default_rng(9).normal(0, 1e-8, T.size)
    both = np.array([response, response])
    both[:, 300:] += [[1e-6], [3e-6]]
    record = rig.record(MOTIONS["sine"], MOTIONS["triangle"], dt=1e-2, response=both)
    assert join_phrase(record).startswith("the readings of y jump by 3.1e-06 m in one sample at 3 s, as")
