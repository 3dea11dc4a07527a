"""What the paper says of L-SHADE."""

import numpy as np
import pytest

from pzt_ident.optimizers.differential_evolution import DifferentialEvolution, crossed, draw_cross, draw_scale, lehmer


def test_the_population_falls_linearly_to_four():
    optimizer = DifferentialEvolution(population=100, generations=10)
    assert [optimizer.survivors(used) for used in (0, 500, 1000)] == [100, 52, 4]


def test_lehmer_mean_prefers_large_factors():
    assert lehmer(np.array([0.2, 0.8]), np.array([1.0, 1.0])) == pytest.approx((0.04 + 0.64) / 1.0)
    assert lehmer(np.full(3, 0.7), np.array([0.1, 3.0, 2.0])) == pytest.approx(0.7)


def test_drawn_settings_are_where_they_must_be():
    rng = np.random.default_rng(0)
    scale, cross = draw_scale(np.full(5000, 0.5), rng), draw_cross(np.full(5000, 0.5), rng)
    assert scale.min() > 0 and scale.max() == 1
    assert np.median(scale) == pytest.approx(0.5, abs=0.02)
    assert cross.mean() == pytest.approx(0.5, abs=0.01) and cross.std() == pytest.approx(0.1, abs=0.005)


def test_a_trial_has_one_coordinate_of_the_mutant_at_least():
    rng = np.random.default_rng(0)
    assert (crossed(np.zeros(200), 7, rng).sum(axis=1) == 1).all()
    assert crossed(np.ones(200), 7, rng).all()


def test_a_mutant_beyond_a_bound_is_halfway_to_it():
    """Two alike but for one coordinate: every difference points along it."""
    rng = np.random.default_rng(2)
    points = np.column_stack([np.linspace(0.01, 0.99, 20), np.full(20, 0.5)])
    mutants = DifferentialEvolution(population=20).mutant(points, points[:0], np.full(20, 1.0), rng)
    assert ((mutants >= 0) & (mutants <= 1)).all()
    np.testing.assert_array_equal(mutants[:, 1], 0.5)
