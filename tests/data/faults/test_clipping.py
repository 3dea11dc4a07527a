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
    inside = np.convolve(record.response[0] == end, np.ones(6), "same") >= 5
    name = "largest" if side > 0 else "least"
    assert clipping_phrase(record).partition(" ")[2].startswith(f"readings of x are the {name} one, ")
    assert 0.5 * inside.sum() < clipped(side * record.response[0], record.drive[0]) <= (record.response[0] == end).sum()


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
    count = clipped(record.response[0], record.drive[0])
    assert clipping_phrase(record) == (
        f"{count} readings of x are the largest one, 4e-06 m, and stay there while the drive goes on: a converter "
        "or a sensor at the end of its range reads so; leave them out by `rows`, or measure again"
    )
