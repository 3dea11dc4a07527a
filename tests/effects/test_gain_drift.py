"""Electronics whose gain changes as they warm up."""

import numpy as np

from rig import path, response

GROWTH, TAU = 0.03, 1.2


def test_the_gain_grows_from_the_start_of_the_record():
    u = path(0, 100, -100, 60, points=77)
    found = response(["gain_drift"], {"gain_drift.growth": GROWTH, "gain_drift.tau": TAU}, u, dt=0.01)
    grown = 1 + GROWTH * (1 - np.exp(-0.01 * np.arange(u.size) / TAU))
    np.testing.assert_allclose(found, u * grown, rtol=1e-12, atol=1e-12)
