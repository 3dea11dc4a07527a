"""The stage of the coverage experiment against its equations, and one campaign from its seed to its score."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from experiments.coverage import campaign, stage, tally
from experiments.coverage.fit import solve


def test_bouc_wen_solves_its_equation():
    def rates(t, h):
        slope = 80 * np.cos(2 * t)
        return 0.04 * slope - 0.05 * abs(slope) * h - 0.02 * slope * abs(h)

    t = np.linspace(0, 6, 6001)
    h = solve_ivp(rates, (0, 6), [0.0], t_eval=t, rtol=1e-8, atol=1e-10, max_step=0.01).y[0]
    u = 40 * np.sin(2 * t)
    assert np.max(np.abs(0.1 * u - stage.bouc_wen(u, 0.1, 0.4, 0.05, 0.02) - h)) < 2e-6


def test_the_mass_rings_at_its_frequency_and_comes_to_rest_at_the_force():
    truth = {"gain": 0.1, "alpha": 0.0, "beta": 0.03, "gamma": 0.0, "damping": 5.0}
    truth["stiffness"] = stage.MASS * (2 * np.pi * 100) ** 2
    y = stage.displacement(np.minimum(np.arange(8000) * 1.0, 1.0), 1e-4, truth)
    crossings = np.flatnonzero((y[1:3000] > 0.1) & (y[:2999] <= 0.1))
    assert 1 / (np.mean(np.diff(crossings)) * 1e-4) == pytest.approx(100, rel=0.01)
    assert y[-1] == pytest.approx(0.1, abs=1e-6)


@pytest.mark.parametrize("colour", campaign.COLOURS)
def test_noise_has_unit_variance_in_any_colour(colour):
    found = campaign.noise(np.random.default_rng(1), 400_000, colour)
    assert found.std() == pytest.approx(1, rel=0.03)
    first = {"white": 0, "coloured": 0.9, "mixture": 0.49}[colour]
    assert np.corrcoef(found[1:], found[:-1])[0, 1] == pytest.approx(first, abs=0.01)


def test_one_seed_is_one_stage_in_any_colour():
    white, coloured = (campaign.draw(3, colour) for colour in ("white", "coloured"))
    assert white.truth == coloured.truth and np.array_equal(white.clean[2], coloured.clean[2])
    assert not np.array_equal(white.readings[0], coloured.readings[0])


def test_a_campaign_is_identified_and_its_errors_are_some_standard_errors():
    found = solve(1, "coloured")
    assert set(found["errors"]) == set(campaign.draw(1, "white").truth)
    assert all(abs(error) < 6 for error in found["errors"].values())
    assert found["rmse"] < 3 * campaign.NOISE
    rows = [{"seed": 1, "colour": colour} | found for colour in campaign.COLOURS]
    assert "| gain | " in tally.text(rows) and "| campaigns | 1 | 1 | 1 |" in tally.text(rows)
