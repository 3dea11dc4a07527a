"""The noise floor against noise that was put in."""

import dataclasses

import numpy as np
import pytest

from pzt_ident.data.noise import noise_floor, period_of, quantiser, resting, sizes
from pzt_ident.data.record import Record

SIGMA = 30e-9


def record(drive, response, **more):
    return Record("r", "identify", 1e-3, np.atleast_2d(drive), np.atleast_2d(response), **more)


@pytest.fixture
def noise():
    return np.random.default_rng(11).normal(0, SIGMA, 6000)


def test_rest_segments_give_the_noise_despite_creep(noise):
    drive = np.concatenate([np.linspace(0, 100, 3000), np.full(3000, 100.0)])
    creep = 1e-6 * np.log1p(np.maximum(np.arange(6000) - 3000, 0) / 100)
    floor = noise_floor([record(drive, 1e-7 * drive + creep + noise)], 0)
    assert floor.source == "rest segments"
    assert floor.value == pytest.approx(SIGMA, rel=0.1)


def test_repeated_periods_give_the_noise_despite_drift(noise):
    t = np.arange(6000)
    drive = 50 * (1 - np.cos(2 * np.pi * t / 1000))
    floor = noise_floor([record(drive, 1e-7 * drive + 3e-11 * t + noise)], 0)
    assert floor.source == "repeated periods"
    assert floor.value == pytest.approx(SIGMA, rel=0.1)


def test_without_rest_or_repeats_the_evidence_is_weak(noise):
    t = np.arange(6000)
    drive = 50 * (1 - np.cos(2 * np.pi * (t / 1000) ** 1.3))
    floor = noise_floor([record(drive, 1e-7 * drive + noise)], 0)
    assert "weak" in floor.source
    assert floor.value == pytest.approx(SIGMA, rel=0.2)


def test_records_measured_again_give_the_noise_of_any_signal(noise):
    """Wide-band signals have neither rest nor a smooth course; a settled offset between both counts for nothing."""
    rng = np.random.default_rng(3)
    drive = rng.normal(size=3000)
    again = [record(drive, 1e-7 * drive + each) for each in (noise[:3000], 1e-6 + noise[3000:])]
    floor = noise_floor([*again, record(rng.normal(size=3000), noise[:3000] * 7)], 0)
    assert floor.source == "repeated records"
    assert floor.value == pytest.approx(SIGMA, rel=0.1)
    assert "weak" in noise_floor(again[:1], 0).source
    assert "weak" in noise_floor([again[0], again[0]], 0).source  # listed twice, measured once


def test_never_below_the_quantiser():
    t = np.arange(6000)
    drive = 50 * (1 - np.cos(2 * np.pi * t / 1000))
    response = 1e-7 * np.round(drive * 1e-7 / 1e-7)
    floor = noise_floor([record(drive, response)], 0)
    assert floor.source == "quantiser"
    assert floor.value == pytest.approx(1e-7 / np.sqrt(12), rel=1e-6)


def test_quantiser_needs_a_grid(noise):
    assert quantiser(noise) == 0
    assert quantiser(np.round(noise / 1e-8) * 1e-8) == pytest.approx(1e-8)


@pytest.mark.parametrize("cycles", [6.3, 10.6, 50.2])
def test_rest_segments_give_the_noise_despite_hum_far_above_it(cycles):
    t = np.arange(2000.0) / 2000
    hum = 20 * np.sin(2 * np.pi * cycles * t + 1)
    found = resting(np.zeros((1, 2000)), hum + np.random.default_rng(3).normal(size=2000))
    assert found[0][0] == pytest.approx(1, rel=0.1)


@pytest.mark.parametrize("period", [64, 333, 1000])
def test_period_of_any_shape(period):
    shape = np.random.default_rng(period).normal(size=period).cumsum()
    assert period_of(np.tile(shape - shape.mean(), 5)[None]) == period


def test_a_chirp_has_no_period():
    t = np.linspace(0, 1, 4000)
    assert period_of(np.sin(2 * np.pi * (5 * t + 40 * t**2))[None]) == 0


def test_responses_of_different_kinds_are_weighed_by_their_noise(noise):
    drive = np.sin(2 * np.pi * np.arange(noise.size) / 500)
    both = [1e-7 * drive + noise, 1e-2 * drive + 3e4 * noise]
    made = record([drive, drive], both, axes=("x", "y"), drive_units=("V", "V"), response_units=("um", "nm"))
    assert sizes([made]).tolist() == [1, 1]
    mixed = dataclasses.replace(made, response_units=("um", "uC/cm2"))
    assert sizes([mixed]) == pytest.approx(noise.std() * np.array([1, 3e4]), rel=0.1)
    smooth = dataclasses.replace(
        mixed, response=mixed.response + np.array([[0], [1]]) * (1e-2 * drive - mixed.response)
    )
    assert sizes([smooth])[1] == pytest.approx(5e-3 * 2e-2, rel=1e-3)
