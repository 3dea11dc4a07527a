"""Kinematic coupling of two axes: the other one's displacement, whatever made it."""

import numpy as np
import pytest

from rig import response, triangle

MECHANICS = {"lumped.mass": 0.1, "lumped.damping": 30.0, "lumped.stiffness": 4e7}
RATIOS = {"x.kinematic_coupling.ratio": 0.03, "y.kinematic_coupling.ratio": -0.01}


def test_each_axis_shows_its_share_of_the_other():
    x, y = np.random.default_rng(1).normal(size=(2, 200))
    found = response(["kinematic_coupling"], RATIOS, x, y)
    np.testing.assert_allclose(found, [x + 0.03 * y, y - 0.01 * x], rtol=0, atol=1e-15)


def test_slow_drives_do_not_tell_it_from_stiffness_coupling():
    both = RATIOS | {"x.cross_coupling.ratio": 0.03, "y.cross_coupling.ratio": -0.01}
    both |= {f"{axis}.{word}": value for axis in "xy" for word, value in MECHANICS.items()}
    drives = triangle(10), triangle(8, cycles=2, points=750)
    kinematic = response(["lumped", "kinematic_coupling"], both, *drives)
    np.testing.assert_allclose(response(["lumped", "cross_coupling"], both, *drives), kinematic, rtol=0, atol=1e-2)


def test_an_axis_at_rest_shows_the_ringing_of_the_other():
    known = RATIOS | {f"x.{word}": value for word, value in MECHANICS.items()}
    known |= {f"y.{word}": value for word, value in MECHANICS.items()} | {"y.lumped.stiffness": 9e7}
    step = np.where(np.arange(4000) < 10, 0.0, 10.0)
    x = response(["lumped", "kinematic_coupling"], known, 0 * step, step, dt=1e-5)[0][10:]
    spectrum = np.abs(np.fft.rfft((x - x[-1]) * np.hanning(x.size)))
    natural = np.sqrt(9e7 / 0.1) / (2 * np.pi)
    assert np.argmax(spectrum) / (1e-5 * x.size) == pytest.approx(natural, rel=0.01)


def test_an_axis_without_hysteresis_is_read_as_its_voltage_would_push():
    """The equations are one: with the same mechanics, what moves with a voltage cannot be told from what it pushes."""
    known = {"kinematic_coupling.ratio": 0.03, "cross_coupling.ratio": 0.03}
    known = {f"{axis}.{word}": value for axis in "xy" for word, value in (known | MECHANICS).items()}
    drives = triangle(10), triangle(8, cycles=2, points=750)
    read = response(["lumped", "kinematic_coupling.voltage"], known, *drives)
    np.testing.assert_array_equal(read, response(["lumped", "cross_coupling.voltage"], known, *drives))
    assert np.ptp(read[0] - response(["lumped"], known, *drives)[0]) == pytest.approx(0.03 * 8, rel=1e-3)
