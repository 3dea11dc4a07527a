"""A gain that grows with the amplitude: one factor for a record, that of its own span."""

import numpy as np
import pytest

from rig import response, triangle

KNOWN = {"bouc_wen.gain": 0.1, "bouc_wen.alpha": 0.4, "bouc_wen.beta": 0.04, "bouc_wen.gamma": -0.01}


@pytest.mark.parametrize("amplitude", [10, 100])
def test_the_whole_response_grows_with_the_span(amplitude):
    drive = triangle(amplitude, points=50) - 30
    found = response(["bouc_wen", "amplitude_gain"], KNOWN | {"amplitude_gain.growth": 2e-3}, drive)
    plain = response(["bouc_wen"], KNOWN, drive)
    np.testing.assert_allclose(found, (1 + 2e-3 * amplitude) * plain, rtol=1e-13, atol=1e-13)


def test_each_axis_has_its_own_span():
    x, y = triangle(10), triangle(100)
    growth = {"x.amplitude_gain.growth": 1e-2, "y.amplitude_gain.growth": 1e-3}
    np.testing.assert_allclose(response(["amplitude_gain"], growth, x, y), [1.1 * x, 1.1 * y], rtol=1e-14)
