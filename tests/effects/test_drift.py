"""Drift: from zero to its size, whatever the drive."""

import numpy as np

from pzt_ident.effects.drift import Drift


def test_approaches_one_with_its_time_constant():
    found = [Drift.basis(t, 50.0) for t in (0, 50, 50 * np.log(2), 1e5)]
    np.testing.assert_allclose(found, [[0], [1 - np.exp(-1)], [0.5], [1]], rtol=1e-15)


def test_is_a_ramp_where_the_time_constant_is_long():
    t = np.linspace(0, 1, 50)
    np.testing.assert_allclose([3000 * Drift.basis(each, 3000.0)[0] for each in t], t, rtol=2e-4)
