"""Which of several effects is taken: by hand, the noise floor being 1."""

from types import SimpleNamespace

import numpy as np
import pytest

from made_fits import CASE, fit
from pzt_ident.diagnosis import forms, verdict
from pzt_ident.diagnosis.forms import Candidate
from pzt_ident.diagnosis.score import Score
from pzt_ident.diagnosis.verdict import best_pair, diagnose, pair_behind
from pzt_ident.model.registry import blocks


@pytest.fixture
def judged(monkeypatch):
    """What is said of a model that leaves 30 of both uses, given the fits with each of some effects."""

    def of(fits):
        scores = [Candidate.of([Score(word, explained=0.9, power=3.0)]) for word in fits]
        scorer = SimpleNamespace(scores=lambda word: next(item.forms for item in scores if item.score.effect == word))
        monkeypatch.setattr(CASE, "shares", {}, raising=False)
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


@pytest.mark.parametrize(
    ("place", "left", "taken"), [(0.0, 21.0, "delay"), (0.0, 22.0, "friction"), (0.5, 21.0, "friction")]
)
def test_what_is_in_a_declared_limit_gives_way_to_any_that_removes_half_as_much(judged, place, left, taken):
    """As the second mode that is the main one, in the place of a delay."""
    best = fit(6.0, 6.0, ["friction"], own=[place], limit="a play")
    diagnosis = judged({"friction": best, "delay": fit(left, left, ["delay"])})
    assert diagnosis.tied == [taken]


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
    [(15.0, 0.9, 1.0, True), (25.0, 0.9, 1.0, False), (15.0, 0.5, 1.0, False), (15.0, 0.9, 29.0, False)],
    ids=["both", "not most", "no promise", "not both"],
)
def test_a_second_effect_is_sought_behind_one_that_loses_the_validation_records(
    alone, promised, together, found, monkeypatch
):
    before, lost, both = fit(30.0, 15.0), fit(alone, 40.0, ("slew_limit",)), fit(together, 1.0, ("slew_limit", "creep"))
    beside = [Candidate(Score("drift", 0.1)), Candidate(Score("creep", promised, promised))]
    monkeypatch.setattr(verdict, "scorer_of", lambda *_: None)

    def scored(case, first, leading, scorer, in_every_form=True):
        return beside if leading is lost and in_every_form else []

    monkeypatch.setattr(verdict, "score_all", scored)
    monkeypatch.setattr(verdict, "refit", lambda case, leading, effects, guess: both)
    refits = {"slew_limit": lost, "slew_limit.lag": fit(29.0, 15.0)}
    items = [Candidate(Score("drift", 0.2), fit(28.0, 15.0)), Candidate(Score("slew_limit", 0.8), lost, refits=refits)]
    assert (pair_behind(CASE, before, before, items) is both) is found
    assert pair_behind(CASE, before, before, items[:1]) is None


def candidate_of(item, *others):
    """A candidate that means its last form, with the fits of all of them."""
    forms = {fit.effects[-1]: fit for fit in (item, *others)}
    candidate = Candidate.of([Score(word, explained=0.9) for word in forms])
    candidate.refits = forms
    candidate.take([*forms][-1])
    return candidate


@pytest.mark.parametrize(
    ("usual", "dimensions", "kept", "form"),
    [
        (1.05, 7, True, "sensor_lag"),
        (1.05, 6, True, "sensor_lag"),
        (1.5, 7, False, "sensor_lag.third_order"),
        (1.5, 6, True, "sensor_lag.third_order"),
    ],
)
def test_a_form_of_more_parameters_gives_way_to_the_first_where_that_is_tied(usual, dimensions, kept, form):
    """One more tells nothing: a filter of second order and a delay are two names for what the data show."""
    best = candidate_of(fit(1.0, effects=["amplifier_lag"], dimensions=5))
    more = fit(1.0, effects=["sensor_lag.third_order"], dimensions=dimensions)
    rival = candidate_of(fit(usual, effects=["sensor_lag"], dimensions=5), more)
    assert verdict.in_least_form(CASE, best, rival) == kept
    assert rival.score.effect == form


@pytest.mark.parametrize(("apart", "kept"), [(0.11, True), (0.09, False)])
def test_a_form_of_more_parameters_that_fits_better_is_in_the_class(apart, kept):
    best = candidate_of(fit(np.hypot(1.0, apart), effects=["delay"], dimensions=5))
    rival = candidate_of(
        fit(1.5, effects=["sensor_lag"], dimensions=5), fit(1.0, effects=["sensor_lag.third_order"], dimensions=7)
    )
    assert verdict.in_least_form(CASE, best, rival) == kept
    assert rival.score.effect == "sensor_lag.third_order"
