"""What the papers say of CMA-ES."""

import numpy as np

from pzt_ident.optimizers.cma_es import CMAES, finite_losses
from pzt_ident.search.loop import Stop, optimize


def walk(function, evaluations=240):
    tried = []

    def watched(points):
        tried.append(points.copy())
        return function(points)

    optimize(CMAES(budget=evaluations), 4, watched, 3, Stop(evaluations))
    return np.vstack(tried)


def test_only_the_order_of_the_losses_counts():
    bowl = lambda x: np.sum((x - 0.3) ** 2, axis=1)  # noqa: E731
    np.testing.assert_array_equal(walk(bowl), walk(lambda x: np.exp(3 * bowl(x)) - 7))


def test_the_population_doubles_from_start_to_start_with_small_ones_between():
    """On a flat loss every start ends soon."""
    search = CMAES().search(3, np.random.default_rng(1))
    points, sizes = next(search), []
    while sum(sizes) < 4000:
        sizes.append(len(points))
        points = search.send(np.zeros(len(points)))
    search.close()
    new = [size for i, size in enumerate(sizes) if size > max(sizes[:i], default=0)]
    assert new[:4] == [7, 14, 28, 56]
    assert any(size < largest for size, largest in zip(sizes, np.maximum.accumulate(sizes), strict=True))


def test_failures_rank_behind_the_worst_success():
    losses = finite_losses(np.array([3.0, np.inf, -1.0, np.nan]))
    assert losses[[0, 2]].tolist() == [3, -1]
    assert (losses[[1, 3]] > 3).all() and np.isfinite(losses).all()
    assert np.isfinite(finite_losses(np.full(4, np.inf))).all()
