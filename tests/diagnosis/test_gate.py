"""What an effect must remove, of which records, and which of several is taken: by hand, the noise floor being 1."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from pzt_ident.diagnosis import candidates, forms, verdict
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.criteria import (
    adequate,
    clears_an_axis,
    is_enough,
    not_in_validation,
    reaches_noise,
    removes_enough,
    threshold,
)
from pzt_ident.diagnosis.exchange import in_its_limit
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.forms import Candidate, choose_forms
from pzt_ident.diagnosis.score import Score, squared_misfit
from pzt_ident.diagnosis.ties import generalises, is_tied, is_twin
from pzt_ident.diagnosis.verdict import best_pair, diagnose, pair_behind
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks, word_of

CASE = SimpleNamespace(floor=1.0, floors=np.ones(1), on_event=lambda event: None, budget=Budget())
FAR = 10.0  # an error that nobody takes for noise


def fit(identify, validate=None, effects=(), dimensions=4, own=(), limit=""):
    """own: places in their ranges of the shapes that its last effect brought along. limit: what it is on their lower
    bounds."""
    columns, block = range(len(own)), SimpleNamespace(name=word_of(effects[-1]) if effects else "")
    entries = [
        SimpleNamespace(parameter=Parameter("1", (0, 1), "", limit=limit), block=block, word=str(i)) for i in columns
    ]
    problem = SimpleNamespace(
        dimensions=dimensions,
        names=[f"own_{i}" for i in columns],
        free=columns,
        model=SimpleNamespace(entries=entries, measured=(), amounts=(), additions=()),
        physical=np.atleast_2d,
        sizes=np.ones(1),
        loss=lambda points: np.array([2 * identify]),
        by_axis=lambda points, use: np.array([[{"identify": identify, "validate": validate}[use]]]),
    )
    return Fit(tuple(effects), problem, np.array(own, float), identify, validate)


def above(left, validate=None):
    """A fit that leaves so much above the noise, root mean square."""
    return fit(np.hypot(1, left), validate)


def without(before, gone):
    """An error of which so much is gone, root mean square; below zero is more."""
    return float(np.sqrt(before**2 - np.sign(gone) * gone**2))


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


def test_the_total_is_root_mean_square_over_both_uses():
    assert fit(1.0, 7.0).total == fit(7.0, 1.0).total == pytest.approx(5)
    assert fit(3.0).total == 3


@pytest.fixture
def judged(monkeypatch):
    """What is said of a model that leaves 30 of both uses, given the fits with each of some effects."""

    def of(fits):
        scores = [Candidate.of([Score(word, explained=0.9, power=3.0)]) for word in fits]
        scorer = SimpleNamespace(scores=lambda word: next(item.forms for item in scores if item.score.effect == word))
        monkeypatch.setattr(verdict, "scorer_of", lambda case, before: scorer)
        monkeypatch.setattr(forms, "scorer_of", lambda case, before: scorer)
        monkeypatch.setattr(verdict, "score_all", lambda case, first, before, scorer: scores)
        monkeypatch.setattr(verdict, "refusal", lambda case, first, before: "")
        monkeypatch.setattr(verdict, "restart_look_alikes", lambda case, first, before, candidates: None)
        monkeypatch.setattr(verdict, "restart_unconfirmed", lambda case, first, candidates: None)
        monkeypatch.setattr(
            verdict, "refit_all", lambda case, first, before, candidates: [given(candidate) for candidate in candidates]
        )

        def given(candidate):
            candidate.refits = {candidate.score.effect: fits[candidate.score.effect]}
            return candidate

        return diagnose(CASE, fit(30.0, 30.0))

    return of


def test_the_effect_that_is_best_on_both_uses_is_taken_not_the_one_that_fits_best(judged):
    """Totals 5 and 4.5; of the records that were fitted alone the first would be best."""
    diagnosis = judged({"creep": fit(1.0, 7.0, ["creep"]), "saturation": fit(4.5, 4.5, ["saturation"])})
    assert [item.score.effect for item in diagnosis.candidates] == ["saturation", "creep"]
    assert (diagnosis.verdict, diagnosis.tied) == ("missing", ["saturation"])
    assert [item.score.effect for item in diagnosis.passing] == ["saturation", "creep"]


def test_an_effect_that_the_other_records_do_not_show_is_not_taken_however_well_it_fits(judged):
    diagnosis = judged({"creep": fit(1.0, 30.0, ["creep"]), "saturation": fit(20.0, 20.0, ["saturation"])})
    assert (diagnosis.verdict, diagnosis.tied) == ("missing", ["saturation"])
    assert [item.score.effect for item in diagnosis.passing] == ["saturation"]


@pytest.mark.parametrize(("apart", "verdict", "tied"), [(0.19, "inconclusive", 2), (0.21, "missing", 1)])
def test_fits_less_than_a_fifth_of_the_noise_apart_are_a_tie_and_the_simpler_one_leads(judged, apart, verdict, tied):
    """Apart in root mean square, of both uses; no look-alikes."""
    best = fit(2.0, 2.0, ["creep"], dimensions=7)
    next_best = fit(np.hypot(2.0, apart), np.hypot(2.0, apart), ["saturation"], dimensions=5)
    diagnosis = judged({"creep": best, "saturation": next_best})
    assert (diagnosis.verdict, len(diagnosis.tied)) == (verdict, tied)
    assert diagnosis.tied[0] == ("saturation" if tied == 2 else "creep")


@pytest.mark.parametrize(("total", "apart", "close"), [(2.0, 0.39, True), (2.0, 0.41, False)])
def test_look_alikes_are_a_tie_where_they_are_twice_as_far_apart(total, apart, close):
    best, rival = (
        fit(total, total, ["amplifier_lag"]),
        fit(np.hypot(total, apart), np.hypot(total, apart), ["sensor_lag"]),
    )
    assert is_tied(CASE, "amplifier_lag", best, rival) == close
    stranger = fit(rival.identify, rival.validate, ["saturation"])
    assert not is_tied(CASE, "amplifier_lag", best, stranger)


@pytest.mark.parametrize(("share", "close"), [(1.009, True), (1.011, False)])
def test_far_above_the_noise_look_alikes_are_a_tie_to_one_percent(share, close):
    best, rival = fit(50.0, 50.0, ["amplifier_lag"]), fit(50.0 * share, 50.0 * share, ["sensor_lag"])
    assert is_tied(CASE, "amplifier_lag", best, rival) == close


@pytest.mark.parametrize(
    ("apart", "word", "twin"),
    [(9e-4, "kinematic_coupling", True), (1.1e-3, "kinematic_coupling", False), (0.0, "creep", False)],
)
def test_what_fits_as_another_form_of_an_effect_does_is_not_told_from_it(apart, word, twin):
    """A coupling by the other axis' voltage fits better than by its force, which is that of its displacement."""
    force, rival = fit(3.0, 3.0, ["cross_coupling"]), fit(3.0 + apart, 3.0 + apart, [word])
    assert is_twin(CASE, "cross_coupling.voltage", [force], rival) == twin


def test_such_a_twin_is_in_the_class_of_the_effect_and_never_leads_it():
    candidate, twin = (
        Candidate(Score(words[0]), forms=list(map(Score, words)))
        for words in (["cross_coupling", "cross_coupling.voltage"], ["kinematic_coupling"])
    )
    candidate.refits = {
        "cross_coupling": fit(3.0, 3.0, ["cross_coupling"]),
        "cross_coupling.voltage": fit(1.0, 1.0, ["cross_coupling.voltage"], 9),
    }
    candidate.take("cross_coupling.voltage")
    twin.refits = {"kinematic_coupling": fit(3.0, 3.0, ["kinematic_coupling"])}
    twin.take("kinematic_coupling")
    first = fit(20.0, 20.0)
    diagnosis = verdict.with_effects(CASE, first, first, [candidate, twin], [candidate, twin])
    assert (diagnosis.verdict, diagnosis.tied) == ("inconclusive", ["cross_coupling.voltage", "kinematic_coupling"])


@pytest.mark.parametrize(
    ("place", "worse", "taken"), [(1.0, 1.09, "delay"), (1.0, 1.11, "friction"), (0.5, 1.09, "friction")]
)
def test_an_effect_on_its_own_bound_gives_way_to_what_it_is_like_there(judged, place, worse, taken):
    """Friction that is smoothed over all speeds is a lag, with more parameters."""
    best, rival = fit(4.0, 4.0, ["friction"], own=[place]), fit(4.0 * worse, 4.0 * worse, ["delay"], own=[0.5])
    diagnosis = judged({"friction": best, "delay": rival, "creep": fit(4.2, 4.2, ["creep"])})
    assert diagnosis.tied[0] == taken


@pytest.mark.parametrize(
    ("left", "form", "taken"),
    [
        (3.2, "friction.coulomb", "sensor_lag"),
        (4.0, "friction.coulomb", "friction.coulomb"),
        (3.2, "friction", "friction"),
    ],
)
def test_an_effect_gives_way_to_one_that_it_contains_and_beside_which_it_adds_little(left, form, taken):
    """Friction with a viscous part contains a lag; its first form does not."""
    fits = {form: fit(3.0, 3.0, [form], 7), "sensor_lag": fit(left, left, ["sensor_lag"], 4)}
    best, rival = (Candidate(Score(word), made) for word, made in fits.items())
    assert verdict.needed(CASE, fit(30.0, 30.0), best, [best, rival]).score.effect == taken


@pytest.mark.parametrize(("worse", "taken"), [(1.009, "delay"), (1.011, "distributed_memory")])
def test_far_above_the_noise_what_has_fewer_parameters_is_taken_if_it_fits_as_well_to_one_percent(judged, worse, taken):
    memory, delay = fit(20.0, 20.0, ["distributed_memory"], 14), fit(20.0 * worse, 20.0 * worse, ["delay"], 5)
    diagnosis = judged({"distributed_memory": memory, "delay": delay})
    assert (diagnosis.verdict, diagnosis.tied) == ("missing", [taken])


@pytest.mark.parametrize(("place", "worse", "in_limit"), [(1.0, 1.09, True), (1.0, 1.11, False), (0.5, 1.09, False)])
def test_nothing_is_exchanged_for_an_effect_on_its_own_bound_that_is_hardly_better(place, worse, in_limit):
    """A cyclic error whose pitch is the stroke is a bend."""
    bend, encoder = (
        fit(4.0 * worse, 4.0 * worse, ["quadratic_gain"]),
        fit(4.0, 4.0, ["encoder_cyclic_error"], own=[place]),
    )
    assert in_its_limit(bend, encoder) == in_limit


@pytest.mark.parametrize(
    ("place", "left", "taken"), [(0.0, 21.0, "delay"), (0.0, 22.0, "friction"), (0.5, 21.0, "friction")]
)
def test_what_is_in_a_declared_limit_gives_way_to_any_that_removes_half_as_much(judged, place, left, taken):
    """As the second mode that is the main one, in the place of a delay."""
    best = fit(6.0, 6.0, ["friction"], own=[place], limit="a play")
    diagnosis = judged({"friction": best, "delay": fit(left, left, ["delay"])})
    assert diagnosis.tied == [taken]


def test_nothing_is_exchanged_for_an_effect_in_a_declared_limit():
    bend, friction = fit(6.0, 6.0, ["quadratic_gain"]), fit(2.0, 2.0, ["friction"], own=[0.0], limit="a play")
    assert in_its_limit(bend, friction)


@pytest.mark.parametrize(("dimensions", "taken"), [(5, "delay"), (4, "amplifier_lag"), (3, "amplifier_lag")])
def test_of_look_alikes_that_are_tied_the_simpler_one_is_taken(judged, dimensions, taken):
    rival = fit(np.hypot(2.0, 0.3), np.hypot(2.0, 0.3), ["delay"])
    diagnosis = judged({"amplifier_lag": fit(2.0, 2.0, ["amplifier_lag"], dimensions), "delay": rival})
    assert (diagnosis.verdict, diagnosis.tied[0]) == ("inconclusive", taken)


@pytest.mark.parametrize(("one", "other"), [("cross_coupling", "kinematic_coupling"), ("amplifier_lag", "sensor_lag")])
@pytest.mark.parametrize(("apart", "nearest"), [(0.0, True), (0.01, False), (-0.01, True)])
def test_of_two_names_of_one_model_that_which_acts_nearest_to_the_reading_is_taken(judged, one, other, apart, nearest):
    diagnosis = judged({one: fit(2.0, 2.0, [one]), other: fit(2.0 + apart, 2.0 + apart, [other])})
    assert diagnosis.tied[0] == (other if nearest else one)


@pytest.mark.parametrize("word", blocks.effects())
def test_every_effect_may_be_one_of_two_names(judged, word):
    diagnosis = judged({"creep": fit(2.0, 2.0, ["creep"]), word: fit(2.0, 2.0, [word])})
    assert diagnosis.tied[0] in ("creep", word)


@pytest.mark.parametrize("confirmed", [False, True])
def test_what_other_records_do_not_confirm_is_started_anew_where_nothing_is_adequate(monkeypatch, confirmed):
    """A mode that only the others make ring may rest anywhere."""
    monkeypatch.setattr(candidates, "restart", lambda case, fit: replace(fit, validate=1.2))
    case = SimpleNamespace(floor=1.0, budget=Budget())
    fits = {"quadratic_gain": fit(1.04, 14.4), "saturation": fit(2.5, 14.2)}
    if confirmed:
        fits["creep"] = fit(1.0, 1.0)
    shortlist = [Candidate(Score(word), refits={word: made}) for word, made in fits.items()]
    candidates.restart_unconfirmed(case, fit(20.0, 20.0), shortlist)
    validated = [item.refits[item.score.effect].validate for item in shortlist]
    assert validated == ([14.4, 14.2, 1.0] if confirmed else [1.2, 14.2])


def test_of_pairs_that_earn_the_best_on_both_uses_is_taken(monkeypatch):
    """Of creep and drift the fit is best where it was fitted, but the other records do not show it."""
    fits = {
        ("creep", "drift"): fit(1.0, 30.0),
        ("creep", "delay"): fit(2.0, 9.0),
        ("drift", "delay"): fit(5.0, 5.0),
    }
    monkeypatch.setattr(verdict, "refit", lambda case, before, effects, guess, rival: fits[effects])
    items = [Candidate(Score(word, explained=0.5)) for word in ("creep", "drift", "delay")]
    before = fit(30.0, 30.0)
    assert best_pair(CASE, before, before, items) is fits["drift", "delay"]
    assert best_pair(CASE, before, before, items[:2]) is None


@pytest.mark.parametrize(
    ("alone", "promised", "together", "found"),
    [(15.0, 0.9, 1.0, True), (25.0, 0.9, 1.0, False), (15.0, 0.7, 1.0, False), (15.0, 0.9, 29.0, False)],
    ids=["both", "not most", "no promise", "not both"],
)
def test_a_second_effect_is_sought_behind_one_that_loses_the_validation_records(
    alone, promised, together, found, monkeypatch
):
    before, lost, both = fit(30.0, 15.0), fit(alone, 40.0, ("slew_limit",)), fit(together, 1.0, ("slew_limit", "creep"))
    beside = [Candidate(Score("drift", 0.1)), Candidate(Score("creep", promised, promised))]
    monkeypatch.setattr(verdict, "scorer_of", lambda *_: None)
    monkeypatch.setattr(verdict, "score_all", lambda case, first, leading, *_, **__: beside if leading is lost else [])
    monkeypatch.setattr(verdict, "refit", lambda case, leading, effects, guess: both)
    refits = {"slew_limit": lost, "slew_limit.lag": fit(29.0, 15.0)}
    items = [Candidate(Score("drift", 0.2), fit(28.0, 15.0)), Candidate(Score("slew_limit", 0.8), lost, refits=refits)]
    assert (pair_behind(CASE, before, before, items) is both) is found
    assert pair_behind(CASE, before, before, items[:1]) is None


@pytest.mark.parametrize(
    ("usual", "other", "more", "rival", "taken"),
    [
        (5.0, 3.0, 1, 4.0, "friction"),
        (5.0, 3.0, 0, 4.0, "friction.coulomb"),
        (5.0, 4.997, 0, 4.0, "friction"),
        (5.0, 2.5, 1, 4.0, "friction.coulomb"),
        (5.0, 1.1, 1, 4.0, "friction.coulomb"),
        (1.1, 1.0, 1, 4.0, "friction.coulomb"),
        (1.1, 1.09, 1, 4.0, "friction"),
        (5.0, 3.0, 1, 1.1, "friction.coulomb"),
    ],
    ids=[
        "not enough",
        "as simple",
        "as simple and as good",
        "decisive",
        "enough",
        "better",
        "as good",
        "beside enough",
    ],
)
def test_a_form_of_more_parameters_is_meant_only_where_one_effect_is_enough(usual, other, more, rival, taken):
    """RMSE in noise floors, of a model that is adequate up to 1.17; forms are as good to a fifth of the noise."""
    friction = Candidate.of([Score("friction", explained=0.5), Score("friction.coulomb", explained=0.9)])
    friction.refits = {"friction": fit(usual, usual), "friction.coulomb": fit(other, other, dimensions=4 + more)}
    creep = Candidate.of([Score("creep", explained=0.5)])
    creep.refits = {"creep": fit(rival, rival)}
    choose_forms(CASE, fit(10.0, 10.0), [friction, creep])
    assert friction.score.effect == taken
    assert friction.fit is friction.refits[taken]
    assert creep.fit is creep.refits["creep"]


def candidate_of(item, *others):
    """A candidate that means its last form, with the fits of all of them."""
    forms = {fit.effects[-1]: fit for fit in (item, *others)}
    candidate = Candidate.of([Score(word, explained=0.9) for word in forms])
    candidate.refits = forms
    candidate.take([*forms][-1])
    return candidate


@pytest.mark.parametrize(("usual", "kept"), [(1.05, True), (1.5, False)])
def test_a_form_of_more_parameters_gives_way_to_the_first_where_that_is_tied(usual, kept):
    best = candidate_of(fit(1.0, effects=["amplifier_lag"], dimensions=5))
    more = fit(1.0, effects=["sensor_lag.second_order"], dimensions=6)
    rival = candidate_of(fit(usual, effects=["sensor_lag"], dimensions=5), more)
    assert verdict.in_least_form(CASE, best, rival) == kept
    assert rival.score.effect == ("sensor_lag" if kept else "sensor_lag.second_order")


@pytest.mark.parametrize(("apart", "kept"), [(0.11, True), (0.09, False)])
def test_a_form_of_more_parameters_that_fits_better_is_in_the_class(apart, kept):
    best = candidate_of(fit(np.hypot(1.0, apart), effects=["delay"], dimensions=5))
    rival = candidate_of(
        fit(1.5, effects=["sensor_lag"], dimensions=5), fit(1.0, effects=["sensor_lag.second_order"], dimensions=6)
    )
    assert verdict.in_least_form(CASE, best, rival) == kept
    assert rival.score.effect == "sensor_lag.second_order"


def test_a_form_of_more_parameters_than_the_best_effect_may_contain_it():
    lag = fit(1.0, effects=["amplifier_lag"], dimensions=5)
    assert generalises(fit(1.0, effects=["slew_limit.lag"], dimensions=6), lag)
    assert not generalises(fit(1.0, effects=["slew_limit"], dimensions=6), lag)
    assert not generalises(fit(1.0, effects=["sensor_lag.second_order"], dimensions=5), lag)


@pytest.mark.parametrize("plain, led, kept", [(8.0, 4.0, 4.0), (8.0, 9.0, 8.0), (3.9, 1.0, 3.9)])
def test_a_form_far_behind_another_one_is_tried_from_where_that_led(monkeypatch, plain, led, kept):
    """And no worse than from its own guess."""
    refits = {"creep": fit(plain, plain, ["creep"]), "creep.voltage": fit(3.0, 3.0, ["creep.voltage"])}

    def refit(case, other, effects, guess, rival):
        assert other is refits["creep.voltage"] and effects == ("creep",)
        return fit(led, led, effects)

    monkeypatch.setattr(forms, "refit", refit)
    found = forms.from_each_other(CASE, refits)
    assert found["creep"].identify == kept and found["creep.voltage"] is refits["creep.voltage"]


@pytest.mark.parametrize(("rests", "left", "sought"), [(True, 4.0, True), (False, 4.0, False), (True, 1.0, False)])
def test_an_effect_that_drives_the_model_onto_bounds_is_fitted_from_random_points(monkeypatch, rests, left, sought):
    """In each of its forms, as long as it leaves more than the noise, and whatever it promised."""
    first, tried = fit(12.0, 12.0), []
    candidate = Candidate(Score("friction", 0.6), forms=[Score("friction", 0.6), Score("friction.commanded", 0.5)])
    candidate.refits = {"friction": fit(left, left, ["friction"])}

    def first_fit(case, seed, effects, rival):
        tried.append(effects[-1])
        assert rival == left
        return fit(1.0, 1.0, effects) if effects[-1] == "friction.commanded" else fit(5.0, 5.0, effects)

    monkeypatch.setattr(forms, "first_fit", first_fit)
    monkeypatch.setattr(forms, "refit_from", lambda case, before, effects, *_: fit(4.5, 4.5, effects))
    monkeypatch.setattr(forms, "rests_anew", lambda before, fit: rests)
    forms.refit_likely_forms(CASE, first, first, candidate)
    assert tried == (["friction", "friction.commanded"] if sought else [])
    assert candidate.best.identify == (1.0 if sought else left)


@pytest.mark.parametrize(
    ("before", "after", "anew"),
    [
        ([], ["bouc_wen.alpha"], True),
        (["bouc_wen.alpha"], ["bouc_wen.alpha"], False),
        (["bouc_wen.alpha"], ["bouc_wen.beta"], True),
        ([], ["friction.reach"], False),
    ],
)
def test_only_parameters_of_the_model_itself_rest_anew(before, after, anew):
    problem = SimpleNamespace(names=["bouc_wen.alpha", "bouc_wen.beta"])
    bare, with_effect = SimpleNamespace(problem=problem, on_bounds=before), SimpleNamespace(on_bounds=after)
    assert forms.rests_anew(bare, with_effect) == anew


@pytest.mark.parametrize(("ahead", "first"), [(0.001, "sensor_lag"), (0.1, "friction")])
def test_a_form_that_contains_another_effect_is_ranked_behind_it_where_it_explains_no_more(ahead, first):
    friction = Candidate.of([Score("friction", 0.1), Score("friction.lugre_viscous", 0.5 + ahead)])
    lag = Candidate.of([Score("sensor_lag", 0.5)])
    assert max(friction, lag, key=lambda item: item.rank).score.effect.startswith(first)


def test_no_form_is_tried_again_far_behind_another_effect_at_the_noise(monkeypatch):
    refits = {"creep": fit(8.0, 8.0, ["creep"]), "creep.voltage": fit(3.0, 3.0, ["creep.voltage"])}
    monkeypatch.setattr(forms, "refit", lambda case, other, effects, guess, rival: fit(2.9, 2.9, effects))
    for rival, tried in ((1.0, False), (1.5, True), (np.inf, True)):
        assert (forms.from_each_other(CASE, refits, rival) != refits) == tried


@pytest.mark.parametrize("own, led", [(6.0, 1.0), (6.0, 7.0)])
def test_a_look_alike_far_behind_is_tried_from_where_the_best_led(monkeypatch, own, led):
    monkeypatch.setattr(forms, "refit", lambda case, other, effects, guess, rival: fit(led, led, effects))
    best = Candidate.of([Score("amplifier_lag", guesses=[{"tau": 1.0}])])
    rival = Candidate.of([Score("sensor_lag", guesses=[{"tau": 1.0}])])
    stranger = Candidate.of([Score("saturation", guesses=[{"knee": 1.0}])])
    for item, left in ((best, 1.0), (rival, own), (stranger, own)):
        word = item.score.effect
        item.refits = {word: fit(left, left, [word])}
        item.take(word)
    candidates.restart_look_alikes(CASE, fit(9.0, 9.0), fit(9.0, 9.0), [best, rival, stranger])
    assert rival.fit.identify == rival.refits["sensor_lag"].identify == min(own, led)
    assert best.fit.identify == 1.0 and stranger.fit.identify == own


def test_a_look_alike_in_another_form_is_started_anew_by_the_name_of_its_block(monkeypatch):
    def started(case, fit, block, starts):
        assert block == "sensor_lag"
        return replace(fit, identify=1.5)

    monkeypatch.setattr(candidates, "restart", started)
    monkeypatch.setattr(candidates, "from_where", lambda case, other, fit, guess: fit)
    best = Candidate.of([Score("amplifier_lag", guesses=[{"tau": 1.0}])])
    best.refits, item = {"amplifier_lag": fit(1.5, 1.5)}, "sensor_lag.second_order"
    rival = Candidate(Score(item, guesses=[{"one": 1.0, "two": 2.0}]), forms=[Score(item)])
    rival.refits = {item: fit(1.52, 9.0)}
    best.take("amplifier_lag")
    rival.fit = rival.refits[item]
    candidates.restart_look_alikes(CASE, fit(9.0, 9.0), fit(9.0, 9.0), [best, rival])
    assert rival.fit.identify == rival.refits[item].identify == 1.5
