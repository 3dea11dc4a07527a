"""Parameters of which each record has its own, ahead of a hysteresis that bends what they do."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from pzt_ident.engine.additions import SURE
from pzt_ident.engine.amounts import Amounts
from pzt_ident.engine.simulator import Simulator
from pzt_ident.search.problem import Problem
from rig import model, record

BLOCKS = ("bouc_wen", "periodic_disturbance.ripple")
rng = np.random.default_rng(3)
t = 1e-3 * np.arange(1200)
VALUES = {"frequency": 40.0, "gain": 1e-7, "alpha": 0.5, "beta": 0.02, "gamma": 0.05, "ratio": 0.2, "tau": 0.3}
TRUTH = np.array([[VALUES[entry.word] for entry in model(*BLOCKS).entries]])
AMOUNTS = np.array([0.8, -0.5, 0.1, 0.2])


def made_up(amounts=AMOUNTS, chain=BLOCKS, theta=TRUTH, noise=0.0, axes=1, **more):
    """A record of the chain with these amounts, for each axis."""
    drives = [50 * np.abs(np.sin((2 + axis) * t)) for axis in range(axes)]
    made = model(*chain, axes=axes)
    complete = np.hstack([theta, np.tile(amounts, (1, axes))])
    clean = Simulator(made, record(*drives, **more)).simulate(complete)[0] + 3e-6
    return made, record(*drives, response=clean + noise * rng.normal(size=clean.shape), **more)


def settled(made, measured, theta=TRUTH):
    return Simulator(made, measured).amounts.complete(theta)[:, theta.shape[1] :]


def near_truth(count=6, theta=TRUTH):
    return theta * (1 + 0.05 * rng.uniform(-1, 1, (count, theta.shape[1])))


@pytest.mark.parametrize("turn", [0, 1, 2.5, 4])
@pytest.mark.parametrize("size", [0.01, 1, 3])
def test_any_phase_and_size_is_found_beside_the_truth(turn, size):
    amounts = size * np.array([np.cos(turn), np.sin(turn), 0.1 * np.sin(turn), 0.2 * np.cos(turn)])
    made, measured = made_up(amounts)
    np.testing.assert_allclose(settled(made, measured)[0], amounts, atol=1e-6 * size)
    assert np.sqrt(Simulator(made, measured).squares(TRUTH)[0, 0] / t.size) < 1e-12


def test_of_two_axes_each_has_its_own_and_a_coupling_carries_it_over():
    chain = (*BLOCKS, "kinematic_coupling")
    theta = np.array([[VALUES[entry.word] for entry in model(*chain, axes=2).entries]])
    made, measured = made_up(chain=chain, theta=theta, axes=2)
    np.testing.assert_allclose(settled(made, measured, theta)[0], np.tile(AMOUNTS, 2), atol=1e-6)


@pytest.mark.parametrize("more", [{}, {"settle": 200}, {"run_in": 1}, {"settle": 50, "start": 3.0}])
def test_squares_are_those_of_the_errors(more):
    made, measured = made_up(chain=(*BLOCKS, "drift"), theta=np.append(TRUTH, [[0.3]], axis=1), noise=1e-9, **more)
    simulator, theta = Simulator(made, measured), near_truth(theta=np.append(TRUTH, [[0.3]], axis=1))
    errors = np.square(simulator.errors(theta)[:, :, simulator.record.settle :]).sum(axis=2)
    np.testing.assert_allclose(simulator.squares(theta), errors, rtol=SURE)  # half of the digits are left, at least
    tiles = np.concatenate([error for _, error in simulator.tiles(theta)], axis=2)
    assert tiles.shape[2] == simulator.scored


def test_no_amount_leaves_less_by_more_than_the_bends_of_the_residual():
    made, measured = made_up(noise=1e-8)
    simulator, theta = Simulator(made, measured), near_truth(1)
    complete, least = simulator.amounts.complete(theta), simulator.squares(theta)[0, 0]

    def left(amounts):
        error = simulator.simulate(np.hstack([theta, amounts[None]]))[0, 0] - measured.response[0]
        return np.square(error - error.mean()).sum()

    for move in 1e-3 * rng.normal(size=(20, 4)):
        assert left(complete[0, theta.shape[1] :] + move) > least * (1 - 1e-4)


def test_a_candidate_is_settled_alike_in_any_company():
    made, measured = made_up(noise=1e-8)
    theta = near_truth(9)
    together = settled(made, measured, theta)
    alone = np.vstack([settled(made, measured, row[None]) for row in theta])
    np.testing.assert_array_equal(together, alone)


def test_threads_that_share_a_simulator_get_their_own():
    made, measured = made_up(noise=1e-8)
    simulator, thetas = Simulator(made, measured), near_truth(4)[:, None]
    alone = [simulator.amounts.complete(theta) for theta in thetas]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(simulator.amounts.complete, [*thetas] * 25))
    for each, expected in zip(together, alone * 25, strict=True):
        np.testing.assert_array_equal(each, expected)


def test_a_candidate_that_fails_is_infinite_and_disturbs_no_other():
    made, measured = made_up(noise=1e-8)
    problem, theta = Problem(made, [measured]), near_truth(3)
    alone = settled(made, measured, theta[[0, 2]])
    theta[1, 1] = np.nan
    np.testing.assert_array_equal(settled(made, measured, theta)[[0, 2]], alone)
    assert np.isnan(problem.simulators["identify"][0].squares(theta)[1, 0])


def test_what_was_not_measured_has_none():
    made, measured = made_up()
    bare = Simulator(model("bouc_wen"), measured).simulate(TRUTH[:, 1:])
    np.testing.assert_allclose(Simulator(made, measured).simulate(TRUTH), bare, rtol=1e-14)


def test_the_size_of_what_it_adds_is_told():
    made, measured = made_up(AMOUNTS)
    simulator = Simulator(made, measured)
    with_it, without = simulator.simulate(np.append(TRUTH, AMOUNTS[None], axis=1)), simulator.simulate(TRUTH)
    added = simulator.added(TRUTH[0])["periodic_disturbance"]
    assert added[0] == pytest.approx(np.std(with_it - without), rel=1e-5)


@pytest.mark.parametrize("seed", range(4))
def test_the_gradient_is_that_of_the_loss_with_amounts_that_follow(seed):
    made, measured = made_up(noise=0.0)
    noise = 1e-8 * np.random.default_rng(seed).normal(size=measured.response.shape)
    problem = Problem(made, [replace(measured, response=measured.response + noise)])
    aside = 1 + 1e-2 * np.array([0, 1, -1, 1, 1])
    point = problem.unit_point(dict(zip(made.names, TRUTH[0] * aside, strict=True)))
    jacobian, residual = problem.equations(point)
    moved = point + 1e-5 * np.vstack([np.eye(point.size), -np.eye(point.size)])
    up, down = np.split(np.square(problem.near(point).rotated_residuals(moved)).sum(axis=1) / 2, 2)
    slope = (up - down) / 2e-5
    np.testing.assert_allclose(jacobian.T @ residual, slope, rtol=0, atol=1e-3 * np.abs(slope).max())


def test_points_are_ranked_with_amounts_that_follow_to_first_order():
    made, measured = made_up(noise=1e-8)
    problem = Problem(made, [measured])
    point = problem.unit_point(dict(zip(made.names, TRUTH[0], strict=True)))
    points = np.clip(point + 1e-3 * rng.normal(size=(8, point.size)) * [0, 1, 1, 1, 1], 0, 1)
    assert problem.rough_loss(point[None], point)[0] == pytest.approx(problem.loss(point)[0], rel=1e-6)
    np.testing.assert_allclose(problem.rough_loss(points, point), problem.loss(points), rtol=0.1)


def test_beside_a_candidate_they_are_sought_from_its_own_and_are_those_from_zero():
    made, measured = made_up(noise=1e-8)
    simulator, theta = Simulator(made, measured), TRUTH + 0.02 * (near_truth(5) - TRUTH)
    begun = simulator.begun_at(simulator.held(TRUTH))
    np.testing.assert_allclose(begun.amounts.near, settled(made, measured)[0], rtol=1e-12)
    np.testing.assert_allclose(begun.squares(theta), simulator.squares(theta), rtol=1e-4)


def test_what_was_settled_last_is_not_settled_again(monkeypatch):
    made, measured = made_up(noise=1e-8)
    simulator, theta = Simulator(made, measured), near_truth(2)
    complete = simulator.amounts.complete(theta)
    begun = simulator.begun_at(simulator.held(theta[:1]))
    monkeypatch.setattr(Amounts, "_solved", None)
    np.testing.assert_array_equal(begun.amounts.complete(theta[1:]), complete[1:])
    monkeypatch.setattr(Simulator, "simulate", None)
    assert begun.held(theta[:1]) is simulator.held(theta[:1])


def test_without_any_a_problem_begins_as_it_is():
    problem = Problem(model("bouc_wen"), [record(50 * np.abs(np.sin(2 * t)), response=1e-6 * np.sin(2 * t)[None])])
    assert problem.begun_at(np.full(problem.dimensions, 0.5)) is problem
