"""What the papers say of Levenberg-Marquardt and of the secant Hessian."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from pzt_ident.optimizers.least_squares import LeastSquares, bounded_steps, descend, secant, size
from pzt_ident.search.loop import Stop, optimize

seeds = st.integers(0, 2**32 - 1)


@given(seed=seeds)
@settings(max_examples=30, deadline=None)
def test_a_step_without_damping_is_that_of_gauss_and_newton(seed):
    rng = np.random.default_rng(seed)
    jacobian, answer = rng.normal(size=(9, 4)), 1e-3 * rng.normal(size=9)
    (step,) = bounded_steps(np.full(4, 0.5), jacobian.T @ answer, jacobian.T @ jacobian, 0.0)
    np.testing.assert_allclose(step, -np.linalg.lstsq(jacobian, answer, rcond=None)[0], rtol=1e-6, atol=1e-12)


def test_damping_turns_the_step_downhill_and_shortens_it():
    hessian, gradient = np.diag([1.0, 100.0]), np.array([1e-3, 1e-3])
    steps = bounded_steps(np.full(2, 0.5), gradient, hessian, [0.0, 1.0, 1e6])
    np.testing.assert_allclose(steps[1], -gradient / (2 * np.diag(hessian)))
    assert [float(np.linalg.norm(step)) for step in steps] == sorted((np.linalg.norm(s) for s in steps), reverse=True)


@given(st.lists(st.floats(0, 1), min_size=3, max_size=3), st.floats(1e-5, 1e4), st.integers(0, 7), seeds)
def test_a_step_stays_inside_and_moves_nothing_that_is_held(point, damping, held, seed):
    rng = np.random.default_rng(seed)
    jacobian, residual = rng.normal(size=(20, 3)), rng.normal(size=20)
    movable = np.array([bool(held >> i & 1) for i in range(3)])
    (step,) = bounded_steps(np.array(point), jacobian.T @ residual, jacobian.T @ jacobian, damping, movable)
    assert not step[~movable].any()
    assert np.all((point + step >= 0) & (point + step <= 1))


@given(st.lists(st.sampled_from([0.0, 0.3, 1.0]), min_size=4, max_size=4), seeds)
@settings(max_examples=30, deadline=None)
def test_steps_side_by_side_are_those_of_each_damping_alone(point, seed):
    """Coordinates may be of very different size, and steps may end at different bounds."""
    rng = np.random.default_rng(seed)
    jacobian, residual = rng.normal(size=(20, 4)) * [1e-2, 1, 10, 1e3], 1e-4 * rng.normal(size=20)
    hessian, gradient, dampings = jacobian.T @ jacobian, jacobian.T @ residual, np.array([1e-9, 1e-2, 1.0, 1e3])
    steps = bounded_steps(np.array(point), gradient, hessian, dampings)
    for step, damping in zip(steps, dampings, strict=True):
        np.testing.assert_allclose(step, bounded_steps(np.array(point), gradient, hessian, damping)[0], rtol=1e-9)
        damped = hessian + damping * np.diag(np.diag(hessian))
        (inside,) = bounded_steps(np.full(4, 0.5), gradient, hessian, damping)
        np.testing.assert_allclose(
            inside, np.clip(-np.linalg.solve(damped, gradient), -0.5, 0.5), rtol=1e-5, atol=1e-15
        )


@given(seed=seeds)
@settings(max_examples=10, deadline=None)
def test_a_linear_problem_is_solved_at_once_even_on_its_bounds(seed):
    rng = np.random.default_rng(seed)
    matrix, target = rng.normal(size=(12, 3)), rng.normal(size=12)
    optimizer = LeastSquares(budget=120)
    residuals = lambda points: points @ matrix.T - target  # noqa: E731
    found = optimize(optimizer, 3, lambda x: np.linalg.norm(residuals(x), axis=1), 1, Stop(120), residuals=residuals)
    best = lsq_linear(matrix, target, bounds=(0, 1), tol=1e-14).x
    assert found.loss == pytest.approx(float(np.linalg.norm(matrix @ best - target)), rel=1e-9)


@given(seed=seeds, slope=st.floats(1e12, 1e30))
@settings(max_examples=20, deadline=None)
def test_what_runs_away_hides_no_other_parameter(seed, slope):
    """A linear problem beside a parameter at its bound that any step takes far away."""
    rng = np.random.default_rng(seed)
    matrix, target = rng.normal(size=(12, 3)), rng.normal(size=12)
    residuals = lambda points: points[:, 1:] @ matrix.T - target + slope * points[:, :1]  # noqa: E731
    start = np.append(0.0, rng.random(3))
    end = start
    steps = descend(start, residuals(start[None])[0])
    points = next(steps)
    for _ in range(60):
        answers = residuals(points)
        sizes = [size(answer) for answer in answers]
        end = min([end, points[int(np.argmin(sizes))]], key=lambda point: size(residuals(point[None])[0]))
        try:
            points = steps.send(answers)
        except StopIteration:
            break
    best = lsq_linear(matrix, target, bounds=(0, 1), tol=1e-14).x
    assert np.linalg.norm(residuals(end[None])[0]) == pytest.approx(np.linalg.norm(matrix @ best - target), rel=1e-6)


@given(seed=seeds)
@settings(max_examples=30, deadline=None)
def test_the_secant_hessian_knows_the_last_move(seed):
    """Nocedal & Wright (2006), 6.6: H s = y, and H stays positive definite."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(4, 4))
    true = root @ root.T + np.eye(4)
    s = rng.normal(size=4)
    before = np.zeros(4), np.zeros(4)
    hessian = secant(np.eye(4), before, s, true @ s)
    np.testing.assert_allclose(hessian @ s, true @ s, rtol=1e-9, atol=1e-9)
    bent = secant(np.eye(4), before, s, -true @ s)
    assert np.linalg.eigvalsh(hessian).min() > 0 and np.linalg.eigvalsh(bent).min() > 0
