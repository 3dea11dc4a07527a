"""The loop that drives a search: when it ends, what it tells, what it refuses."""

from dataclasses import dataclass

import numpy as np
import pytest

from pzt_ident.errors import InputError, RunError
from pzt_ident.model.optimizer import Generational
from pzt_ident.model.registry import optimizers
from pzt_ident.search.loop import Stop, finite, minimize, norms, optimize


def bowl(points):
    return np.sum((points - 0.3) ** 2, axis=1)


@dataclass(frozen=True)
class Walk(Generational):
    """Ten candidates a generation, each generation closer to the bottom by a half, unless `stuck`."""

    stuck: bool = False
    name = "walk"

    def __post_init__(self):
        pass

    def search(self, dimensions, rng):
        reach = 1.0
        while True:
            yield np.clip(0.3 + reach * np.linspace(0.1, 0.7, 10)[:, None] * np.ones(dimensions), 0, 1)
            reach = reach if self.stuck else reach / 2


@pytest.mark.parametrize("budget", [1, 9, 10, 11, 25])
def test_the_last_batch_is_cut_to_the_budget(budget):
    seen = []
    outcome = optimize(Walk(), 2, lambda x: (seen.append(len(x)), bowl(x))[1], 0, Stop(budget))
    assert sum(seen) == outcome.evaluations == budget
    assert outcome.stopped_by == "evaluations"
    assert list(outcome.history.evaluations) == list(np.cumsum(seen))
    assert (np.diff(outcome.history.best) <= 0).all()
    assert (np.diff(outcome.history.seconds) >= 0).all()


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (
            lambda points: points[0],
            r"spoilt gave candidates of shape \(2,\): its `search` must yield an array \(M, 2\)",
        ),
        (lambda points: points[:, :1], r"candidates of shape \(\d+, 1\)"),
        (lambda points: points[:0], r"candidates of shape \(0, 2\)"),
        (lambda points: 3 * points, "a candidate from 0.* to [12].*: each coordinate must lie from 0 to 1"),
        (lambda points: points - 1, "a candidate from -.*: each coordinate"),
        (lambda points: points * np.nan, "a candidate from nan to nan"),
    ],
)
def test_a_candidate_outside_the_cube_is_refused(spoil, message):
    @dataclass(frozen=True)
    class Spoilt(Walk):
        name = "spoilt"

        def search(self, dimensions, rng):
            yield rng.random((9, dimensions))
            yield spoil(rng.random((9, dimensions)))

    with pytest.raises(RunError, match=message):
        optimize(Spoilt(), 2, bowl, 0, Stop(100))


@pytest.mark.parametrize("batches", [0, 1])
def test_a_search_that_ends_by_itself_is_named(batches):
    @dataclass(frozen=True)
    class Short(Walk):
        name = "short"

        def search(self, dimensions, rng):
            for _ in range(batches):
                yield rng.random((4, dimensions))

    message = f"short ended by itself after {4 * batches} of 100 evaluations: its `search` must yield"
    with pytest.raises(RunError, match=message):
        optimize(Short(), 2, bowl, 1, Stop(100))


def test_ends_at_the_target():
    outcome = optimize(Walk(), 2, bowl, 0, Stop(10_000, target=1e-4))
    assert outcome.stopped_by == "target"
    assert outcome.history.best[-1] <= 1e-4 < outcome.history.best[-2]


@pytest.mark.parametrize("value", [0.0, 3.0, -2.0, np.inf])
def test_ends_after_generations_without_improvement(value):
    outcome = optimize(Walk(stuck=True), 2, lambda x: np.full(len(x), value), 0, Stop(10_000, stagnation=5))
    assert outcome.stopped_by == "stagnation"
    assert len(outcome.history.best) == (6 if np.isfinite(value) else 5)


def test_a_gain_below_the_tolerance_is_none():
    losses = iter(1 - 1e-6 * np.arange(100))
    stop = Stop(10_000, stagnation=4, tolerance=1e-3)
    outcome = optimize(Walk(), 2, lambda x: np.full(len(x), next(losses)), 0, stop)
    assert (outcome.stopped_by, len(outcome.history.best)) == ("stagnation", 5)


def test_ends_when_the_time_is_up():
    outcome = optimize(Walk(), 2, bowl, 0, Stop(10_000, seconds=0.0))
    assert (outcome.stopped_by, outcome.evaluations) == ("seconds", 10)


def test_a_callback_sees_each_generation_and_may_end_the_search():
    states = []

    def watch(state):
        states.append(state)
        return state.generation == 3

    outcome = optimize(Walk(), 2, bowl, 0, Stop(10_000), callback=watch)
    assert outcome.stopped_by == "callback"
    assert [state.evaluations for state in states] == [10, 20, 30]
    assert [state.loss for state in states] == list(outcome.history.best)
    assert states[-1].losses.shape == (10,)
    np.testing.assert_array_equal(states[-1].point, outcome.point)


def test_the_losses_that_a_callback_keeps_stay_as_they_were():
    for word in optimizers.words():
        kept, copies = [], []
        optimizer = optimizers[word].make().with_budget(900)

        def note(state, kept=kept, copies=copies):
            kept.append(state.losses)
            copies.append(state.losses.copy())

        optimize(optimizer, 3, bowl, 1, Stop(900), callback=note)
        np.testing.assert_array_equal(np.concatenate(kept), np.concatenate(copies))


def test_replayed_generations_are_neither_evaluated_nor_told_again():
    recorded, calls = [], []
    whole = optimize(Walk(), 2, bowl, 0, Stop(60), callback=lambda state: recorded.append(state.losses))
    again = optimize(
        Walk(),
        2,
        bowl,
        0,
        Stop(60),
        earlier_losses=recorded[:4],
        callback=lambda state: calls.append(state.generation) and None,
    )
    assert calls == [5, 6]
    assert (again.loss, again.evaluations) == (whole.loss, whole.evaluations)
    np.testing.assert_array_equal(again.history.best, whole.history.best)


def test_a_whole_checkpoint_is_an_outcome():
    recorded = []
    whole = optimize(Walk(), 2, bowl, 0, Stop(25), callback=lambda state: recorded.append(state.losses))
    again = optimize(Walk(), 2, None, 0, Stop(25), earlier_losses=recorded)
    np.testing.assert_array_equal(again.point, whole.point)


def test_a_foreign_checkpoint_is_refused():
    with pytest.raises(InputError, match=r"checkpoint: losses of shape \(7,\) for 10 candidates"):
        optimize(Walk(), 2, bowl, 0, Stop(60), earlier_losses=[np.ones(7)])


def test_residuals_replay_identically():
    """They are evaluated again, since losses are all that was kept."""
    residuals = lambda x: np.column_stack([x[:, 0] - 0.2, 10 * (x[:, 1] - x[:, 0] ** 2)])  # noqa: E731
    optimizer, recorded = optimizers["least_squares"].make(), []
    run = lambda **more: optimize(optimizer, 2, None, 3, Stop(90), residuals=residuals, **more)  # noqa: E731
    whole = run(callback=lambda state: recorded.append(state.losses))
    again = run(earlier_losses=recorded[:3])
    assert again.loss == whole.loss
    np.testing.assert_array_equal(again.history.best, whole.history.best)


def test_failures_are_infinite():
    np.testing.assert_array_equal(finite([1, np.nan, np.inf, -np.inf]), [1, np.inf, np.inf, np.inf])
    np.testing.assert_allclose(norms(np.array([[3.0, 4.0], [1.0, np.nan], [np.inf, 0.0]])), [5, np.inf, np.inf])
    outcome = optimize(Walk(), 2, lambda x: np.full(len(x), np.nan), 0, Stop(20))
    assert outcome.loss == np.inf
    assert np.isnan(outcome.point).all()


@pytest.mark.parametrize("vectorized", [False, True])
def test_minimize_speaks_the_users_coordinates(vectorized):
    away = lambda x: np.sum((x - [3, -40]) ** 2, axis=-1)  # noqa: E731
    found = minimize(away, [(0, 10), (-100, 100)], "cma_es", seed=3, evaluations=1500, vectorized=vectorized)
    np.testing.assert_allclose(found.point, [3, -40], atol=1e-4)
    assert found.evaluations == 1500


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ([(1, 0)], r"bounds\[0\]: \(1, 0\)"),
        ([(0, 1), (0, np.inf)], r"bounds\[1\]: \(0, inf\)"),
        ([0, 1], r"bounds: shape \(2,\)"),
        ([], "bounds: shape"),
    ],
)
def test_bad_bounds_are_refused(bounds, message):
    with pytest.raises(InputError, match=message):
        minimize(lambda x: 0.0, bounds)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"population": 3}, "pso.population: 3 is out of bounds\n  give a value from 4 to 100000"),
        ({"population": 70.5}, "pso.population: 70.5 is not a whole number"),
        ({"generations": True}, "pso.generations: True is not a whole number"),
        ({"c1": "fast"}, "pso.c1: 'fast' is not a number"),
        ({"c1": float("nan")}, "pso.c1: nan is out of bounds"),
        ({"c_1": 2}, "pso: unknown setting 'c_1'\n  did you mean 'c1'"),
        ({"c1": 2, "c2": 2}, "pso: c1 \\+ c2 = 4\n  constriction needs c1 \\+ c2 above 4"),
    ],
)
def test_bad_settings_are_refused(settings, message):
    with pytest.raises(InputError, match=message):
        optimizers["pso"].make(**settings)


@pytest.mark.parametrize("wrong", [{"evaluations": 0}, {"stagnation": 0}, {"seconds": -1.0}, {"tolerance": -1e-3}])
def test_a_bad_stop_is_refused(wrong):
    word = next(iter(wrong))
    with pytest.raises(InputError, match=rf"stop\.{word}: .* is too small"):
        Stop(**({"evaluations": 10} | wrong))


def test_all_defaults_stand_for_the_same_budget():
    assert {item.make().evaluations for item in optimizers} == {70 * 250}
    assert all(item.make().with_budget(1001).evaluations >= 1001 for item in optimizers)
