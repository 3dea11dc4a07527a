"""Spectra of the report against SciPy's."""

import numpy as np
import pytest
from scipy.signal import csd

from pzt_ident.report.spectra import density, transforms


@pytest.mark.parametrize("samples", [5, 8, 9, 100, 1001])
def test_densities_are_those_of_scipy(samples):
    signals = np.random.default_rng(samples).normal(size=(2, samples)).cumsum(axis=1)
    size = min(samples, max(8, 2 * samples // 9))
    found = density(*(transforms(values, size) for values in signals), 7.0)
    expected = csd(*signals, fs=7.0, nperseg=size, detrend="linear")[1]
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * np.abs(expected).max())
