"""What the papers say of the swarm."""

import numpy as np
import pytest

from pzt_ident.errors import InputError
from pzt_ident.optimizers.pso import PSO
from pzt_ident.optimizers.pso_vmax import VmaxPSO
from pzt_ident.search.loop import Stop, optimize


def flight(optimizer, function, generations=40, dimensions=3, seed=4):
    """Positions (generations, particles, dimensions) and their losses."""
    places, heights = [], []

    def watched(points):
        places.append(points.copy())
        heights.append(function(points))
        return heights[-1]

    optimize(optimizer, dimensions, watched, seed, Stop(optimizer.population * generations))
    return np.array(places), np.array(heights)


def leaders(places, heights):
    """Moves before and after a particle became the best of the swarm, far from the walls: there both pulls are nil."""
    for now in range(1, len(places) - 1):
        particle = np.argmin(heights[now])
        before = places[now, particle] - places[now - 1, particle]
        after = places[now + 1, particle] - places[now, particle]
        inside = (places[now - 1 : now + 2, particle] > 0.05).all() and (
            places[now - 1 : now + 2, particle] < 0.95
        ).all()
        if heights[now, particle] < heights[:now].min() and inside:
            yield before, after


def test_constriction_of_clerc_and_kennedy():
    """Phi 4.1 gives 0.7298; the product with c1 = c2 = 2.05 is the 1.49618 of the standard swarm."""
    assert PSO(c1=2.05, c2=2.05).constriction == pytest.approx(0.729843788, abs=1e-9)
    assert PSO(c1=2.05, c2=2.05).constriction * 2.05 == pytest.approx(1.49618, abs=1e-5)
    assert PSO().constriction == pytest.approx(0.729843788, abs=1e-9)  # Lin & Lin: 2.8 + 1.3
    with pytest.raises(InputError, match="constriction needs c1 \\+ c2 above 4"):
        PSO(c1=2, c2=2)


@pytest.mark.parametrize(("optimizer", "weight"), [(PSO(population=10), 0.729843788), (VmaxPSO(population=10), 1.0)])
def test_the_leader_is_moved_by_its_inertia_alone(optimizer, weight):
    found = list(leaders(*flight(optimizer, lambda x: np.sum((x - 0.4) ** 2, axis=1))))
    assert len(found) > 3
    for before, after in found:
        np.testing.assert_allclose(
            after, np.clip(weight * before, -0.2, 0.2) if weight == 1 else weight * before, atol=1e-9
        )


def test_no_move_is_longer_than_vmax():
    places, _ = flight(VmaxPSO(population=10, vmax=0.03), lambda x: np.sin(40 * x).sum(axis=1))
    assert np.abs(np.diff(places, axis=0)).max() <= 0.03 + 1e-12
