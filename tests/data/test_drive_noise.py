"""Noise of a recorded drive, and the drive without it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pzt_ident.data.drive_noise import REACH, followed, noise_of_drive, path_of, without_noise
from rig import path

NOISE = 2e-2
T = 1e-3 * np.arange(6000)
SMOOTH = {
    "loops": path(0, 100, 20, 80, 0, points=800),
    "sine": 50 - 50 * np.cos(2 * np.pi * 2 * T),
    "rests": path(0, 0, 100, 100, 40, 40, points=500),
    "chirp": 50 + 40 * np.sin(2 * np.pi * (1 + T / 2) * T),
}


def recorded(drive, noise=NOISE, seed=1):
    return drive + np.random.default_rng(seed).normal(0, noise, drive.size)


@pytest.mark.parametrize("drive", SMOOTH.values(), ids=SMOOTH)
def test_the_noise_of_a_drive_is_found(drive):
    assert noise_of_drive(recorded(drive)) == pytest.approx(NOISE, rel=0.05)


@pytest.mark.parametrize("drive", SMOOTH.values(), ids=SMOOTH)
def test_without_its_noise_a_drive_is_as_long_as_it_was_and_in_its_place(drive):
    quiet = without_noise(recorded(drive))
    assert path_of(quiet) == pytest.approx(path_of(drive), rel=2e-3)
    assert np.abs(quiet - drive).max() < 2 * REACH * NOISE
    assert abs(np.mean(quiet - drive)) < NOISE


def test_noise_makes_the_path_of_a_drive_that_rests_or_turns_slowly_longer():
    drive = path(0, 4, 1, 1, 3, points=1000)
    assert path_of(recorded(drive)) > 5 * path_of(drive)
    assert path_of(without_noise(recorded(drive))) == pytest.approx(path_of(drive), rel=0.15)


@pytest.mark.parametrize("drive", SMOOTH.values(), ids=SMOOTH)
def test_a_drive_without_noise_stays_as_it_is_but_for_rounding(drive):
    assert path_of(without_noise(drive)) == pytest.approx(path_of(drive), rel=1e-3)


def test_what_is_as_fast_as_noise_and_large_is_the_drive_itself():
    drive = np.random.default_rng(3).uniform(0, 100, 4000)
    assert without_noise(drive) is drive
    assert without_noise(np.zeros(8)) is not None


@given(st.lists(st.floats(-100, 100), min_size=1, max_size=60), st.floats(0, 50))
def test_a_play_follows_within_its_half_width_and_no_further_than_it_must(levels, reach):
    drive = np.array(levels)
    p = followed(drive, reach)
    assert np.all(np.abs(p - drive) <= reach * (1 + 1e-12) + 1e-12)
    assert path_of(p) <= path_of(drive) + 1e-9
