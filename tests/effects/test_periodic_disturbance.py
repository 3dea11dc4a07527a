"""A periodic disturbance: any phase of a line at its frequency."""

import numpy as np
import pytest

from pzt_ident.effects.periodic_disturbance import PeriodicDisturbance
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.registry import blocks
from rig import model, record


def basis(t, frequency):
    """Sine and cosine over the times of a record: (2, samples)."""
    return np.transpose([PeriodicDisturbance.basis(each, frequency, t[-1]) for each in t])


def test_sine_and_cosine_make_any_phase():
    t = np.linspace(0, 0.1, 500)
    sine, cosine = basis(t, 50.0)
    np.testing.assert_allclose(0.3 * (np.cos(0.7) * sine + np.sin(0.7) * cosine), 0.3 * np.sin(100 * np.pi * t + 0.7))


@pytest.mark.parametrize(("frequency", "left"), [(50.0, 0), (73.0, 0.03 / np.sqrt(2))])
def test_takes_its_own_line_out_of_a_record_and_no_other(frequency, left):
    drive = np.linspace(0, 100, 1000)
    hum = 0.03 * np.sin(100 * np.pi * 1e-3 * np.arange(1000) + 1)
    simulator = Simulator(model("periodic_disturbance"), record(drive, response=[drive + hum]))
    assert np.sqrt(simulator.squares(np.array([[frequency]]))[0, 0] / 1000) == pytest.approx(left, rel=1e-3, abs=1e-12)


def test_a_record_of_less_than_three_periods_has_none():
    t = np.linspace(0, 0.1, 500)
    assert np.ptp(basis(t, 31.0)) > 1.9
    assert not np.any(basis(t, 29.0))


def waves(frequency, hum, size=0.2):
    """A sine drive over 10 s whose residual has its second and third harmonic, and a hum."""
    t = np.arange(20_000) / 2000
    phase = 2 * np.pi * frequency * t
    return t, np.sin(phase), size * np.cos(2 * phase) + size * np.sin(3 * phase) + 0.05 * np.sin(2 * np.pi * hum * t)


def test_harmonics_of_the_drive_are_no_disturbance():
    t, drive, residual = waves(1.3, 50.3)
    assert PeriodicDisturbance.guess([t], [drive], [residual], 1, 900)[0] == pytest.approx(50.3, abs=0.02)


@pytest.mark.parametrize(("frequency", "possible"), [(1.3, {50, 60, 100, 120}), (5.0, {120}), (10.0, set())])
def test_mains_are_tried_where_they_are_no_harmonics_of_the_drive(frequency, possible):
    """Up to the twentieth, of which hysteresis leaves something."""
    t, drive, residual = waves(frequency, 31.7)
    guesses = PeriodicDisturbance.guess([t], [drive], [residual], 1, 900)
    assert set(guesses) & {50, 60, 100, 120} == possible


def test_a_record_at_rest_shows_a_line_wherever_it_is():
    t, _, residual = waves(1.3, 3.9, size=0.0)
    assert PeriodicDisturbance.guess([t], [np.zeros_like(t)], [residual], 1, 900)[0] == pytest.approx(3.9, abs=0.02)


def test_less_than_some_periods_are_drift():
    t, drive, _ = waves(0.3, 1)
    slow = np.sin(2 * np.pi * 0.31 * t)
    assert all(PeriodicDisturbance.guess([t], [0 * drive], [slow], 0.1, 900) >= 0.8)


def rippled(amounts, frequency=20.0, samples=500, dt=1e-3):
    """The drive behind a ripple, on a drive of zero: (samples,)."""
    chain = model("periodic_disturbance.ripple")
    at_rest = Simulator(chain, record(np.zeros(samples), dt=dt))
    return at_rest.simulate(np.array([[frequency, *amounts]]))[0, 0]


@pytest.mark.parametrize(("form", "orders"), [("harmonics", (1, 2, 3)), ("odd_harmonics", (1, 3, 5))])
def test_mains_may_have_harmonics(form, orders):
    t = 1e-3 * np.arange(500)
    found = np.transpose([blocks[f"periodic_disturbance.{form}"].basis(each, 20.0, t[-1]) for each in t])
    waves = [wave(2 * np.pi * n * 20 * t) for n in orders for wave in (np.sin, np.cos)]
    np.testing.assert_allclose(found, waves, atol=1e-12)


def test_a_ripple_is_the_line_and_its_third_harmonic_ahead_of_the_hysteresis():
    phase = 2 * np.pi * 20 * 1e-3 * np.arange(500)
    waves = np.sin(phase), np.cos(phase), np.sin(3 * phase), np.cos(3 * phase)
    for amounts in np.eye(4):
        np.testing.assert_allclose(rippled(amounts), amounts @ waves, atol=1e-12)


def test_the_phase_of_a_ripple_does_not_creep():
    """A rotation a million times over."""
    samples = 1_000_000
    wave = rippled([1, 0, 0, 0], 37.7, samples, 1e-4)
    np.testing.assert_allclose(wave[-500:], np.sin(2 * np.pi * 37.7e-4 * np.arange(samples)[-500:]), atol=1e-8)


def test_a_record_of_less_than_a_period_has_no_ripple():
    assert np.ptp(rippled([1, 0, 0, 0], 2.1)) > 1.9
    assert not rippled([1, 0, 0, 0], 1.9).any()
