"""Readings that are equal to the last digit amid noise are told, and what rests, sticks or is counted is not."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from data.faults.motions import MOTIONS, T, followed, measured
from pzt_ident.data.faults.jumps import dropouts, hold_phrase, holds, joins


@settings(max_examples=60, deadline=None)
@given(
    kind=st.sampled_from(["triangle", "sine", "sawtooth", "noise"]),
    seed=st.integers(0, 10**6),
    first=st.integers(20, 500),
    length=st.integers(8, 60),
)
def test_a_sensor_that_holds_its_last_reading_is_told_from_its_first_to_its_last_sample(kind, seed, first, length):
    record = measured(kind, seed, noise=5e-7 if kind == "noise" else 1e-8)
    record.response[0, first : first + length] = record.response[0, first]
    moves = np.diff(record.drive[0, first - 3 : first + 4])
    assume(kind == "noise" or np.all(moves * moves[0] > 0))
    assume(record.response[0].min() < record.response[0, first] < record.response[0].max())
    assume(kind != "noise" or not turns_at(record, first))
    assert holds(record, 0) == [(first, first + length - 1)] and not dropouts(record, 0) and not joins(record)


def turns_at(record, place):
    """Whether a drive turns where a stretch begins, as what sticks then stands still."""
    moves = np.diff(record.drive[0, place - 3 : place + 4])
    return (moves > 0).any() and (moves < 0).any()


def test_it_is_said_where_and_what_to_do():
    record = measured("sine", 1)
    record.response[0, 110:140] = record.response[0, 110]
    assert hold_phrase(record) == (
        "the readings of x from 1.1 s to 1.39 s are equal to the last digit while the drive moves: a sensor or a "
        "recorder held its last value; give what is before and after a record of its own, by `rows`"
    )


@pytest.mark.parametrize("step", [0.0, 5e-9, 2e-8, 5e-8, 4e-7])
@pytest.mark.parametrize("noise", [0.0, 1e-9, 1e-8])
@pytest.mark.parametrize("kind", [*MOTIONS])
def test_what_rests_or_is_counted_is_not_held(kind, noise, step):
    assert not hold_phrase(measured(kind, 2, noise, step))


def test_what_is_held_without_any_noise_is_told_by_the_jump_that_ends_it():
    record = measured("sine", 4, noise=0.0)
    record.response[0, 110:140] = record.response[0, 110]
    assert holds(record, 0) == [(110, 139)] and not joins(record)


def test_what_sticks_after_each_turn_is_not_held():
    rubbing = followed(MOTIONS["triangle"], 3, noise=0.0, law=lambda drive: 1e-7 * np.clip(drive, 10, 40))
    assert not hold_phrase(rubbing) and T.size == rubbing.samples
