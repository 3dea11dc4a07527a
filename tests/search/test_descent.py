"""The least squares of polish and refits against closed forms, and against SciPy's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares, lsq_linear

from pzt_ident.engine import simulator
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks
from pzt_ident.search import descent
from pzt_ident.search.descent import BEHIND, CRAWLING, FAR, FEW, PATIENCE, REFINED, descend, polish
from pzt_ident.search.problem import Problem
from pzt_ident.search.stencil import DIFFERENCE, NARROW, forward, half_widths, stencil
from pzt_ident.search.uncertainty import covariance
from rig import record, response

TRUTH = {"bouc_wen.gain": 0.082e-6, "bouc_wen.alpha": 0.56, "bouc_wen.beta": 0.015, "bouc_wen.gamma": 0.055}
WAVE = 65 * (1 - np.cos(2 * np.pi * np.arange(3000) / 1000)) * (1 + np.arange(3000) / 6000)


class Linear:
    """Residuals A x - b over the unit cube."""

    def __init__(self, matrix, target):
        self.matrix, self.target, self.dimensions = matrix, target, matrix.shape[1]
        self.swing = np.linalg.norm(target)

    def residual(self, point):
        return self.matrix @ point - self.target

    def narrowed(self, point):
        return self

    def equations(self, point, central=True):
        return self.matrix, self.residual(point)

    def begun_at(self, point):
        return self

    def best(self, points, near, squares=None):
        losses = np.linalg.norm([self.residual(point) for point in points], axis=1)
        return points[np.argmin(losses)], losses.min()


@given(st.integers(1, 6), st.floats(0, 6), st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_a_linear_problem_within_bounds_has_its_closed_form(count, decades, seed):
    """Columns as unlike in size as decades apart, and targets whose optimum lies inside, on faces and on edges."""
    rng = np.random.default_rng(seed)
    matrix = rng.normal(size=(15, count)) * 10 ** rng.uniform(-decades / 2, decades / 2, count)
    target = matrix @ rng.uniform(-0.5, 1.5, count) + 0.1 * rng.normal(size=15)
    point, _ = polish(Linear(matrix, target), rng.uniform(size=count))
    expected = lsq_linear(matrix, target, bounds=(0, 1), tol=1e-15, method="bvls").x
    loss = np.linalg.norm(matrix @ expected - target)
    assert np.linalg.norm(matrix @ point - target) <= (1 + 1e-9) * loss
    np.testing.assert_allclose(matrix @ point, matrix @ expected, atol=1e-5 * np.linalg.norm(target))


@pytest.mark.parametrize(
    ("fall", "above", "rough", "taken"),
    [
        (2 * CRAWLING, 2 * FAR, False, 30),
        (CRAWLING / 2, 2 * FAR, False, PATIENCE),
        (CRAWLING / 2, 0.9 * FAR, False, 30),
        (CRAWLING / 2, 0, True, PATIENCE),
        (2 * CRAWLING, 0, True, 30),
        (REFINED / 2, 0, False, PATIENCE),
    ],
)
def test_a_rough_descent_that_crawls_is_given_up_and_one_far_above_a_rival(monkeypatch, fall, above, rough, taken):
    """After steps that each take the same share off, the first of which counts as long."""
    losses = above * (1 - fall) ** np.arange(1, 40)
    monkeypatch.setattr(descent, "steps", lambda *args: ((np.array([i]), loss, fall) for i, loss in enumerate(losses)))
    assert descend(None, np.zeros(1), most=30, rival=1.0, rough=rough)[0] + 1 == taken


@pytest.mark.parametrize(("above", "patience", "taken"), [(10.0, 7, 7), (10.0, 2, FEW), (BEHIND / 0.9**6, 7, 10)])
def test_a_descent_that_took_long_is_given_up_behind_a_rival(monkeypatch, above, patience, taken):
    """After steps that each took a tenth off there is no more patience; what is hardly above 1 by then goes on."""
    losses = above * 0.9 ** np.arange(1, 11)
    monkeypatch.setattr(descent, "steps", lambda *args: ((np.array([i]), loss, 0.1) for i, loss in enumerate(losses)))
    asked = iter([True] * (patience - FEW) + [False] * 10)
    assert descend(None, np.zeros(1), most=10, rival=1.0, patient=lambda: next(asked))[0] + 1 == taken


@pytest.fixture(scope="module")
def problem():
    """Two records with noise, so that the optimum leaves something."""
    rng = np.random.default_rng(3)
    made = []
    for drive in (WAVE, WAVE[::-1] - WAVE[-1]):
        clean = response(["bouc_wen"], TRUTH, drive)
        made.append(record(drive, response=[clean + 4e-6 + rng.normal(0, 2e-8, drive.size)]))
    return Problem(Chain([blocks["bouc_wen"]], "x", [0]), made)


def test_it_ends_where_scipy_ends(problem):
    start = np.clip(problem.unit_point({name: 1.2 * value for name, value in TRUTH.items()}), 0.01, 0.99)
    point, spent = polish(problem, start)
    size = problem.loss(start)[0]
    theirs = least_squares(
        lambda x: problem.residuals(x)[0] / size,
        start,
        lambda x: problem.jacobian(x) / size,
        bounds=(0, 1),
        x_scale="jac",
        ftol=1e-12,
        xtol=1e-12,
        gtol=1e-14,
    )
    np.testing.assert_allclose(point, theirs.x, atol=1e-6)
    assert problem.loss(point)[0] <= (1 + 1e-9) * problem.loss(theirs.x)[0]
    assert 0 < spent < 2000


@pytest.mark.parametrize("share", [0, 1e-33, 1e-26, 1e-18])
@pytest.mark.parametrize("descended", [descend, lambda problem, start: polish(problem, start)[0]])
def test_beside_a_hysteresis_that_runs_away_all_else_is_found(share, descended):
    """Without a share in the response, and with a decay of -0.8 / V over 130 V, which grows e^100 fold: the slope along
    the share is a thousand times the response in the 10^26th part of its range."""
    measured = record(WAVE, response=[TRUTH["bouc_wen.gain"] * WAVE])
    problem = Problem(Chain([blocks["bouc_wen"]], "x", [0]), [measured])
    names = {"bouc_wen.gain": 0.1e-6, "bouc_wen.alpha": share, "bouc_wen.beta": 0.0, "bouc_wen.gamma": 0.8}
    start = problem.unit_point(names)
    assert problem.loss(start)[0] > 0.1 * problem.swing
    assert problem.loss(descended(problem, start))[0] < 1e-6 * problem.swing


def test_the_swing_is_the_loss_of_a_response_that_does_not_move(problem):
    flat = problem.unit_point({name: 1e-30 if name == "bouc_wen.gain" else value for name, value in TRUTH.items()})
    assert problem.swing == pytest.approx(problem.loss(flat)[0], rel=1e-12)


def test_its_equations_are_those_of_all_samples(problem):
    point = problem.unit_point(TRUTH) + 0.003
    jacobian, residual = problem.equations(point)
    full, errors = problem.jacobian(point), problem.residuals(point)[0]
    scale = np.linalg.norm(full, axis=0)
    np.testing.assert_allclose(
        jacobian.T @ jacobian / np.outer(scale, scale), full.T @ full / np.outer(scale, scale), atol=1e-9
    )
    np.testing.assert_allclose(
        jacobian.T @ residual / scale, full.T @ errors / scale, atol=1e-9 * np.linalg.norm(errors)
    )
    parts = [rows for _, rows in problem.samples(point)]
    np.testing.assert_allclose(np.hstack(parts)[0], errors, atol=1e-12 * np.linalg.norm(errors))


@pytest.mark.parametrize("length", [64, 1024])
def test_the_length_of_a_stretch_moves_no_result(problem, length, monkeypatch):
    start = problem.unit_point(TRUTH) + 0.003
    whole, errors = polish(problem, start)[0], covariance(problem, start)
    monkeypatch.setattr(simulator, "STRETCH", length)
    np.testing.assert_allclose(polish(problem, start)[0], whole, atol=1e-8)
    np.testing.assert_allclose(covariance(problem, start), errors, rtol=1e-6, atol=1e-9 * np.abs(errors).max())


def test_differences_are_exact_of_a_parabola_inside_and_one_sided_on_a_face():
    value = lambda x: np.array([3 * p[0] ** 2 - p[1] for p in x])  # noqa: E731
    points, weights = stencil(np.array([0.4, 0.7]))
    np.testing.assert_allclose(weights @ value(points), [3 * 0.16 - 0.7, 2.4, -1], atol=1e-9)
    points, weights = stencil(np.array([1.0, 0.0]))
    assert points.min() >= 0 and points.max() <= 1
    np.testing.assert_allclose(weights @ value(points), [3, 6 - 3e-5, -1], atol=1e-9)
    points, weights = forward(np.array([1.0, 0.0]))
    assert points.min() >= 0 and points.max() <= 1
    np.testing.assert_allclose(weights @ value(points), [3, 6, -1], atol=1e-7)
    failed = np.array([False, False, True, False, False])
    points, weights = stencil(np.array([0.4, 0.7]), failed=failed)
    np.testing.assert_allclose(weights @ value(points), [3 * 0.16 - 0.7, 2.4, -1], atol=1e-9)


@pytest.mark.parametrize("place", [0.0, 0.3, 1.0])
def test_differences_are_narrow_along_what_bends_within_them(place):
    """Turns of a mode over a record: so many that a usual step is a tenth of a radian, and few."""
    times = np.linspace(0, 1, 500)
    ringing = lambda x: np.array([np.sin(1 + 1e4 * p[0] * times) + np.sin(1 + 10 * p[1] * times) for p in x])  # noqa: E731
    np.testing.assert_array_equal(half_widths(np.array([place, 0.5]), ringing), [NARROW, DIFFERENCE])
