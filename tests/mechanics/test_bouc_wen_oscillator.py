"""The oscillator against its differential equation and the official signals of the benchmark."""

import os
from pathlib import Path

import numpy as np
import pytest

from pzt_ident.mechanics.bouc_wen_oscillator import BoucWenOscillator
from rig import response
from twins import bouc_wen_oscillator_twin, lumped_twin

WORDS = ("mass", "damping", "stiffness", "alpha", "beta", "gamma")
TRUTH = dict(zip(WORDS, (2, 10, 5e4, 5e4, 800, -1100), strict=True))
DT = 1 / 750


def displacement(force, dt=DT, run_in=0, **other):
    known = {f"bouc_wen_oscillator.{word}": value for word, value in (TRUTH | other).items()}
    return response(["bouc_wen_oscillator"], known, force, dt=dt, run_in=run_in)


@pytest.fixture(scope="module")
def force():
    """A multisine up to 100 Hz, 50 N rms, not zero at the start."""
    rng = np.random.default_rng(0)
    phase = np.outer(DT * np.arange(150), 2 * np.pi * rng.uniform(5, 100, 10)) + rng.uniform(0, 6, 10)
    return 50 * np.sqrt(2 / 10) * np.sin(phase).sum(axis=1)


@pytest.fixture(scope="module")
def truth(force):
    return bouc_wen_oscillator_twin.oscillator(force, DT, *TRUTH.values())


def test_solves_the_differential_equation(force, truth):
    assert np.abs(force[0]) > 10
    assert displacement(force)[0] == truth[0] == 0
    np.testing.assert_allclose(displacement(force), truth, rtol=0, atol=1e-4 * truth.std())


def test_error_falls_with_the_square_of_the_step(force, truth, monkeypatch):
    errors = []
    for times in (5, 20, 80):
        monkeypatch.setattr(BoucWenOscillator, "oversample", times)
        errors.append(np.sqrt(np.mean((displacement(force) - truth) ** 2)))
    assert np.log(errors[0] / errors[2]) / np.log(16) == pytest.approx(2, abs=0.15)


def test_without_hysteresis_it_is_lumped_mechanics():
    force = 50 * np.sin(2 * np.pi * 20 * 5e-6 * np.arange(40000)) ** 2
    expected = lumped_twin.lumped(force / 5e4, 5e-6, 2, 10, 5e4)[::20]
    found = displacement(force[::20], 1e-4, alpha=0)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.ptp(expected))


def test_small_motion_has_both_stiffnesses():
    """z follows alpha y as long as y is far below 1 / beta."""
    time = np.arange(2000) * 1e-4
    force = 1e-3 * np.sin(2 * np.pi * 20 * time) ** 2
    expected = displacement(force, 1e-4, stiffness=1e5, alpha=0)
    np.testing.assert_allclose(displacement(force, 1e-4), expected, rtol=0, atol=1e-4 * np.ptp(expected))


def test_motion_is_odd(force):
    np.testing.assert_allclose(displacement(-force), -displacement(force), rtol=0, atol=1e-15)


@pytest.mark.parametrize(("group", "run_in", "error"), [("multisine", 1, 2.4e-7), ("sinesweep", 0, 2.6e-6)])
def test_true_parameters_on_the_official_signals(group, run_in, error):
    """The published integrator runs at 15 kHz; what is left is how its input is interpolated."""
    if "PZT_IDENT_DATA" not in os.environ:
        pytest.skip("PZT_IDENT_DATA is not set")
    import h5py

    with h5py.File(Path(os.environ["PZT_IDENT_DATA"]) / "boucwen_benchmark/test.h5") as file:
        force, measured = file[group]["u"][:].ravel(), file[group]["y"][:].ravel()
    rmse = np.sqrt(np.mean((displacement(force, run_in=run_in) - measured) ** 2))
    assert rmse == pytest.approx(error, rel=0.06)
