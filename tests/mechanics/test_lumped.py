"""Mass, damper and spring against the matrix exponential and what is conserved."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import lin_lin
from pzt_ident.mechanics.lumped import Lumped
from pzt_ident.model.first_order_hold import oscillator
from rig import response, triangle
from twins import lumped_twin

MASS, _, STIFFNESS = [lin_lin.X[word] for word in lin_lin.WORDS[:3]]
CRITICAL = 2 * np.sqrt(MASS * STIFFNESS)
NEAR_CRITICAL = [1 - 1e-6, 1 - 1e-9, 1, 1 + 1e-13, 1 + 1e-9, 1 + 1e-6]


def displacement(force, ratio, dt, scale=1.0):
    values = scale * np.array([MASS, ratio * CRITICAL, STIFFNESS])
    return response(["lumped"], dict(zip(lin_lin.WORDS, values, strict=False)), force, dt=dt)


def coefficients(ratio, dt=1e-3):
    return Lumped.prepare(MASS, ratio * CRITICAL, STIFFNESS, 0.0, 0.0, dt)


def test_undamped_far_beyond_nyquist():
    """Lin & Lin's X axis, 3.37 kHz at 1 kHz, in um."""
    force = lin_lin.X["bouc_wen.gain"] * triangle(130, cycles=2)
    expected = lumped_twin.lumped(force, 1e-3, MASS, 0, STIFFNESS)
    np.testing.assert_allclose(displacement(force, 0, 1e-3), expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("dt", [1e-3, 1e-4, 1e-6])
@pytest.mark.parametrize("ratio", [0, 1e-3, 0.02, 0.5, *NEAR_CRITICAL, 4, 100])
def test_every_damping_is_exact_between_samples(ratio, dt):
    force = np.random.default_rng(1).normal(size=300).cumsum()
    expected = lumped_twin.lumped(force, dt, MASS, ratio * CRITICAL, STIFFNESS)
    lag = 2 * ratio / (np.sqrt(STIFFNESS / MASS) * dt)  # in samples; it multiplies the rounding of R
    atol = (1e-12 + 2 * np.finfo(float).eps * lag) * np.ptp(force)
    np.testing.assert_allclose(displacement(force, ratio, dt), expected, rtol=0, atol=atol)


@pytest.mark.parametrize("ratio", [0, 0.02, 0.5, 1, 4])
def test_area_shrinks_by_the_damping_alone(ratio):
    """det R = exp(-2 zeta omega T), so 1 undamped."""
    r11, r12, r21, r22, *_ = coefficients(ratio, 1e-4)
    assert r11 * r22 - r12 * r21 == pytest.approx(np.exp(-1e-4 * ratio * CRITICAL / MASS), abs=1e-15)


def test_undamped_ringing_neither_grows_nor_decays():
    known = coefficients(0)
    w, v, f = 0.6, 0.8, 0.0
    for _ in range(10**6):
        w, v, f, _ = Lumped.step(w, v, f, 0.0, *known)
    assert np.hypot(w, v) == pytest.approx(1, abs=5e-11)


@pytest.mark.parametrize("ratio", [0, 0.02, 1, 4])
def test_at_rest_under_a_constant_force(ratio):
    np.testing.assert_array_equal(displacement(np.full(500, 7.3), ratio, 1e-3), 7.3)


def test_a_sine_comes_out_with_the_transfer_function():
    """X = G F with G = 1 / (1 - r^2 + 2 i zeta r), r the frequency over the natural one."""
    omega, ratio, dt = np.sqrt(STIFFNESS / MASS), 0.05, 1e-6
    for r in (0.1, 1.0, 3.0):
        phase = r * omega * dt * np.arange(20000)
        settled = displacement(np.sin(phase), ratio, dt)[10000:]
        expected = (np.exp(1j * phase[10000:]) / (1 - r**2 + 2j * ratio * r)).imag
        np.testing.assert_allclose(settled, expected, atol=2e-3 * np.abs(expected).max())


def test_only_ratios_of_the_parameters_matter():
    force = np.random.default_rng(2).normal(size=300)
    np.testing.assert_allclose(displacement(force, 0.3, 1e-4, 7.0), displacement(force, 0.3, 1e-4), atol=1e-13)


@pytest.mark.parametrize(
    ("axis", "continuous", "sampled"), [(lin_lin.COUPLED_X, 5.78, 22.4), (lin_lin.COUPLED_Y, 3.09, 13.6)]
)
def test_damping_that_lin_and_lins_pi_loop_needs(axis, continuous, sampled):
    """N s/m, at K_P = 0.8 V/um and K_I = 480 V/um/s: Routh's limit, and that of a loop at 1 kHz without delay, three
    times below the resonance. State (x, x' / omega, integral of the error): eq. 24 with eq. 1."""
    mass, _, stiffness, gain = (axis[word] for word in lin_lin.WORDS[:4])
    proportional, integral, dt = 0.8 * gain, 480 * gain, 1e-3
    x, v, summed = np.eye(3)

    def loop(damping):
        r11, r12, r21, r22, *_ = oscillator(math.sqrt(stiffness / mass), damping / 2 / math.sqrt(stiffness * mass), dt)
        force = integral * (summed - dt * x) - proportional * x
        return np.array([force + r11 * (x - force) + r12 * v, r21 * (x - force) + r22 * v, summed - dt * x])

    assert mass * integral / (1 + proportional) == pytest.approx(continuous, abs=0.005)
    least = brentq(lambda damping: np.abs(np.linalg.eigvals(loop(damping))).max() - 1, 1, 100)
    assert least == pytest.approx(sampled, abs=0.05)


def test_an_oscillator_is_at_the_mode_that_is_asked_for():
    found = Lumped.at_mode(250.0, 0.03, 3e6)
    expected = oscillator(2 * np.pi * 250, 0.03, 1e-4)
    assert Lumped.prepare(*found.values(), 0.0, 0.0, 1e-4) == pytest.approx(expected)
