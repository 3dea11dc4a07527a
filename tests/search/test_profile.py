"""Intervals where the curvature misleads, and where runs of the same RMSE disagree."""

import numpy as np
import pytest

from pzt_ident.search.profile import intervals
from pzt_ident.search.uncertainty import judged


class Toy:
    """Residuals that are a function of the unit cube."""

    def __init__(self, residual, dimensions):
        self.residual, self.dimensions, self.swing = residual, dimensions, 1.0

    def residuals(self, points):
        return np.array([self.residual(point) for point in np.atleast_2d(points)])

    def loss(self, points):
        return np.linalg.norm(self.residuals(points), axis=1)

    def begun_at(self, point):
        return self

    def best(self, points, near, squares=None):
        losses = self.loss(points)
        return points[np.argmin(losses)], losses.min()

    def equations(self, point, central=True, step=1e-6):
        moved = np.eye(self.dimensions) * step
        jacobian = (self.residuals(point + moved) - self.residuals(point - moved)).T / (2 * step)
        return jacobian, self.residuals(point)[0]


def ends(residual, point, errors, **more):
    toy = Toy(residual, len(point))
    return intervals(toy, np.array(point), toy.equations(np.array(point))[0], np.array(errors), **more)


def test_of_a_line_they_are_those_of_the_standard_error():
    matrix = np.random.default_rng(0).normal(size=(50, 2))
    bounds = ends(lambda p: np.append(matrix @ (p - [0.4, 0.5]), 3), [0.4, 0.5], [0.02, 0.05])
    np.testing.assert_allclose(bounds, [[0.4 - 1.96 * 0.02, 0.4 + 1.96 * 0.02], [0.5 - 1.96 * 0.05, 0.5 + 1.96 * 0.05]])


def test_a_side_on_which_the_loss_stays_flat_is_open():
    """A response that saturates: no larger value is told from another."""
    bounds = ends(lambda p: np.array([np.tanh(8 * (p[0] - 0.3)) - np.tanh(2.4), 0.5]), [0.6], [0.08])
    assert bounds[0, 0] == pytest.approx(0.6 - 1.96 * 0.08) and bounds[0, 1] > 1


def test_where_there_is_no_time_for_a_profile_the_curvature_is_believed():
    def saturating(p):
        return np.array([np.tanh(8 * (p[0] - 0.3)) - np.tanh(2.4), 0.5])

    assert ends(saturating, [0.6], [0.08], going=lambda: False)[0, 1] == pytest.approx(0.6 + 1.96 * 0.08)


def test_the_others_are_fitted_again():
    """Along the valley y = x^2 the loss rises as its curvature says, though it rises steeply on the line beside it."""
    bounds = ends(lambda p: np.array([20 * (p[1] - p[0] ** 2), 0.1 * (p[0] - 0.5), 1.0]), [0.5, 0.25], [0.06, 0.06])
    assert bounds[0] == pytest.approx([0.5 - 1.96 * 0.06, 0.5 + 1.96 * 0.06])


def run(rmse, value, **more):
    facts = {"unit": "s", "lower": 1e-3, "upper": 10.0, "scale": "log", "verdict": "determined", "note": ""}
    parameter = facts | {"value": value, "standard_error": 0.02, "interval": [value - 0.04, value + 0.04]} | more
    return {"rmse": {"identify": rmse, "validate": None}, "parameters": {"creep.tau": parameter}}


def test_runs_of_one_rmse_that_scatter_a_value_do_not_determine_it():
    best = run(1.0, 0.062)
    tau = judged(best, [best, run(1.0002, 1.46), run(1.3, 9.0)])["parameters"]["creep.tau"]
    assert tau["verdict"] == "not determined" and tau["standard_error"] is None
    assert tau["note"] == "runs whose RMSE differs by less than 1 % put it at 0.062 to 1.46 s"
    assert best["parameters"]["creep.tau"]["verdict"] == "determined"


def test_worse_runs_and_near_ones_say_nothing_against_it():
    best = run(1.0, 0.062)
    assert judged(best, [best, run(1.1, 1.46), run(1.0001, 0.063)]) == best
