"""Steps of quantisers that were put in."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from noises import rising, white
from pzt_ident.data.evidence import quiet_deviation
from pzt_ident.data.quantiser import common_step, errors_of_readings, quantiser_step, with_quantiser


def test_quantiser_needs_a_grid():
    noise = white(6000, 3e-8)
    assert quantiser_step(noise) == 0
    assert quantiser_step(np.round(noise / 1e-8) * 1e-8) == pytest.approx(1e-8)


@given(step=st.floats(1e-9, 1e-2), noise=st.floats(0.2, 3), seed=st.integers(0, 99))
@settings(deadline=None, max_examples=30)
def test_a_quantiser_shows_where_a_record_of_more_steps_than_samples_rests(step, noise, seed):
    """30 steps from sample to sample, and noise of up to three."""
    readings = np.round(np.append(30.3 * np.arange(1000), np.full(400, 3e4)) + white(1400, noise, seed)) * step
    assert common_step([readings[:1000]]) == 0
    assert common_step([readings]) == pytest.approx(step, rel=1e-6)
    assert common_step([readings, readings + 0.3 * step * np.arange(1400)]) == 0


def test_few_values_off_a_grid_and_a_ramp_are_not_quantised():
    assert quantiser_step(np.resize([0.0, 1.0, 2.5], 300)) == 0
    assert quantiser_step(np.resize([0.0, 1.0, 3.0], 300)) == 1
    assert quantiser_step(np.arange(300.0)) == 0


def test_a_quantiser_counts_for_records_too_short_to_show_it():
    drive = np.concatenate([rising(400), rising(400)[::-1]])
    responses = np.round(10 * drive), np.round(0.5 * drive)
    assert [quantiser_step(response) for response in responses] == [0, 1]
    assert common_step([*responses]) == 1
    assert common_step([*responses, 10 * drive + white(800)]) == 0


@pytest.mark.parametrize("size", [0.02, 0.1, 0.2, 0.3, 1])
def test_coarse_readings_of_things_at_rest_tell_their_error(size):
    rng = np.random.default_rng(1)
    places = rng.uniform(0, 1, (3000, 1))
    readings = np.round(places + rng.normal(0, size, (3000, 300)))
    error = np.sqrt(np.mean((readings - places) ** 2))
    assert with_quantiser(np.sqrt(readings.var(axis=1).mean()), 1.0) == pytest.approx(error, rel=0.02)


@pytest.mark.parametrize("scatter", [0.1, 0.2, 0.3, 0.6])
def test_several_rests_tell_the_noise_beside_a_quantiser_in_the_median(scatter):
    """One alone may be between two steps, where it is quiet, or on an edge, where it is loud."""
    rng, rests = np.random.default_rng(0), 6
    places = rng.uniform(0, 1, (200, rests, 1))
    read = np.std(np.round(places + rng.normal(0, scatter, (200, rests, 400))), axis=2)
    errors = [quiet_deviation(errors_of_readings(each, np.ones(rests), 1.0), np.ones(rests)) for each in read]
    assert np.median(errors) == pytest.approx(np.hypot(scatter, 1 / np.sqrt(12)), rel=0.03)


def test_readings_of_few_digits_are_on_one_grid():
    """A gap of 4.71 nm, as six digits of 12 um tell it, is wrong by a step within 1,300 of them."""
    step, stroke = 4.7093751e-9, np.linspace(0, 12.5e-6, 6000)
    readings = np.round(np.append(np.zeros(300), stroke) / step + np.random.default_rng(2).normal(0, 0.2, 6300)) * step
    written = np.array([float(f"{value:.6g}") for value in readings * 1e6]) * 1e-6
    assert common_step([written]) == pytest.approx(step, rel=1e-4)
