"""The share of the misfit that a step explains, by hand."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pzt_ident.diagnosis.misfit import share_explained, squared_misfit

SIZES = st.floats(1e-9, 1e3)


@pytest.mark.parametrize(
    ("before", "after", "share"), [(5.0, 1.0, 1.0), (5.0, 5.0, 0.0), (13**0.5, 5**0.5, 8 / 12), (5.0, 7.0, -1.0)]
)
def test_it_is_what_is_gone_of_what_is_above_the_noise(before, after, share):
    assert share_explained(before, after, 1.0) == pytest.approx(share)


@given(SIZES, SIZES, st.floats(0, 1e3))
def test_it_is_never_more_than_all_and_has_the_sign_of_the_change(before, after, floor):
    share = share_explained(before, after, floor)
    assert share <= 1
    assert share * (before - after) >= 0


def test_below_the_noise_it_is_a_share_of_the_least_that_can_be_told_from_it():
    assert squared_misfit(0.5, 1.0) == pytest.approx(0.09)
    assert share_explained(0.5, 0.4, 1.0) == pytest.approx(1.0)
    assert share_explained(0.5, 0.49, 1.0) == pytest.approx(0.0099 / 0.09)


def test_without_error_and_noise_nothing_is_explained():
    assert share_explained(0.0, 0.0, 0.0) == 0
