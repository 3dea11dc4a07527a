"""The virtual tube against the splines of the package and closed forms, and its committed records."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.special import ndtr

from experiments.rigs import shell as rig
from pzt_ident.mechanics._shell import matrices

ROOT = Path(__file__).parents[2]
TUBE = rig.Tube()


def test_natural_frequencies_and_shares_are_those_of_the_splines():
    own = SimpleNamespace(**vars(TUBE), load=0.0, elements=40, harmonic=0)
    mass, _, stiffness, load, end = matrices(own)
    squares, shapes = eigh(stiffness, mass)
    share = (end @ shapes) * (load @ shapes) / squares / (end @ np.linalg.solve(stiffness, load))
    omegas, shares, rest = TUBE.modes()
    np.testing.assert_allclose(omegas, np.sqrt(squares[:6]), rtol=1e-4)
    np.testing.assert_allclose(shares, share[:6], atol=1e-4)
    assert shares.sum() + rest == pytest.approx(1)


def test_the_first_turn_of_the_relays_has_its_closed_form():
    """From the virgin state those with Ec below E - |EI| are up: E[Phi(..)] over the lognormal, first loop's tip."""
    z = (np.arange(4000) + 0.5) / 4000
    coercive = rig.COERCIVE * np.exp(rig.SPREAD * rig.norm.ppf(z))
    up = np.mean(ndtr(np.maximum(80.0 - coercive, 0) / rig.INTERACTION))
    expected = rig.GAIN * (80.0 + rig.REMANENCE * (2 * up - 2))
    assert rig.relays(np.linspace(0, 80, 30))[-1] == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("name", ["shell", "shell_validate"])
def test_committed_records_are_what_the_rig_writes(name):
    """To the noise of 0.5 nm, over the first 0.5 ms."""
    time, voltage = (column[:100] for column in rig.records()[name])
    rows = np.loadtxt(ROOT / f"experiments/shell/data/{name}.csv", delimiter=",", skiprows=1)[:100]
    np.testing.assert_allclose(rows[:, 0], time, atol=1e-12)
    np.testing.assert_allclose(rows[:, 1], voltage, atol=5e-5)
    off = rows[:, 2] - 1e6 * rig.simulate(TUBE, time, rows[:, 1])
    assert 0.0003 < off.std() < 0.0008
