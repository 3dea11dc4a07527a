"""The domain wall model against its differential equation and the numbers of Smith and Salapaka."""

import numpy as np
import pytest

import smith
from rig import path, response
from twins import domain_wall_twin as twin


def displacement(field, **known):
    return response(["domain_wall"], smith.domain_wall(**known), np.asarray(field, float))


@pytest.mark.parametrize("known", [smith.DW1, smith.DW2, {"alpha": 0.0, "k": 1e4, "c": 0.0}])
def test_solves_its_differential_equation(known):
    field = path(-1000, 13500, -1000, 8000, 2000, points=10)
    expected = smith.STRAIN * twin.domain_wall(field, a=4.6e5, p_s=0.49, **known)
    np.testing.assert_allclose(displacement(field, **known), expected, rtol=0, atol=5e-3 * np.ptp(expected))
    fine = displacement(path(-1000, 13500, -1000, 8000, 2000, points=400), **known)[::40]
    np.testing.assert_allclose(fine, expected, rtol=0, atol=1e-5 * np.ptp(expected))


@pytest.mark.parametrize("known", [smith.DW1, smith.DW2])
def test_loop_of_figure_4(known):
    """Span 11.5 um and width 12 % between -1 and 13.5 kV/m; closed from the third cycle on."""
    points = 400
    found = displacement(path(0, *[13500, -1000] * 4, points=points), **known)
    rising, falling = found[-2 * points - 1 : -points], found[-points - 1 :]
    assert np.ptp(rising) == pytest.approx(11.5e-6, rel=0.01)
    assert 100 * np.max(falling[::-1] - rising) / np.ptp(rising) == pytest.approx(12.0, abs=0.3)
    ends = found[2 * points :: 2 * points]
    assert abs(ends[-1] - ends[-2]) < 1e-2 * np.ptp(rising)
    slope = (falling[0] - falling[points // 100]) / (np.ptp(rising) / 100)
    assert 0.8 < slope < 0.9


def test_after_a_reversal_walls_only_bend():
    """The irreversible part waits until the anhysteretic curve is behind it: no negative slope."""
    found = displacement(path(0, 13500, 13000, points=200), **smith.DW1)
    assert np.all(np.diff(found[:201]) > 0) and np.all(np.diff(found[201:]) < 0)


def test_single_solution_is_the_anhysteretic_curve_without_pinning():
    field = path(0, 13500, -1000, points=50)
    found = displacement(field, alpha=4.5e5, k=1.47e4, c=1.0)
    expected = [twin.anhysteretic(0.0, e, 4.6e5, 4.5e5, 1.0, 0.49) for e in field]
    np.testing.assert_allclose(found, smith.STRAIN * np.array(expected), rtol=0, atol=1e-15)


def test_mirrored():
    field = path(0, 13500, -4000, 2000, points=60)
    np.testing.assert_allclose(displacement(-field, **smith.DW1), -displacement(field, **smith.DW1), rtol=1e-12)


def test_set_as_printed_runs_away():
    assert np.isnan(displacement(path(0, 13500, points=50), **smith.PRINTED)).all()


def test_walls_that_run_away_end_on_the_anhysteretic_curve():
    """Against condition (9), k - alpha (P_an - P_irr) > 0."""
    field = path(0, 2e5, points=50)
    found = displacement(field, alpha=4.5e5, k=1e3, c=0.2)
    expected = [twin.anhysteretic(0.0, e, 4.6e5, 4.5e5, 1.0, 0.49) for e in field]
    np.testing.assert_allclose(found[5:], smith.STRAIN * np.array(expected)[5:], rtol=1e-2)
