"""What the papers say of clonal selection."""

import numpy as np
import pytest

from pzt_ident.optimizers.csa import CSA, hypermutation, mature


def test_sixteen_bits_are_a_grid_over_the_cube():
    optimizer = CSA()
    assert optimizer.bits == 16
    values = optimizer.decode(np.random.default_rng(0).random((500, 3, 16)) < 0.5) * (2**16 - 1)
    np.testing.assert_allclose(values, np.rint(values), atol=1e-9)
    assert optimizer.decode(np.zeros((1, 1, 16), dtype=bool)) == 0
    assert optimizer.decode(np.eye(1, 16, 0, dtype=bool)[None]) == 1


def test_the_next_value_is_one_flip_away():
    optimizer = CSA(bits=6)
    codes = np.array([[[bool(n >> bit & 1) for bit in range(5, -1, -1)]] for n in range(64)])
    ordered = codes[np.argsort(optimizer.decode(codes).ravel())]
    assert (np.sum(ordered[1:] != ordered[:-1], axis=(1, 2)) == 1).all()


def test_the_fitter_the_more_clones_and_the_fewer_flips():
    optimizer = CSA(population=70)
    counts, rates = optimizer.clones_of(), optimizer.rates()
    np.testing.assert_array_equal(counts, np.rint(35 / np.arange(1, 22)))  # sum of beta N / rank
    assert rates[-1] == pytest.approx(0.05)
    assert rates[0] == pytest.approx(0.05 * np.exp(-2))
    assert (np.diff(rates) > 0).all()


def test_bits_flip_as_often_as_their_rate_and_one_at_least():
    flips = hypermutation(np.repeat([0.05, 0.001], 4000), (7, 16), np.random.default_rng(1)).sum(axis=(1, 2))
    assert flips.min() >= 1
    none = (1 - 0.05) ** 112  # the share in which one flip is put where there was none
    assert flips[:4000].mean() == pytest.approx(112 * 0.05 + none, abs=0.15)


def test_a_parent_gives_way_to_its_best_clone_only():
    antibodies, losses = np.zeros((2, 1, 4), dtype=bool), np.array([1.0, 2.0])
    clones = np.eye(4, dtype=bool)[:, None]
    mature(antibodies, losses, clones, np.array([3.0, 1.5, 0.9, 1.2]), np.array([0, 0, 1, 1]))
    assert losses.tolist() == [1.0, 0.9]
    assert not antibodies[0].any()
    np.testing.assert_array_equal(antibodies[1], clones[2])
