"""The noise of responses that never rest, against noise that was put in."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import butter, lfilter

from noises import coloured, white
from pzt_ident.data.windows import Remainder, Signal, courses_of, lines_of, remainder, roughness, window_noise

TRIANGLE = 100 * np.abs((np.arange(6000) / 500 + 1) % 2 - 1)  # 1 V in 5 samples
SINE = 50 - 50 * np.cos(np.arange(6000) / 170)
WIDE = np.convolve(white(6100, 50, seed=8), np.hanning(15), "valid")[:6000]  # turns every tenth sample


def lagging(drive, width=10.0):
    """A play and its drive, half each."""
    play, left = [], drive[0]
    for u in drive:
        left = min(max(left, u - width), u + width)
        play.append(left)
    return 0.5 * drive + 0.5 * np.array(play)


def found(response, drive=TRIANGLE, least=0.0):
    return window_noise([Signal(np.atleast_2d(drive), response, 1e-3)], least)


@given(step=st.floats(0.1, 10), seed=st.integers(0, 1000))
@settings(deadline=None, max_examples=30)
def test_any_quantiser_adds_its_own(step, seed):
    """Noise 1 and step / sqrt(12), root mean square."""
    readings = step * np.round((20 * lagging(SINE) + white(6000, seed=seed)) / step)
    floor = step / np.sqrt(12)
    assert found(readings, SINE, floor) == pytest.approx(np.hypot(1, floor), rel=0.15)


@given(seed=st.integers(0, 1000), unit=st.sampled_from([1e-3, 1e3, 0.3]))
@settings(deadline=None, max_examples=20)
def test_a_unit_of_the_drive_changes_no_digit(seed, unit):
    """While a drive rises, its path is the drive: what is left of one without the other is rounding."""
    response = 20 * lagging(TRIANGLE) + white(6000, seed=seed)
    for length in (16, 32, 64):
        signals = [Signal(u * TRIANGLE[None], response, 1e-3) for u in (1, unit)]
        left, told = (remainder([signal], length, [courses_of(signal.drives)]) for signal in signals)
        assert told == pytest.approx(left, rel=1e-9)


@given(memory=st.floats(0, 0.7), seed=st.integers(0, 1000))
@settings(deadline=None, max_examples=30)
def test_noise_with_any_memory_counts_as_a_whole(memory, seed):
    """Third differences have 0.46 of it at 0.7."""
    assert found(lagging(TRIANGLE) + coloured(6000, memory, seed)) == pytest.approx(1, rel=0.2)


@pytest.mark.parametrize("cutoff", [0.4, 0.6, 0.8])
def test_filtered_noise_counts_as_a_whole(cutoff):
    """Butterworth of second order at shares of the Nyquist frequency."""
    noise = lfilter(*butter(2, cutoff), white(7000))[1000:]
    assert found(lagging(TRIANGLE) + noise) == pytest.approx(noise.std(), rel=0.3)


@given(gain=st.floats(0.3, 30), seed=st.integers(0, 1000))
@settings(deadline=None, max_examples=20)
def test_a_drive_that_turns_in_every_window_is_no_noise(gain, seed):
    """As rough as 1.4 times the noise for a gain of 1."""
    noise = white(6000, seed=seed)
    assert found(gain * WIDE + noise, WIDE) == pytest.approx(1, rel=0.15)


def test_one_slope_rising_and_another_falling_is_no_noise():
    noise, response = white(6000), lagging(WIDE, width=1e-3 * np.ptp(WIDE))
    assert roughness([Signal(WIDE[None], response, 1.0)]) > 1
    assert found(response + noise, WIDE) == pytest.approx(1, rel=0.15)


@given(scale=st.sampled_from([1e-9, 1e-3, 1e6]), offset=st.floats(-1e3, 1e3), turn=st.booleans())
@settings(deadline=None, max_examples=10)
def test_the_noise_is_in_the_unit_of_the_response_and_of_no_place_direction_or_drive(scale, offset, turn):
    response = lagging(TRIANGLE) + white(6000)
    other = scale * (offset + (response[::-1] if turn else response))
    drive = 7 - 1e-3 * (TRIANGLE[::-1] if turn else TRIANGLE)
    assert found(other, drive) == pytest.approx(scale * found(response), rel=0.05 if turn else 1e-6)


def test_records_that_move_too_fast_leave_it_to_those_that_do_not():
    slow = Signal(TRIANGLE[None], TRIANGLE + white(6000), 1e-3)
    fast = Signal(TRIANGLE[None], TRIANGLE + white(6000, 50, seed=1), 1e-3)
    assert window_noise([fast, slow, fast], 0.0) == pytest.approx(1, rel=0.1)


@given(
    frequency=st.floats(15, 240), height=st.floats(2, 200), harmonic=st.sampled_from([0, 1]), seed=st.integers(0, 1000)
)
@settings(deadline=None, max_examples=30)
def test_a_hum_in_all_records_is_no_noise(frequency, height, harmonic, seed):
    t = np.arange(6000) / 1000
    hum = height * (np.sin(2 * np.pi * frequency * t + seed) + harmonic / 3 * np.sin(4 * np.pi * frequency * t))
    drives = TRIANGLE, SINE[:3000]
    signals = [
        Signal(drive[None], 20 * lagging(drive) + (hum + white(6000, seed=seed))[: drive.size], 1e-3)
        for drive in drives
    ]
    assert window_noise(signals, 0.0) == pytest.approx(1, rel=0.2)


def test_the_lines_are_those_that_stand_out_of_all_records():
    """50 Hz in the first record, 150 Hz, to which third differences are most sensitive, in the second."""
    t = np.arange(6000) / 1000
    signals = [
        Signal(SINE[None], 20 * lagging(SINE) + 9 * np.sin(2 * np.pi * hertz * t) + white(6000), 1e-3)
        for hertz in (50, 150)
    ]
    assert lines_of(signals) == pytest.approx([150, 50], abs=0.2)
    assert not lines_of([Signal(SINE[None], 20 * lagging(SINE) + white(6000), 1e-3)])


@pytest.mark.parametrize("samples", [30, 45, 63])
def test_records_shorter_than_a_stretch_have_the_white_noise_of_their_third_differences(samples):
    parts = [Signal(np.arange(samples)[None], np.arange(samples) + white(samples, seed=n), 1.0) for n in range(200)]
    assert window_noise(parts, 0.0) == pytest.approx(1, rel=0.2)
    assert window_noise([Signal(np.zeros((1, 13)), white(13), 1.0)], 0.25) == 0.25


@pytest.mark.parametrize("drives", [1, 2, 4])
def test_what_is_left_is_the_share_of_the_noise_that_a_basis_leaves(drives):
    """Of 32 samples, 5 go into a quartic and 3 into each drive."""
    signal = Signal(white(6400).reshape(1, -1).repeat(drives, 0), white(6400, seed=1), 1.0)
    moving = signal._replace(drives=white(6400 * drives, seed=2).reshape(drives, -1))
    assert remainder([signal], 32).share == pytest.approx(27 / 32, rel=0.05)
    assert remainder([moving], 32, [courses_of(moving.drives)]).share == pytest.approx((27 - 3 * drives) / 32, rel=0.1)


@given(memory=st.floats(0, 0.95))
def test_the_roughness_is_that_of_third_differences(memory):
    differences = np.diff(np.eye(20), 3, axis=0)
    covariance = memory ** np.abs(np.subtract.outer(np.arange(20), np.arange(20)))
    variance = (differences @ covariance @ differences.T)[0, 0]
    assert Remainder(2.0, memory, 1.0).roughness == pytest.approx(2 * np.sqrt(variance / 20))
