"""A delay: the drive's own straight lines, read earlier."""

import numpy as np
import pytest

from rig import response, triangle

DT = 1e-3
KNOWN = {"bouc_wen.gain": 0.1, "bouc_wen.alpha": 0.4, "bouc_wen.beta": 0.04, "bouc_wen.gamma": -0.01}


def late(drive, time, **more):
    return response(["delay"], {"delay.time": time}, drive, dt=DT, **more)


@pytest.mark.parametrize("samples", [1e-6, 0.3, 1, 2.5, 64, 70.25])
def test_a_ramp_comes_late(samples):
    t = DT * np.arange(300)
    np.testing.assert_allclose(late(3 + t, samples * DT), 3 + np.maximum(t - samples * DT, 0), rtol=1e-14)


@pytest.mark.parametrize("samples", [0.7, 3, 129.4])
def test_between_its_samples_the_drive_is_linear(samples):
    drive, n = np.random.default_rng(1).normal(size=300), np.arange(300)
    np.testing.assert_allclose(late(drive, samples * DT), np.interp(n - samples, n, drive), rtol=0, atol=1e-12)


def test_whole_samples_are_a_shift():
    drive = np.random.default_rng(2).normal(size=200)
    np.testing.assert_array_equal(late(drive, 2 * DT), np.append([drive[0]] * 2, drive[:-2]))


def test_a_sine_keeps_its_amplitude_and_loses_phase():
    """Less (omega dt)^2 / 8 halfway between samples, what a straight line there lacks."""
    n, omega = np.arange(4000), 2 * np.pi / 200
    found = late(np.sin(omega * n), 12.5 * DT)[2000:]
    expected = np.cos(omega / 2) * np.sin(omega * (n[2000:] - 12.5))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


def test_longer_than_the_record_nothing_comes():
    np.testing.assert_array_equal(late(5 + triangle(10, points=20), 1.0), 5)


def test_a_periodic_drive_comes_round():
    drive = np.random.default_rng(3).normal(size=100)
    np.testing.assert_array_equal(late(drive, 30 * DT, run_in=1), np.roll(drive, 30))


def test_none_reads_ahead():
    drive = np.random.default_rng(4).normal(size=100)
    np.testing.assert_array_equal(late(drive, -50 * DT), drive)


def test_it_stands_ahead_of_the_hysteresis():
    drive = triangle(90, points=40)
    found = response(["delay", "bouc_wen"], KNOWN | {"delay.time": 3.3 * DT}, drive)
    np.testing.assert_allclose(found, response(["bouc_wen"], KNOWN, late(drive, 3.3 * DT)), rtol=0, atol=1e-12)
