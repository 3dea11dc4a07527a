"""Spectra of the report against SciPy's."""

import tracemalloc

import numpy as np
import pytest
from scipy.signal import csd

from pzt_ident.data.signals import Trace
from pzt_ident.report.spectra import densities, spectrum_of


@pytest.mark.parametrize("samples", [5, 8, 9, 100, 1001])
def test_densities_are_those_of_scipy(samples):
    signals = np.random.default_rng(samples).normal(size=(2, samples)).cumsum(axis=1)
    size = min(samples, max(8, 2 * samples // 9))
    (found,) = densities(signals, [(0, 1)], size, 7.0)
    expected = csd(*signals, fs=7.0, nperseg=size, detrend="linear")[1]
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * np.abs(expected).max())


def test_a_long_record_is_transformed_in_parts():
    """Beside the five signals themselves there are the segments of four of them."""
    signals = np.random.default_rng(0).normal(size=(4, 100_000)).cumsum(axis=1)
    trace = Trace("r", "identify", "x", 1e-3 * np.arange(100_000), *signals, "V", "um")
    tracemalloc.start()
    spectrum_of(trace)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 8 * signals.size * 2
