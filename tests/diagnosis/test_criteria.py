"""What an effect must remove, of which records, to be taken: by hand, the noise floor being 1."""

from types import SimpleNamespace

import numpy as np
import pytest

from made_fits import CASE, FAR, above, fit, without
from pzt_ident.diagnosis.criteria import (
    adequate,
    beyond_form,
    clears_an_axis,
    is_enough,
    not_in_validation,
    reaches_noise,
    removes_enough,
    threshold,
)
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.score import squared_misfit

SMALL = above(1.0, FAR)


def test_the_misfit_is_what_is_above_the_noise_and_never_less_than_could_be_told_from_it():
    assert squared_misfit(CASE, above(3.0)) == pytest.approx(9)
    assert squared_misfit(CASE, fit(1.0)) == squared_misfit(CASE, fit(0.5)) == pytest.approx(0.09)


@pytest.mark.parametrize(
    ("x", "y", "cleared"),
    [
        ((19.0, 19.0), (8.0, 8.0), False),
        ((20.0, 20.0), (2.0, 2.0), True),  # the axis that lacks more is no better
        ((20.0, 20.0), (2.0, 8.0), False),  # on the records that were fitted alone
        ((2.0, 2.0), (8.0, 8.0), True),
        ((20.0, 20.0), (9.0, 9.0), False),
    ],
)
def test_an_axis_is_cleared_of_most_of_its_misfit_on_both_kinds_of_record(x, y, cleared):
    case = SimpleNamespace(floor=1.0, floors=np.ones(2))
    before, after = by_axes((20.0, 20.0), (9.0, 9.0)), by_axes(x, y)
    assert clears_an_axis(case, before, before, after) == cleared


@pytest.mark.parametrize(("given", "cleared"), [(10.0, True), (40.0, False)])
def test_an_axis_at_the_noise_is_cleared_of_nothing(given, cleared):
    """Nor of what the form of an effect that explains far more may leave."""
    case, first = SimpleNamespace(floor=1.0, floors=np.ones(2)), by_axes((20.0, 20.0), (given, given))
    assert not clears_an_axis(case, first, by_axes((20.0, 20.0), (1.1, 1.1)), by_axes((20.0, 20.0), (1.0, 1.0)))
    assert clears_an_axis(case, first, by_axes((20.0, 20.0), (1.5, 1.5)), by_axes((20.0, 20.0), (1.0, 1.0))) == cleared


def by_axes(x, y):
    """A fit with these errors of two axes, of the identification and of the validation records."""
    errors = {"identify": np.array([x[0], y[0]]), "validate": np.array([x[1], y[1]])}
    problem = SimpleNamespace(sizes=np.ones(2), by_axis=lambda points, use: errors[use][None])
    return Fit((), problem, np.zeros(1), *(float(np.sqrt(np.mean(own**2))) for own in errors.values()))


@pytest.mark.parametrize(("first", "enough"), [(1.0, 0.6), (19.0, 0.6), (21.0, 0.63), (100.0, 3.0)])
def test_enough_is_six_tenths_of_the_noise_or_three_percent_of_the_first_misfit(first, enough):
    assert threshold(CASE, above(first)) == pytest.approx(enough)


@pytest.mark.parametrize("first", [1.0, 40.0])
@pytest.mark.parametrize(("share", "earned"), [(1.02, True), (0.98, False), (-1.02, False)])
def test_an_effect_removes_enough_of_the_records_that_were_fitted(first, share, earned):
    before, gone = above(1.5, FAR), share * max(0.6, 0.03 * first)
    after = fit(without(before.identify, gone), 0.5 * FAR)
    assert removes_enough(CASE, above(first), before, after) == earned


@pytest.mark.parametrize(("left", "unseen", "earned"), [(0.2, 0.2, True), (0.7, 0.2, False), (0.2, 0.7, False)])
@pytest.mark.parametrize(("before", "much"), [(2.7, True), (0.85, False)])
def test_what_takes_all_of_a_rest_is_enough_however_far_the_first_model_was(left, unseen, earned, before, much):
    first, rest = above(200.0, 200.0), above(before, np.hypot(1, before))
    assert removes_enough(CASE, first, rest, above(left, np.hypot(1, unseen))) == (earned and much)
    assert is_enough(CASE, first, rest, 1 - (left / before) ** 2) == (left < 0.5 and much)


@pytest.mark.parametrize(
    ("shown", "unseen", "left", "proven"),
    [
        (0.5, 4.6, 0.6, True),
        (0.2, 4.6, 0.6, False),  # the fitted records hardly show it
        (0.5, 4.6, 1.5, False),  # the others confirm it, but for a tenth
        (0.5, 1.2, 0.0, False),  # not more than the form of what leads to 40 floors
        (0.5, None, None, False),
    ],
)
def test_what_predicts_nearly_all_of_unseen_records_is_proven_however_little_the_others_show(
    shown, unseen, left, proven
):
    """As a friction that holds steps, which loops hardly show."""
    first, before = above(40.0, 40.0), above(shown, unseen and np.hypot(1, unseen))
    after = fit(1.0, left if left is None else np.hypot(1, left))
    assert removes_enough(CASE, first, before, after) == proven
    assert beyond_form(CASE, first, before, after) == proven


@pytest.mark.parametrize(("share", "earned"), [(0.151, True), (0.149, False)])
def test_an_effect_removes_a_share_of_what_is_left_of_the_records_that_were_fitted(share, earned):
    before = above(FAR, FAR)
    after = fit(without(before.identify, FAR * np.sqrt(share)), 0.5 * FAR)
    assert removes_enough(CASE, before, before, after) == earned


@pytest.mark.parametrize("first", [1.0, 40.0])
@pytest.mark.parametrize(("share", "earned"), [(2.0, True), (0.51, True), (0.49, False), (0.0, False), (-0.51, False)])
def test_an_effect_removes_half_as_much_of_the_records_that_were_not_fitted(first, share, earned):
    before, gone = above(2.0, FAR), share * max(0.6, 0.03 * first)
    after = fit(1.0, without(FAR, gone))
    assert removes_enough(CASE, above(first), before, after) == earned


@pytest.mark.parametrize("first", [1.0, 40.0, 1e3, 1e6])
def test_nothing_is_adequate_that_leaves_many_noise_floors(first):
    assert not reaches_noise(CASE, above(first), above(2.01))
    assert not adequate(CASE, above(first), fit(1.0, np.hypot(1, 6.01)))


def test_where_all_records_were_fitted_they_alone_decide():
    assert removes_enough(CASE, SMALL, above(2.0), fit(1.0))
    assert not removes_enough(CASE, SMALL, above(2.0), above(2.0))


@pytest.mark.parametrize("wrong", ["before", "after", "fitted", None])
@pytest.mark.parametrize("first", [1.0, 40.0])
def test_records_that_show_nothing_are_at_the_noise_before_and_after(first, wrong):
    noise = np.hypot(1, max(0.6, 0.03 * first))
    before, after, fitted = (noise * (1.001 if wrong == word else 0.999) for word in ("before", "after", "fitted"))
    ahead, behind = above(2.0, before), fit(fitted, after)
    assert not_in_validation(CASE, above(first), ahead, behind) == (wrong is None)
    assert removes_enough(CASE, above(first), ahead, behind) == (wrong is None)


def test_records_that_are_not_there_are_not_at_the_noise():
    assert not not_in_validation(CASE, SMALL, above(2.0), fit(1.0))


@pytest.mark.parametrize("first", [1.0, 40.0])
@pytest.mark.parametrize(
    ("fitted", "unfitted", "fine"),
    [(0.99, 0.99, True), (0.99, None, True), (1.01, 0.0, False), (1.01, None, False), (0.99, 1.01, False)],
)
def test_an_adequate_model_leaves_little_above_the_noise_and_thrice_that_of_what_it_never_saw(
    first, fitted, unfitted, fine
):
    enough = max(0.6, 0.03 * first)
    model = above(fitted * enough, unfitted and np.hypot(1, unfitted * 3 * enough))
    assert adequate(CASE, above(first), model) == fine
    assert reaches_noise(CASE, above(first), model) == (fitted < 1)


@pytest.mark.parametrize(("after", "unseen"), [(1.0, True), (1.02, True), (1.05, False)])
def test_what_makes_the_records_kept_back_worse_is_not_merely_unseen_there(after, unseen):
    """As a resonance that follows a few wrong readings of the others."""
    first, before, now = fit(5.0, 5.0), fit(5.0, 1.0), fit(1.0, after)
    assert not_in_validation(CASE, first, before, now) == unseen
    assert removes_enough(CASE, first, before, now) == unseen


@pytest.mark.parametrize(
    ("unseen", "proven"),
    [
        ((1.9, 1.4), True),  # most of the rest, though less than the 1.5 floors of a form
        ((1.9, 1.6), False),
        ((4.0, 3.6), True),  # more than a form may leave, though less than most
        ((4.0, 3.8), False),
    ],
)
def test_beside_others_what_was_never_fitted_shows_an_effect_by_most_of_its_rest(unseen, proven):
    """The identification records: 2.2 and 1 above the noise, root mean square, of which a form may leave 1.5."""
    without, now = (above(*rest) for rest in zip((2.2, 1.0), unseen, strict=True))
    assert beyond_form(CASE, above(26.0, 23.0), without, now) == proven
