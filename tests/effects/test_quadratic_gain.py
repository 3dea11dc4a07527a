"""A gain that changes with the voltage: a parabola in the prompt response, none in the memory."""

import numpy as np
import pytest

from rig import path, response

DRIVE = path(0, 90, 20, 60, -30, 0, points=60)
PLAYS = {"prandtl_ishlinskii.gain": 0.1, "prandtl_ishlinskii.reach": 30.0}
OPERATORS = {
    "bouc_wen": {"bouc_wen.gain": 0.1, "bouc_wen.alpha": 0.4, "bouc_wen.beta": 0.04, "bouc_wen.gamma": -0.01},
    "prandtl_ishlinskii": PLAYS | {f"prandtl_ishlinskii.weight_{i + 1}": 0.01 * i for i in range(8)},
}


def test_alone_it_is_a_parabola():
    found = response(["quadratic_gain"], {"quadratic_gain.curvature": 2e-3}, DRIVE)
    np.testing.assert_allclose(found, DRIVE + 2e-3 * DRIVE**2, rtol=1e-15)


@pytest.mark.parametrize("operator", OPERATORS)
def test_both_branches_bend_the_same_way(operator):
    known = OPERATORS[operator]
    straight = response([operator], known, DRIVE)
    bent = response([operator, "quadratic_gain"], known | {"quadratic_gain.curvature": 2e-3}, DRIVE)
    np.testing.assert_allclose(bent - straight, 0.1 * 2e-3 * DRIVE**2, rtol=0, atol=1e-12)


def test_behind_an_amplifier_it_sees_the_voltage():
    known = OPERATORS["bouc_wen"] | {"amplifier_lag.tau": 3e-3, "quadratic_gain.curvature": 2e-3}
    voltage = response(["amplifier_lag"], known, DRIVE)
    found = response(["amplifier_lag", "bouc_wen", "quadratic_gain"], known, DRIVE)
    expected = response(["bouc_wen", "quadratic_gain"], known, voltage)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)
