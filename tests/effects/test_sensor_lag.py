"""The sensor's lag stands behind everything else."""

import numpy as np

from rig import response, triangle

HYSTERESIS = {"bouc_wen.gain": 0.08, "bouc_wen.alpha": 0.5, "bouc_wen.beta": 0.02, "bouc_wen.gamma": 0.05}


def test_a_step_is_followed_exponentially():
    """A step within the first sample, then constant."""
    tau, dt = 2e-3, 1e-3
    found = response(["sensor_lag"], {"sensor_lag.tau": tau}, np.minimum(np.arange(50.0), 1), dt=dt)
    first = 1 - tau / dt * -np.expm1(-dt / tau)
    np.testing.assert_allclose(found[1:], 1 - (1 - first) * np.exp(-np.arange(49) * dt / tau), rtol=1e-13)


def test_with_hysteresis_it_is_another_than_the_amplifiers():
    known = HYSTERESIS | {"sensor_lag.tau": 1e-3, "amplifier_lag.tau": 1e-3}
    drive = triangle(100, points=40)
    behind = response(["bouc_wen", "sensor_lag"], known, drive)
    alone = response(["bouc_wen"], known, drive)
    np.testing.assert_allclose(behind, response(["sensor_lag"], known, alone), rtol=0, atol=1e-13)
    assert 1e-4 < np.abs(behind - response(["amplifier_lag", "bouc_wen"], known, drive)).max() < 0.5
