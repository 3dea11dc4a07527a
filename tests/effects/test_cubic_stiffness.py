"""Cubic stiffness: the equation at rest, in motion, and the resonance that goes up with the bias."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pzt_ident.engine.simulator import simulate
from pzt_ident.model.block import Place, Relays
from pzt_ident.model.registry import blocks
from rig import candidates, model, path, record, response

MASS, DAMPING, STIFFNESS = 0.16, 60.0, 7e7
STAGE = {"lumped.mass": MASS, "lumped.damping": DAMPING, "lumped.stiffness": STIFFNESS}
MATERIAL = {"gain": 0.1, "remanence": 60.0, "coercive": 20.0, "spread": 0.4, "interaction": 40.0, "quadratic": 0.0}
STACK = {f"homogenized_energy.{word}": value for word, value in (MATERIAL | {"poled": 0.0, "bias": 0.0}).items()}
CUBIC = 2e-3


def bent(force, cubic, dt=1e-3):
    return response(["lumped"], STAGE | {"lumped.cubic": cubic}, force, dt=dt)


@pytest.mark.parametrize("cubic", [1e-12, 2e-4, 1e-2, 1.0])
def test_hard_spring_rests_in_equilibrium(cubic):
    for force in np.linspace(-30, 30, 101):
        x = bent(np.full(5, force), cubic)
        np.testing.assert_allclose(x + cubic * x**3, force, rtol=3e-14, atol=1e-14)


def test_soft_spring_rests_in_equilibrium_short_of_its_limit():
    limit = 0.81 * np.sqrt(0.19 / 1e-3)
    for force in np.linspace(-limit, limit, 101):
        x = bent(np.full(5, force), -1e-3)
        np.testing.assert_allclose(x - 1e-3 * x**3, force, rtol=1e-14, atol=1e-14)


def test_beyond_its_limit_it_goes_on_in_proportion():
    for force in (20.0, 40.0, -1e3):
        np.testing.assert_allclose(bent(np.full(5, force), -1e-3), force / (1 - 0.19))


@pytest.mark.parametrize("cubic", [-5e-4, 2e-3])
def test_a_chirp_moves_it_as_the_differential_equation_says(cubic):
    """Error of second order in the sample time."""
    errors = []
    for dt in (2e-5, 1e-5):
        time = np.arange(0, 0.01, dt)
        force = 8 + 2 * np.sin(2 * np.pi * (200 + 6e4 * time) * time)

        def drive_history(t, state, time=time, force=force):
            x, v = state
            pull = STIFFNESS * (np.interp(t, time, force) - x - cubic * x**3)
            return v, (pull - DAMPING * v) / MASS

        rest = bent(force[:2] * 0 + force[0], cubic)[0]
        truth = solve_ivp(drive_history, (0, time[-1]), (rest, 0), "LSODA", time, max_step=dt, rtol=1e-9, atol=1e-9).y[
            0
        ]
        errors.append(np.abs(bent(force, cubic, dt) - truth).max() / np.ptp(truth))
    assert errors[1] < 2e-3
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.3)


@pytest.mark.parametrize("bias", [0.0, 5.0, 10.0])
def test_the_resonance_goes_up_with_the_bias(bias):
    """f = f1 sqrt(1 + 3 c x0^2) of small oscillations about x0."""
    cubic, dt = 1e-3, 1e-5
    force = bias + cubic * bias**3 + np.concatenate([[0, 1e-4], np.zeros(40_000)])
    ringing = bent(force, cubic, dt)[2:] - bias
    lines = np.abs(np.fft.rfft(ringing * np.hanning(ringing.size), 2**19))
    found = np.argmax(lines) / (2**19 * dt)
    assert found == pytest.approx(np.sqrt(STIFFNESS / MASS * (1 + 3 * cubic * bias**2)) / (2 * np.pi), rel=1e-3)


@pytest.mark.parametrize("cubic", [-5e-4, 1e-12, 2e-4, 1e-2, 1.0])
def test_at_rest_it_is_the_equilibrium(cubic):
    force = np.linspace(-12, 12, 41)
    x = response(["cubic_stiffness.rest"], {"cubic_stiffness.cubic": cubic}, force)
    np.testing.assert_allclose(x + cubic * x**3, force, rtol=3e-14, atol=1e-14)
    np.testing.assert_allclose(bent(np.full(3, 9.0), cubic)[-1], np.interp(9.0, force, x), rtol=1e-4)


def operators():
    for word in blocks.words():
        if getattr(blocks[word], "place", None) == Place.OPERATOR:
            settings = blocks[word].settings().values()
            yield from [f"{word}:{form}" for item in settings for form in getattr(item, "words", ())] or [word]


@pytest.mark.parametrize("operator", [*operators()])
def test_behind_every_operator_it_is_not_bent_at_rest(operator):
    """Its displacement is zero at zero drive, whatever the material was poled at; only the zero has moved. Relays go on
    relaxing at rest, unless they are virgin."""
    drive = path(0, 80, -40, 60, 0, points=40)
    plain, bending = model(operator), model(operator, "cubic_stiffness:rest")
    theta = candidates(plain, drive, 20, seed=3)
    if issubclass(plain.blocks[0], Relays):
        theta[:, [plain.names.index(f"{operator}.{word}") for word in ("poled", "bias")]] = 0
    straight = np.hstack([theta, np.zeros((20, 1))])
    moved = simulate(bending, record(drive), straight) - simulate(plain, record(drive), theta)
    size = 1e-12 * np.abs(simulate(plain, record(drive), theta)).max(axis=(1, 2))
    assert (np.ptp(moved, axis=(1, 2)) <= size).all()
    assert (np.abs(simulate(bending, record(np.zeros(4)), straight)).max(axis=(1, 2)) <= size).all()


@pytest.mark.parametrize("chain", [["lumped"], []])
def test_ahead_of_mechanics_and_at_rest_it_bends_about_the_same_zero(chain):
    """On a slow drive the equation of motion comes to the equilibrium."""
    drive = path(0, 80, -40, 60, 0, points=4000)
    item = "lumped.cubic" if chain else "cubic_stiffness.cubic"
    known = STACK | (STAGE if chain else {})
    force = response(["homogenized_energy", *chain], known, drive)
    x = response(
        ["homogenized_energy", *chain, *([] if chain else ["cubic_stiffness.rest"])], known | {item: CUBIC}, drive
    )
    np.testing.assert_allclose(x + CUBIC * x**3, force - force[0], atol=2e-3)
