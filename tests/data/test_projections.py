"""What is left of noise with a memory where trends are projected out of it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from noises import coloured
from pzt_ident.data.projections import deviation, expected_products, without_lines


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.9])
@pytest.mark.parametrize("samples", [108, 320, 1600])
def test_what_a_quartic_takes_of_noise_with_a_memory_is_allowed_for(memory, samples):
    """More than half of the variance of 108 samples of memory 0.9."""
    parts = [without_lines(coloured(samples, memory, seed), 4) for seed in range(200)]
    assert np.sqrt(np.mean([deviation(*part) ** 2 for part in parts])) == pytest.approx(1, rel=0.1)


@given(memory=st.floats(0, 0.95), columns=st.integers(1, 8), samples=st.integers(20, 60))
@settings(deadline=None)
def test_the_products_of_projected_noise_are_those_of_its_covariance(memory, columns, samples):
    basis = np.linalg.qr(np.random.default_rng(columns).normal(size=(samples, columns)))[0]
    apart = np.abs(np.subtract.outer(np.arange(samples), np.arange(samples)))
    left = np.eye(samples) - basis @ basis.T
    covariance = left @ memory**apart @ left
    expected = np.trace(covariance), np.trace(covariance, 1)
    assert expected_products(basis, memory) == pytest.approx(expected, rel=1e-9, abs=1e-9)
