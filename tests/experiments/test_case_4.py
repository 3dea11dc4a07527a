"""Case IV, a stretch of it: the coarse stage keeps its band, and what is left is the delay times the speed."""

import numpy as np
import pytest

from experiments.case_4 import tracking


@pytest.fixture(scope="module")
def residual():
    target = tracking.sine(0.04)
    return target - tracking.coarse(target)


def test_coarse_stage_keeps_its_band():
    target = tracking.sine(0.6)
    left = target - tracking.coarse(target)
    assert -2.1e-6 < left.min() < -1.9e-6 and 3.9e-6 < left.max() < 4.1e-6


@pytest.mark.parametrize("delay", [0, 1, 5])
def test_error_is_the_speed_of_the_residual_times_the_delay(residual, delay):
    error = tracking.followed(residual, delay).error
    assert np.abs(error).max() == pytest.approx(tracking.expected(residual, delay), abs=tracking.COUNT)
