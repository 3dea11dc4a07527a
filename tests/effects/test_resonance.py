"""A second mode beside the first: its own oscillator on the same force."""

import numpy as np
import pytest

from rig import response
from twins.lumped_twin import lumped

DT, FREQUENCY, DAMPING = 1e-5, 1500.0, 0.02
OMEGA = 2 * np.pi * FREQUENCY
STAGE = {"lumped.mass": 0.16, "lumped.damping": 30.0, "lumped.stiffness": 7e7}
FORCE = np.random.default_rng(1).normal(size=400).cumsum()


def mode(share, frequency=FREQUENCY, damping=DAMPING):
    return {"resonance.share": share, "resonance.frequency": frequency, "resonance.damping": damping}


def second(force, dt=DT):
    return lumped(force, dt, 1.0, 2 * DAMPING * OMEGA, OMEGA**2)


@pytest.mark.parametrize("share", [-0.3, 0.2, 1.0])
def test_alone_it_takes_its_share_of_the_drive(share):
    found = response(["resonance"], mode(share), FORCE, dt=DT)
    np.testing.assert_allclose(found, (1 - share) * FORCE + share * second(FORCE), rtol=0, atol=1e-9)


def test_beside_the_mechanics_it_is_driven_by_the_force():
    first = lumped(FORCE, DT, 0.16, 30.0, 7e7)
    found = response(["lumped", "resonance"], STAGE | mode(0.2), FORCE, dt=DT)
    np.testing.assert_allclose(found, 0.8 * first + 0.2 * second(FORCE), rtol=0, atol=1e-9)


def test_the_flexure_acts_on_the_first_mode_alone():
    known = STAGE | mode(0.2) | {"lumped.cubic": 1e-3}
    first = response(["lumped"], known, FORCE, dt=DT)
    found = response(["lumped", "resonance"], known, FORCE, dt=DT)
    np.testing.assert_allclose(found, 0.8 * first + 0.2 * second(FORCE), rtol=0, atol=1e-9)


def test_the_static_gain_is_still_one():
    slow = 5 + 3 * np.sin(np.linspace(0, 2 * np.pi, 3000))
    np.testing.assert_allclose(response(["resonance"], mode(0.3), slow, dt=1e-3), slow, rtol=0, atol=2e-5)


def test_a_step_rings_at_its_frequency_and_dies_with_its_damping():
    """Within a sample up to one; then A exp(-zeta omega t) cos(omega_d t + phase) about one."""
    ringing = response(["resonance"], mode(1.0), np.minimum(np.arange(8001.0), 1), dt=DT)[1:] - 1
    peaks = 1 + np.flatnonzero((ringing[1:-1] > ringing[:-2]) & (ringing[1:-1] > ringing[2:]))
    periods = peaks.size - 1
    between = DT * (peaks[-1] - peaks[0]) / periods
    assert between == pytest.approx(1 / (FREQUENCY * np.sqrt(1 - DAMPING**2)), rel=1e-3)
    lost = np.log(ringing[peaks[0]] / ringing[peaks[10]]) / 10
    assert lost == pytest.approx(2 * np.pi * DAMPING / np.sqrt(1 - DAMPING**2), rel=2e-2)


def test_a_negative_share_makes_an_antiresonance_behind_the_pole():
    """(1 - share) + share G2 is zero, without damping, at omega^2 = omega_2^2 / (1 - share)."""
    share = -0.2
    frequency = FREQUENCY / np.sqrt(1 - share)
    t = DT * np.arange(60000)
    drive = np.sin(2 * np.pi * frequency * t)
    found = response(["resonance"], mode(share, damping=5e-3), drive, dt=DT)[40000:]
    s = frequency / FREQUENCY
    expected = (1 - share) + share / (1 - s**2 + 2j * 5e-3 * s)
    amplitude = 2j * np.mean(found * np.exp(-2j * np.pi * frequency * t[40000:]))
    assert amplitude == pytest.approx(expected, abs=5e-3)
    assert abs(expected) < 0.1
