"""Of several paths the one that proves most is taken, without what it does not prove."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import stage
from made_fits import CASE, fit
from pzt_ident.diagnosis import paths
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.climb import Staircase
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.forms import Candidate
from pzt_ident.diagnosis.paths import PROVEN, best_path, improve_within, take_back
from pzt_ident.diagnosis.score import Score
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.step import Step
from pzt_ident.diagnosis.verdict import Diagnosis


@pytest.mark.parametrize(
    ("ends", "taken"),
    [
        ([("unexplained", 1.0, 1.5), ("adequate", 1.0, 2.0)], 1),
        ([("unexplained", 1.0, 2.0), ("unexplained", 1.0, 1.5)], 1),
        ([("unexplained", 1.0, 1.5), ("unexplained", 1.0, 2.0)], 0),
        ([("adequate", 1.0, 2.0), ("adequate", 1.0, 1.5)], 0),
        ([("unexplained", 5.1, 9.0), ("adequate", 1.0, 1.5)], 0),
    ],
    ids=["adequate", "better", "worse", "adequate at once", "hopeless at once"],
)
def test_of_two_paths_the_adequate_one_is_taken_else_the_better(ends, taken, monkeypatch):
    """Each path by its verdict, its last error in noise floors and its total; the second is tried where it may help."""
    several = [Staircase([Step(ending(identify, total))], ended(verdict)) for verdict, identify, total in ends]
    assert taken_of(several, lambda path: [], monkeypatch) is several[taken]


def taken_of(several, taken_back, monkeypatch, alone=False):
    """The one that is taken of paths, of which some steps are taken back. alone: whether the first explains all that
    can be told."""

    told, joined = [], object()

    def climb(case, first, diagnosis, number, on_step, known=()):
        told[:] = several[number].steps if several[number] else [joined]
        return several[number]

    def take_back(case, first, path):
        path.steps += taken_back(path)

    monkeypatch.setattr(paths, "alone_instead", lambda *given: None)
    monkeypatch.setattr(paths, "diagnose", lambda case, first: SimpleNamespace())
    monkeypatch.setattr(paths, "first_candidates", lambda case, first, diagnosis: [*range(len(several))])
    monkeypatch.setattr(paths, "climb", climb)
    monkeypatch.setattr(paths, "is_one_that_explains_all", lambda *arguments: alone)
    exchanges = (
        "exchange_main_mode",
        "exchange_second_mode",
        "exchange_limits",
        "exchange_for_bounds",
        "exchange_damped",
    )
    for exchange in exchanges:
        monkeypatch.setattr(paths, exchange, lambda *arguments: [])
    monkeypatch.setattr(paths, "take_back", take_back)
    monkeypatch.setattr(paths, "adequate", lambda case, first, fit: fit.identify < 1.5)
    monkeypatch.setattr(paths, "find_rivals", lambda *arguments: None)
    monkeypatch.setattr(paths, "conclude", lambda *arguments: None)
    best = improve_within(SimpleNamespace(floor=1.0, budget=Budget()), [Step(SimpleNamespace())], told.append)
    assert told[-len(best.steps) :] == best.steps
    return best


@pytest.mark.parametrize(
    ("effects", "identify", "validate", "alone"),
    [
        (("a",), 1.0, 3.0, True),
        (("a", "b"), 1.0, 3.0, False),
        (("a",), 2.0, 3.0, False),
        (("a",), 1.0, 12.0, False),
    ],
)
def test_no_other_effect_is_tried_first_where_one_explains_all_that_the_fitted_records_tell(
    monkeypatch, effects, identify, validate, alone
):
    """What is left of the others these do not determine, and a second path would follow it by chance."""
    path = Staircase([Step(fit(identify, validate, effects))], ended("unexplained"))
    assert paths.is_one_that_explains_all(CASE, fit(30.0, 30.0), path) == alone
    several = [Staircase([Step(ending(1.0, total))], ended("unexplained")) for total in (3.0, 2.0)]
    assert taken_of(several, lambda path: [], monkeypatch, alone) is several[not alone]


def test_a_path_that_joins_another_is_no_path_and_the_next_effect_is_tried_first(monkeypatch):
    worse, better = (Staircase([Step(ending(2.0, end))], SimpleNamespace(verdict="unexplained")) for end in (3.0, 2.0))
    assert taken_of([worse, None, better], lambda path: [], monkeypatch) is better
    assert taken_of([better, None, None], lambda path: [], monkeypatch) is better


def test_of_two_paths_that_end_above_the_noise_the_one_is_taken_that_is_lower_with_what_is_proven(monkeypatch):
    lower, proven = (Staircase([Step(ending(2.0, end))], SimpleNamespace(verdict="unexplained")) for end in (2.0, 3.0))
    assert taken_of([lower, proven], lambda path: [Step(ending(9.0, 9.0))] * (path is lower), monkeypatch) is proven


def test_an_adequate_path_of_which_little_is_proven_is_no_more_than_another(monkeypatch):
    """As where friction takes the place of the model's loops, and a lag does nearly as well."""
    lag = Staircase([Step(ending(1.6, 1.6))], ended("unexplained"))
    friction = Staircase([Step(ending(1.0, 1.0))], ended("adequate"))
    assert taken_of([lag, friction], lambda path: [Step(ending(8.0, 8.0))] * (path is friction), monkeypatch) is lag
    assert friction.last.verdict == "unexplained"


def ended(verdict):
    return Diagnosis(verdict, "", None, [], [])


def ending(identify, total, parameters=3):
    return SimpleNamespace(identify=identify, total=total, freedom=parameters)


def test_of_paths_that_end_as_low_the_one_with_fewer_parameters_is_taken():
    """A general form ends as low as the effect that it contains."""
    ends = ending(1.22, 1.2196, 9), ending(1.22, 1.2197, 7), ending(4, 4, 2)
    several = [Staircase([Step(end)], SimpleNamespace(verdict="unexplained")) for end in ends]
    assert best_path(SimpleNamespace(floor=1.0), several) is several[1]


def test_an_effect_that_only_led_out_of_a_side_minimum_is_taken_out_again():
    """The first fit rests far from the stage; with drift it gets there, and then drift is of no use."""
    case = stage.case()
    problem, model = case.problem(()), case.problem(("drift",))
    resting = fit_at((), problem, problem.unit_point(first_fit(case, 0).values | {"bouc_wen.alpha": 0.9}))
    there = fit_at(("drift",), model, model.unit_point(first_fit(case, 0).values | {"drift.tau": 100.0}))
    found = Staircase([Step(resting), Step(there, "drift")], Diagnosis("adequate", "", there, [], []))
    take_back(case, resting, found)
    assert [(step.added, step.removed) for step in found.steps] == [(None, None), ("drift", None), (None, "drift")]
    assert (found.steps[-1].fit.effects, found.last.verdict, found.suspects) == ((), "adequate", [])


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_what_several_effects_can_do_without_is_told_from_other_starts_too(monkeypatch, count):
    """Two are often missing; three may stand in for one."""
    words = ("creep", "delay", "drift", "friction")
    fits = [Fit(words[:number], None, np.zeros(1), 1.0, 1.0) for number in range(count + 1)]
    asked = []
    monkeypatch.setattr(paths, "alone_instead", lambda *given: None)
    monkeypatch.setattr(paths, "near_noise", lambda *arguments: True)
    monkeypatch.setattr(paths, "remove_unneeded", lambda *arguments, newest, restarted: asked.append(restarted) or [])
    monkeypatch.setattr(paths, "unproven_of", lambda *arguments: [])
    take_back(SimpleNamespace(floor=1.0, budget=Budget()), fits[0], Staircase([Step(fit) for fit in fits], ended("")))
    assert asked == [count > 2]


@pytest.mark.parametrize(
    ("proven", "left", "since", "end"),
    [
        ({"ab"}, 20.0, 0, "ab"),
        ({"a", "ab"}, 20.0, 0, "ab"),
        ({"a"}, 20.0, 0, "a"),
        ({"abc", "ab"}, 20.0, 0, "abc"),
        ({"ab"}, 2.9, 0, ""),
        (set(), 20.0, 0, ""),
        ({"a", "ab"}, 20.0, 2, ""),
    ],
    ids=["fewer", "the lowest", "one", "all", "no better", "none", "within other bounds"],
)
def test_where_little_is_left_of_the_last_model_the_lowest_one_before_it_that_is_proven_is(
    monkeypatch, proven, left, since, end
):
    """since: the step from which on bounds are wider."""
    totals = {"": 20.0, "a": 5.0, "ab": 3.0, "abc": 2.0}
    fits = [Fit(tuple(word), None, np.zeros(1), total, total) for word, total in totals.items()]
    case, nothing = SimpleNamespace(floor=1.0, budget=Budget()), replace(fits[0], identify=left, validate=left)

    def suspects(case, first, fit, steps):
        return [] if "".join(fit.effects) in proven else [SimpleNamespace(effect="c", without=nothing)]

    monkeypatch.setattr(paths, "unproven_of", suspects)
    monkeypatch.setattr(paths, "near_noise", lambda *arguments: False)
    monkeypatch.setattr(paths, "drop_outdone_rivals", lambda *arguments: None)
    steps = [Step(fit, *fit.effects[-1:], case=case if number == since else None) for number, fit in enumerate(fits)]
    found = Staircase([*steps], None)
    take_back(case, fits[0], found)
    assert "".join(found.steps[-1].fit.effects) == end
    assert [step.change for step in found.steps[len(steps) :]] == {"abc": [], "": [""]}.get(end, [PROVEN])


@pytest.mark.parametrize(("of_two", "end", "beside"), [(4.0, "b", "ab"), (6.0, "a", None), (19.95, "a", None)])
def test_what_is_proven_of_an_earlier_model_counts_without_the_rest_of_it(monkeypatch, of_two, end, beside):
    """beside: the earlier model with that rest, in which ties are looked for, too."""
    totals = {"": 20.0, "a": 5.0, "ab": 3.0, "abc": 2.0, "b": of_two}
    fits = {word: Fit(tuple(word), None, np.zeros(1), total, total) for word, total in totals.items()}
    left = {"ab": "b", "abc": ""}

    def suspects(case, first, fit, steps):
        word = "".join(fit.effects)
        return [SimpleNamespace(effect="c", without=fits[left[word]])] if word in left else []

    monkeypatch.setattr(paths, "unproven_of", suspects)
    monkeypatch.setattr(paths, "near_noise", lambda *arguments: False)
    monkeypatch.setattr(paths, "drop_outdone_rivals", lambda *arguments: None)
    found = Staircase([Step(fits[word], *word[-1:]) for word in ("", "a", "ab", "abc")], None)
    doubted = take_back(SimpleNamespace(floor=1.0, budget=Budget()), fits[""], found)
    assert (found.end, found.steps[-1].change) == (fits[end], PROVEN)
    assert doubted is fits.get(beside)


def test_an_effect_of_the_last_model_is_no_suspect_in_another_form(monkeypatch):
    fits = [
        Fit(effects, None, np.zeros(1), total, total) for effects, total in (((), 9.0), (("a",), 5.0), (("a.b",), 4.0))
    ]
    suspect = SimpleNamespace(effect="a.b", without=fits[0])
    monkeypatch.setattr(paths, "unproven_of", lambda case, first, fit, steps: [suspect] if fit is fits[2] else [])
    monkeypatch.setattr(paths, "near_noise", lambda *arguments: False)
    monkeypatch.setattr(paths, "drop_outdone_rivals", lambda *arguments: None)
    found = Staircase([Step(fits[0]), Step(fits[1], "a"), Step(fits[2], "a.b", "a")], None)
    take_back(SimpleNamespace(floor=1.0, budget=Budget()), fits[0], found)
    assert (found.end, found.suspects) == (fits[1], [])


def test_no_effect_is_held_against_a_fit_of_other_blocks(monkeypatch):
    """The model as given, whose mechanics were left out, has no effect either, and is no model without this one."""
    fits = [fit(9.0), fit(9.2), fit(5.0, effects=("creep",)), fit(4.0, effects=("creep", "drift"))]
    steps = [Step(fits[0]), Step(fits[1], case=CASE), *(Step(each, each.effects[-1]) for each in fits[2:])]
    monkeypatch.setattr(paths, "unproven", lambda case, first, now, rivals, known: known)
    assert paths.unproven_of(CASE, fits[1], fits[-1], steps) == [fits[1], *fits[1:]]
    assert paths.unproven_of(CASE, fits[0], fits[0], steps[:1]) == [fits[0], fits[0]]


@pytest.mark.parametrize(
    ("verdict", "effects", "alone", "found"),
    [
        ("adequate", 2, 1.0, "saturation"),
        ("adequate", 2, 3.0, None),
        ("adequate", 1, 1.0, None),
        ("unexplained", 2, 1.0, None),
    ],
)
def test_ahead_of_a_pair_is_an_effect_that_was_not_refitted_and_does_alone(monkeypatch, verdict, effects, alone, found):
    items = [
        Candidate.of([Score(word, share, guesses=[{}])]) for word, share in {"creep": 0.9, "saturation": 0.2}.items()
    ]
    items[0].refits = {"creep": fit(4.0, 4.0, ["creep"])}
    path = SimpleNamespace(last=SimpleNamespace(verdict=verdict), end=fit(1.0, 1.0, ["creep", "drift"][:effects]))
    tried = []

    def refit_forms(case, before, scores, rival):
        tried.append((scores[0].effect, rival))
        return {scores[0].effect: fit(alone, alone, [scores[0].effect])}

    monkeypatch.setattr(paths, "refit_forms", refit_forms)
    best = paths.alone_instead(CASE, fit(9.0, 9.0), SimpleNamespace(candidates=items), path)
    assert (best and best.score.effect) == found and (best is None or best.fit.identify == alone)
    assert tried == ([("saturation", 1.0)] if verdict == "adequate" and effects == 2 else [])


@pytest.mark.parametrize(("scores", "tried"), [(0.02, False), (0.9, True)])
def test_a_disturbance_that_scored_too_little_for_the_short_list_is_added_first_only_if_it_is_the_best(scores, tried):
    """A ripple took up half of what a memory and a lag were, and began the second path."""
    words = ["saturation", "creep", "asymmetry", "delay", "friction", "quadratic_gain"]
    shares = dict.fromkeys(words, 0.5) | {"periodic_disturbance": scores}
    items = []
    for word, explained in shares.items():
        item = Candidate.of([Score(word, explained)])
        item.refits = {word: fit(4.0 if word == "saturation" else 6.0, 6.0, [word])}
        item.take(word)
        items.append(item)
    first, hum = fit(9.0, 9.0), items[-1]
    for passing, is_first in (([items[0], hum], False), ([hum], True)):
        diagnosis = SimpleNamespace(candidates=items, passing=passing)
        found = [item.score.effect for item in paths.first_candidates(CASE, first, diagnosis)]
        assert ("periodic_disturbance" in found) == (tried or is_first)


@pytest.mark.parametrize(
    ("end", "diagnosed"),
    [(fit(5.0, 5.0), False), (fit(5.01, 5.0), False), (fit(4.0, 5.0), True), (fit(5.0, 5.0, ["creep"]), True)],
)
def test_a_path_that_leads_back_to_the_model_as_given_has_its_diagnosis(monkeypatch, end, diagnosed):
    first, anew = fit(5.0, 5.0), []
    creep = Candidate(Score("creep", explained=0.8), decision="missing")

    def diagnose(case, end, first):
        anew.append(end)
        return Diagnosis("unexplained", "", end, [], [])

    monkeypatch.setattr(paths, "diagnose", diagnose)
    given = Diagnosis("missing", "creep is missing", first, [creep], ["creep"])
    path = Staircase([Step(first), Step(end)], Diagnosis("missing", "", fit(2.0, 2.0, ["creep"]), [], []))
    paths.conclude(CASE, first, path, given)
    assert anew == [end] * diagnosed
    assert path.last.before is end and path.last.verdict == "unexplained"
    assert [item.decision for item in path.last.candidates] == ([] if diagnosed else ["suspect"])
