"""Single readings that no stage makes are seen, and corners, steps, noise and counts are none."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rig
from data.faults.motions import MOTIONS, T, measured
from pzt_ident.data.faults.spikes import drive_spikes, spike_phrase, spikes

kinds = st.sampled_from([*MOTIONS])
seeds = st.integers(0, 10**6)


@settings(max_examples=60, deadline=None)
@given(kind=kinds, seed=seeds, step=st.sampled_from([0.0, 2e-9, 5e-8]))
def test_noise_counts_corners_and_steps_are_none(kind, seed, step):
    assert not spikes(measured(kind, seed, step=step), 0).size


@settings(max_examples=60, deadline=None)
@given(kind=kinds, seed=seeds, place=st.integers(0, T.size - 1), up=st.booleans(), step=st.sampled_from([0.0, 2e-9]))
def test_a_reading_far_off_is_seen_wherever_the_drive_neither_kinks_nor_turns(kind, seed, place, up, step):
    record = measured(kind, seed, step=step)
    moves = np.diff(record.drive[0, max(place - 5, 0) : place + 6])
    assume(np.abs(np.diff(moves)).max() < 0.1 and np.all(moves * moves[0] >= 0))
    record.response[0, place] += 4e-6 if up else -4e-6
    assert spikes(record, 0).tolist() == [place]


@pytest.mark.parametrize("change", [40.0, -2.0])
def test_where_the_drive_kinks_or_turns_none_is_told(change):
    """A stage that sticks jumps twice as the drive turns for a sample, however little."""
    record = measured("sine", 1)
    record.response[0, 200] += 4e-6
    record.drive[0, 200] += change
    assert not spikes(record, 0).size


@pytest.mark.parametrize(
    ("places", "phrase"),
    [
        ([], ""),
        (
            [0],
            "the reading of x at 0 s stands far beside those around it and is most likely wrong: mend the file, or",
        ),
        ([100, 300], "the readings of x at 1 s and 3 s stand far beside those around them"),
        ([100, 150, 200, 250, 300, 350], "the readings of x at 1 s, 1.5 s and 2 s and 3 more stand"),
    ],
)
def test_it_is_said_which_and_what_to_do(places, phrase):
    record = measured("sine", 2)
    record.response[0, places] += 4e-6
    assert spike_phrase(record).startswith(phrase) and bool(spike_phrase(record)) == bool(places)


@pytest.mark.parametrize("kind", ["triangle", "sine"])
def test_a_drive_that_is_read_wrong_once_is_told_and_a_pulse_that_the_stage_follows_is_not(kind):
    record = measured(kind, 3)
    record.drive[0, 260] += 60
    assert drive_spikes(record, 0).tolist() == [260] and not spikes(record, 0).size
    assert spike_phrase(record).startswith("the value of the drive of x at 2.6 s stands far beside")
    record.response[0, 260] += 6e-6
    assert not drive_spikes(record, 0).size and not spike_phrase(record)


@pytest.mark.parametrize("kind", [*MOTIONS])
def test_no_drive_is_told_that_moves_as_drives_do(kind):
    assert not drive_spikes(measured(kind, 4), 0).size


def test_a_drive_alone_has_none():
    record = rig.record(MOTIONS["sine"], dt=1e-2, measured=[])
    record.drive[0, 260] += 60
    assert not drive_spikes(record, 0).size and not spike_phrase(record)


def test_a_record_of_a_few_samples_has_none():
    assert not spikes(rig.record([0.0, 1.0, 0.0], response=[[0.0, 9.0, 0.0]]), 0).size


def test_a_long_record_is_looked_at_in_stretches_that_overlap(monkeypatch):
    """Nothing is seen twice, missed between two of them, or taken for an end there."""
    record = measured("sine", 5)
    places = [0, 95, 127, 128, 129, 255, 256, 400, 599]
    record.response[0, places] += np.where(np.arange(len(places)) % 2, -4e-6, 4e-6)
    whole = spikes(record, 0).tolist()
    monkeypatch.setattr("pzt_ident.data.faults.spikes.STRETCH", 128)
    assert spikes(record, 0).tolist() == whole and {0, 95, 400, 599} <= {*whole}
