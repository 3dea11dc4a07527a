"""What the papers say of the real-coded genetic algorithm."""

import random

import numpy as np
import pytest
from deap import tools
from hypothesis import given, settings
from hypothesis import strategies as st

from pzt_ident.optimizers.rga import RGA, Fitness, Individual, migrate, select


@given(count=st.integers(1, 40), size=st.integers(2, 30), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_universal_sampling_never_strays_from_the_expectation_by_one(count, size, seed):
    """Baker (1987): what should be drawn 2.3 times is drawn 2 or 3 times."""
    rng = np.random.default_rng(seed)
    losses = rng.random(size)
    drawn = np.bincount(select(losses, count, rng), minlength=size)
    length = 1 / np.sqrt(1 + np.argsort(np.argsort(losses)))
    expected = count * length / length.sum()
    assert drawn.sum() == count
    assert (np.abs(drawn - expected) < 1 + 1e-9).all()


@given(count=st.integers(1, 60), size=st.integers(2, 40), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_universal_sampling_is_that_of_deap(count, size, seed):
    losses = np.random.default_rng(seed).random(size)
    lengths = 1 / np.sqrt(1 + np.argsort(np.argsort(losses)))
    line = [Individual(row, Fitness((length,))) for row, length in enumerate(lengths)]
    rng = np.random.default_rng(seed)
    random.seed(int(rng.integers(2**63)))
    drawn = [individual.row for individual in tools.selStochasticUniversalSampling(line, count)]
    assert (select(losses, count, np.random.default_rng(seed)) == rng.permutation(drawn)).all()


def test_mutation_shrinks_to_nothing_over_the_budget():
    linear, printed = RGA(generations=100), RGA(generations=100, shrink_form="recursion")
    assert [linear.next_sigma(np.nan, i) for i in (50, 100)] == pytest.approx([0.1, 0])
    assert RGA(generations=100, shrink=0.5).next_sigma(np.nan, 100) == pytest.approx(0.1)
    sigma = printed.mutation
    for i in range(1, 11):
        sigma = printed.next_sigma(sigma, i)
    assert sigma == pytest.approx(0.2 * np.prod(1 - np.arange(1, 11) / 100))


def test_crossover_stays_between_its_parents_and_mutation_does_not():
    rng = np.random.default_rng(3)
    points, losses = np.sort(0.4 + 0.1 * rng.random((22, 3)), axis=0), np.arange(22.0)
    crossed = RGA(population=44, crossover=1).breed(points, losses, 0.2, rng)
    assert crossed.shape == (20, 3)
    assert (crossed >= points.min(axis=0)).all() and (crossed <= points.max(axis=0)).all()
    mutants = RGA(population=44, crossover=0).breed(points, losses, 0.2, rng)
    assert ((mutants < points.min(axis=0)) | (mutants > points.max(axis=0))).any()


def test_elites_live_on_and_take_their_subpopulation_over():
    """Children that are copies: the best of the first generation is never lost, and 2 of 10 are not asked for again."""
    search = RGA(population=20, generations=60, interval=1000, crossover=0, mutation=0).search(
        2, np.random.default_rng(5)
    )
    height = lambda points: np.sum((points - 0.3) ** 2, axis=1)  # noqa: E731
    first = next(search)
    born = search.send(height(first))
    for _ in range(60):
        assert born.shape == (16, 2)
        born = search.send(height(born))
    for deme, copies in zip(np.split(first, 2), np.split(born, 2), strict=True):
        assert (copies == deme[np.argmin(height(deme))]).all(axis=1).all()


def test_the_best_of_an_island_take_the_place_of_the_worst_of_the_next():
    losses = np.array([0.1, 0.2, 0.8, 0.9, 1.1, 1.2, 1.8, 1.9, 2.1, 2.2, 2.8, 2.9])
    order = migrate(losses, [np.arange(4), np.arange(4, 8), np.arange(8, 12)], 0.25)
    moved = [list(losses[order[rows]]) for rows in np.split(np.arange(12), 3)]
    assert sorted(moved[0]) == [0.1, 0.2, 0.8, 2.1]
    assert sorted(moved[1]) == [0.1, 1.1, 1.2, 1.8]
    assert sorted(moved[2]) == [1.1, 2.1, 2.2, 2.8]
