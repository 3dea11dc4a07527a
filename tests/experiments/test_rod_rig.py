"""The virtual rod against closed forms, and its committed records."""

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from experiments.rigs import rod as rig

ROOT = Path(__file__).parents[2]
ROD = rig.Rod()


def test_natural_frequencies_are_those_of_the_wave_equation():
    """cot k l = k l m_l / (rho A l)."""
    ratio, speed = ROD.end_mass / (ROD.density * ROD.area * ROD.length), np.sqrt(ROD.modulus / ROD.density)
    for i, found in enumerate(ROD.frequencies()[:3]):
        kl = brentq(lambda x: np.cos(x) - x * ratio * np.sin(x), i * np.pi + 1e-6, (i + 1) * np.pi)
        assert found == pytest.approx(speed * kl / ROD.length / (2 * np.pi), rel=1e-6)


def test_the_end_at_rest_has_the_free_displacement():
    _, stiffness, end = ROD.matrices()
    assert end @ np.linalg.solve(stiffness, end) == pytest.approx(ROD.length / (ROD.modulus * ROD.area), rel=1e-9)


@pytest.mark.parametrize("name", ["rod", "rod_validate"])
def test_committed_records_are_what_the_rig_writes(name):
    """To the noise of 10 nm, over the first 0.15 ms."""
    time, voltage = (column[:60] for column in rig.records()[name])
    rows = np.loadtxt(ROOT / f"experiments/rod/data/{name}.csv", delimiter=",", skiprows=1)[:60]
    np.testing.assert_allclose(rows[:, 0], time, atol=1e-12)
    np.testing.assert_allclose(rows[:, 1], voltage, atol=5e-5)
    off = rows[:, 2] - 1e6 * rig.simulate(ROD, time, rows[:, 1])
    assert 0.005 < off.std() < 0.015 and np.abs(off).max() < 0.05
