"""Series in place of erf, and the way of an input through a tile."""

import numpy as np
import pytest
from scipy.special import erf

from pzt_ident.engine import series
from pzt_ident.engine.kernel import SERIES, WIDTH

PLACES = np.linspace(-1, 1, 301)


@pytest.mark.parametrize(("count", "half"), SERIES.items())
def test_series_are_erf_to_rounding(count, half):
    """On each range of so much to either side; twice as far one of them is not."""

    def error(half):
        values = [erf(middle + half * series.nodes_of(count)) for middle in np.linspace(-3, 3, 61)]
        exact = [erf(middle + half * PLACES) for middle in np.linspace(-3, 3, 61)]
        shares, powers = series.shares_of(count), series.powers_of(count)
        found = [np.polynomial.polynomial.polyval(PLACES, powers @ (shares @ each)) for each in values]
        return np.abs(np.subtract(found, exact)).max()

    assert error(half) < 1.5e-14 < error(2 * half)


def test_powers_are_those_of_chebyshev():
    np.testing.assert_array_equal(series.powers_of(4), [[1, 0, -1, 0], [0, 1, 0, -3], [0, 0, 2, 0], [0, 0, 0, 4]])


@pytest.mark.parametrize("count", SERIES)
def test_a_fit_is_the_polynomial_through_the_values(count):
    """In every lane, from where the numbers of this count begin."""
    counts = list(SERIES)[: list(SERIES).index(count)]
    values = np.random.default_rng(0).normal(size=(count, WIDTH))
    scratch = np.zeros(series.POWERS + count * WIDTH)
    scratch[series.VALUES : series.VALUES + values.size] = values.ravel()
    series.fit(scratch, 0, count, sum(each**2 for each in counts), WIDTH)
    powers = scratch[series.POWERS :].reshape(count, WIDTH)
    np.testing.assert_allclose(np.vander(series.nodes_of(count), increasing=True) @ powers, values, atol=1e-9)
    series.range_over(scratch, 0, 3, 2.0, 6.0)
    series.place(scratch, 0, count, sum(counts), WIDTH)
    at = scratch[series.ARGUMENTS : series.ARGUMENTS + values.size].reshape(count, WIDTH)[:, 3]
    np.testing.assert_allclose(at, 4 + 2 * series.nodes_of(count))


def test_a_way_is_how_far_the_input_has_come():
    """Each lane goes where it is farthest from its first input, whatever it was ahead of the tile."""
    tile = np.cumsum(np.random.default_rng(0).normal(size=(64, WIDTH)), axis=0)
    way = np.zeros(7 * WIDTH)
    ahead = way[series.LAST : series.LAST + WIDTH] = tile[0] + np.linspace(-20, 20, WIDTH)
    series.bound(way, 0, tile.ravel(), 64, 0)
    rows = dict(zip(("low", "high", "last"), way.reshape(7, WIDTH), strict=False))
    np.testing.assert_array_equal(rows["low"], np.minimum(ahead, tile.min(axis=0)))
    np.testing.assert_array_equal(rows["high"], np.maximum(ahead, tile.max(axis=0)))
    np.testing.assert_array_equal(rows["last"], tile[-1])
    series.bound(way, 0, tile.ravel(), 64, 1)
    series.follow(way, 0, tile.ravel(), 64)
    for lane in range(WIDTH):
        first, far, reached, back = (way[row + lane] for row in (series.FIRST, series.FAR, series.REACHED, series.BACK))
        moved = tile[:, lane] - first
        sign = 1 if moved.max() >= -moved.min() else -1
        so_far = np.maximum.accumulate(sign * moved)
        assert sign * (far - first) == pytest.approx(so_far[-1]) and reached == far
        assert back == pytest.approx((so_far - sign * moved).max())
