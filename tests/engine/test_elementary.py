"""The kernel's own elementary functions against NumPy, over all that they take."""

import math

import numpy as np
import pytest
from numba import njit

from pzt_ident.engine import elementary
from pzt_ident.model import block


def over(function):
    """The compiled function over an array."""

    @njit(fastmath={"contract"}, error_model="numpy")
    def loop(x):
        found = np.empty_like(x)
        for i in range(x.size):
            found[i] = function(x[i])
        return found

    return loop


expm1, log1p, log, sin, cos, erf, rough_log, rough_inverse_cube_root = (
    over(function)
    for function in (
        elementary.expm1,
        elementary.log1p,
        elementary.log,
        elementary.sin,
        elementary.cos,
        elementary.erf,
        elementary.rough_log,
        elementary.rough_inverse_cube_root,
    )
)


def waves(x):
    return np.array([sin(x), cos(x)])


def both_signs(*exponents):
    """Numbers of every magnitude between powers of ten."""
    sizes = 10.0 ** np.random.default_rng(0).uniform(*exponents, 20000)
    return np.concatenate([sizes, -sizes])


def test_expm1_over_the_whole_range():
    x = both_signs(-300, math.log10(700))
    np.testing.assert_allclose(expm1(x), np.expm1(x), rtol=5e-15)
    x = np.random.default_rng(1).uniform(-40, 40, 40000)
    np.testing.assert_allclose(expm1(x), np.expm1(x), rtol=5e-15)


def test_expm1_where_its_argument_is_split():
    """At halves of ln 2 the power of two changes."""
    x = math.log(2) * np.arange(-1000, 1000) / 2
    x = np.concatenate([x, np.nextafter(x, 1e9), np.nextafter(x, -1e9)])
    np.testing.assert_allclose(expm1(x), np.expm1(x), rtol=5e-15)


def test_expm1_ends_in_a_number_no_step_survives():
    assert expm1(np.array([0.0, -1e4, -np.inf])).tolist() == [0, -1, -1]
    assert np.all(expm1(np.array([800.0, np.inf])) > 1e300)


def test_log1p_over_the_whole_range():
    x = both_signs(-300, 300)
    x = x[x > -1]
    np.testing.assert_allclose(log1p(x), np.log1p(x), rtol=1e-15)
    x = np.random.default_rng(1).uniform(-1, 3, 40000)
    np.testing.assert_allclose(log1p(x), np.log1p(x), rtol=1e-15)


def test_log1p_where_its_argument_is_split():
    """At sqrt(2) times a power of two the exponent changes; close to -1 all digits are in what was rounded."""
    x = np.concatenate([math.sqrt(2) * 2.0 ** np.arange(-20, 60) - 1, 2.0 ** -np.arange(1, 54) - 1])
    x = np.concatenate([x, np.nextafter(x, 1e9)])
    np.testing.assert_allclose(log1p(x), np.log1p(x), rtol=1e-15)


def test_log_over_the_whole_range():
    x = np.concatenate([np.abs(both_signs(-300, 300)), np.random.default_rng(1).uniform(0, 3, 40000)])
    np.testing.assert_allclose(log(x), np.log(x), rtol=1e-15, atol=1e-16)
    assert log(np.ones(1)) == 0


def test_inverse_of_each_other():
    x = np.random.default_rng(2).uniform(-0.99, 20, 5000)
    np.testing.assert_allclose(expm1(log1p(x)), x, rtol=1e-13)


def test_waves_over_many_turns():
    x = np.concatenate([both_signs(-300, 4), np.random.default_rng(1).uniform(-7, 7, 40000)])
    np.testing.assert_allclose(waves(x), [np.sin(x), np.cos(x)], rtol=0, atol=1e-15)
    small = both_signs(-300, -1)
    np.testing.assert_allclose(waves(small)[0], np.sin(small), rtol=1e-15)


def test_waves_where_their_argument_is_split():
    """At odd multiples of pi / 2 the half wave changes; the digits of a zero are those of the argument."""
    x = math.pi * np.arange(-6000, 6000) / 2
    x = np.concatenate([x, np.nextafter(x, 1e9), np.nextafter(x, -1e9)])
    np.testing.assert_allclose(waves(x), [np.sin(x), np.cos(x)], rtol=0, atol=1e-15)


def test_waves_begin_at_rest_and_end_in_no_number():
    assert waves(np.zeros(1)).ravel().tolist() == [0, 1]
    assert np.isnan(waves(np.array([np.nan, np.inf]))).all()


def test_erf_over_the_whole_range():
    x = np.concatenate([both_signs(-300, 300), np.linspace(-6, 6, 40001)])
    np.testing.assert_allclose(erf(x), [math.erf(each) for each in x], rtol=0, atol=1e-14)
    small = both_signs(-300, -1)
    np.testing.assert_allclose(erf(small), [math.erf(each) for each in small], rtol=1e-11)
    assert np.isnan(erf(np.array([np.nan])))[0]


def test_rough_ones_are_near_enough_for_an_iteration_to_start():
    x = 10.0 ** np.random.default_rng(3).uniform(-300, 300, 20000)
    np.testing.assert_allclose(rough_log(x), np.log(x), rtol=0, atol=0.03)
    np.testing.assert_allclose(rough_inverse_cube_root(x), np.cbrt(1 / x), rtol=0.04)


def test_authors_have_them_in_plain_python():
    assert block.expm1(1e-20) == block.log1p(1e-20) == block.sin(1e-20) == 1e-20
    assert block.cos(0.0) == 1
    assert math.isnan(block.sin(math.inf)) and math.isnan(block.cos(math.inf))
    assert block.erf(0.5) == math.erf(0.5)
    assert block.rough_log(2.0) == math.log(2)
    assert block.rough_inverse_cube_root(8.0) == pytest.approx(0.5)
    assert block.log(math.e) == 1 and math.isnan(block.log(0.0))
    assert math.isnan(block.log1p(-1.0)) and math.isnan(block.log1p(-5.0))
