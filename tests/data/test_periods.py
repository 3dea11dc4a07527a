"""Periods of drives that repeat and of one that does not."""

import numpy as np
import pytest

from pzt_ident.data.periods import correlation_of, period_of


@pytest.mark.parametrize("period", [64, 333, 1000])
def test_period_of_any_shape(period):
    shape = np.random.default_rng(period).normal(size=period).cumsum()
    assert period_of(np.tile(shape - shape.mean(), 5)[None]) == period


@pytest.mark.parametrize("samples", [8, 9, 23, 24, 100, 1001])
def test_a_correlation_is_the_sum_of_products(samples):
    signal, lags = np.random.default_rng(samples).normal(size=samples), samples // 2 + 1
    expected = np.correlate(signal, signal, "full")[samples - 1 :][:lags]
    np.testing.assert_allclose(correlation_of(signal, lags), expected, atol=1e-12 * samples)


def test_a_chirp_has_no_period():
    t = np.linspace(0, 1, 4000)
    assert period_of(np.sin(2 * np.pi * (5 * t + 40 * t**2))[None]) == 0
