"""Readings at the end of a converter's range are told, and what bends or rests is none."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from data.faults.motions import MOTIONS, TRIANGLE, followed, measured
from pzt_ident.data.faults.clipping import clipped, clipping_phrase

seeds = st.integers(0, 10**6)


@settings(max_examples=60, deadline=None)
@given(kind=st.sampled_from(["triangle", "sine"]), share=st.floats(0.5, 0.9), side=st.sampled_from([1, -1]), seed=seeds)
def test_the_readings_at_an_end_of_the_range_are_counted(kind, share, side, seed):
    record = measured(kind, seed)
    record.response[0] *= side
    least, largest = record.response[0].min(), record.response[0].max()
    end = least + share * (largest - least) if side > 0 else largest - share * (largest - least)
    record.response[0] = np.minimum(record.response[0], end) if side > 0 else np.maximum(record.response[0], end)
    name, count = "largest" if side > 0 else "least", int((record.response[0] == end).sum())
    assert clipping_phrase(record).startswith(f"{count} readings of x are exactly ")
    assert f" m, the {name} of all, first at " in clipping_phrase(record)


@settings(max_examples=60, deadline=None)
@given(kind=st.sampled_from([*MOTIONS]), step=st.sampled_from([0.0, 1e-9, 5e-8, 4e-7]), seed=seeds)
def test_the_top_of_a_motion_in_counts_is_no_end_of_a_range(kind, step, seed):
    assert not clipping_phrase(measured(kind, seed, step=step))


@pytest.mark.parametrize("noise", [1e-9, 1e-8])
def test_a_stage_that_saturates_has_readings_with_noise(noise):
    assert not clipping_phrase(followed(TRIANGLE, 3, noise, law=lambda drive: np.minimum(1e-7 * drive, 3e-6)))


def test_it_is_said_how_many_and_where():
    record = followed(TRIANGLE, 4)
    record.response[0] = np.minimum(record.response[0], 4e-6)
    at_end = record.response[0] == 4e-6
    first = f"{record.time[np.argmax(at_end)]:.6g} s"
    assert clipped(record.response[0], record.drive[0]) and clipping_phrase(record) == (
        f"{at_end.sum()} readings of x are exactly 4e-06 m, the largest of all, first at {first}: the end of the range "
        "of a sensor or converter; leave them out by `rows`, or measure again in a wider one"
    )


@pytest.mark.parametrize("kind", ["steps", "pulses", "noise"])
def test_readings_without_noise_at_an_end_are_told_though_the_drive_rests(kind):
    record = measured(kind, 5)
    record.response[0] = np.minimum(record.response[0], 2.15e-6)
    assert clipping_phrase(record).partition(" readings of x are exactly ")[2].startswith("2.15e-06 m")


def test_one_wrong_value_of_a_drive_that_rests_makes_no_end():
    record = followed(np.concatenate([TRIANGLE[:200], np.full(200, 50.0), TRIANGLE[200:]]), 6, noise=0.0)
    record.drive[0, 300] = 90.0
    assert not clipping_phrase(record)


def test_counts_that_are_rounded_to_the_last_bit_are_counts():
    record = measured("triangle", 7, noise=1e-8, step=5e-8)
    record.response[0] *= 1 + 1e-16 * np.arange(record.samples)
    record.response[0, ::7] = np.nextafter(record.response[0, ::7], 1.0)
    assert not clipping_phrase(record)


def test_a_rest_in_counts_beside_a_fast_motion_is_no_end():
    record = followed(np.concatenate([np.zeros(40), 20 + np.abs(MOTIONS["noise"])]), 8, noise=1e-9, step=5e-8)
    assert not clipping_phrase(record)
