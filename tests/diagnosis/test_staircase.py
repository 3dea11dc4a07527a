"""The staircase: pairs are found, a wrong first effect is removed again, and it ends where no effect explains more."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import stage
from made_fits import CASE, fit
from pzt_ident.diagnosis import climb, exchange, scores, staircase
from pzt_ident.diagnosis.budget import EXPLORING, Budget
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.climb import add_pair, add_restarted
from pzt_ident.diagnosis.exchange import exchange_any, remove_unneeded
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.possible import fitting_forms
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.score import Score
from pzt_ident.diagnosis.staircase import improve
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.step import Step, explained_share
from pzt_ident.diagnosis.verdict import Candidate, Diagnosis, diagnose
from pzt_ident.engine import work
from pzt_ident.model.registry import blocks

PAIR = stage.EFFECTS["creep"] | stage.EFFECTS["quadratic_gain"]
ONE_AXIS = SimpleNamespace(model=SimpleNamespace(measured=(0,)))


def climbed(case):
    reported = []
    found = improve(case, first_fit(case, 0), reported.append)
    assert reported[0].added is None and reported[0].removed is None
    assert found.steps[-1].fit is found.last.before
    return found.steps, found.last


def test_at_the_noise_the_first_step_is_the_last():
    steps, last = climbed(stage.case())
    assert (len(steps), last.verdict) == (1, "adequate")
    assert steps[0] == Step(steps[0].fit)


def test_one_effect_is_one_step_down_to_the_noise():
    steps, last = climbed(stage.case(stage.EFFECTS["quadratic_gain"]))
    assert [step.added for step in steps] == [None, "quadratic_gain"]
    assert steps[1].tied == ("quadratic_gain",)
    assert steps[1].expected == pytest.approx(1, abs=0.05)
    assert steps[1].explained == pytest.approx(1, abs=0.05)
    assert steps[1].fit.validate == pytest.approx(stage.NOISE, rel=0.1)
    assert last.verdict == "adequate"


@pytest.fixture(scope="module")
def pair_climbed():
    return climbed(stage.case(PAIR))


def test_two_effects_are_both_found_and_nothing_else(pair_climbed):
    steps, last = pair_climbed
    assert set(steps[-1].fit.effects) == {"creep", "quadratic_gain"}
    assert last.verdict == "adequate"
    assert steps[-1].fit.identify == pytest.approx(stage.NOISE, rel=0.1)
    assert steps[-1].fit.validate == pytest.approx(stage.NOISE, rel=0.1)
    rmse = [step.fit.identify for step in steps if not step.removed]
    assert rmse == sorted(rmse, reverse=True)


def test_a_spent_budget_suffices_for_the_best_effect_and_the_rest_is_said():
    case = stage.case(stage.EFFECTS["quadratic_gain"])
    first = first_fit(case, 0)
    case.budget = Budget(0.0)
    case.budget.lasts = lambda: True
    steps = improve(case, first).steps
    assert [step.added for step in steps] == [None, "quadratic_gain"]
    assert "the refits of all candidates" in case.budget.untried


def test_the_part_of_the_budget_for_other_effects_begins_where_the_first_fit_ends(monkeypatch):
    case, begun = stage.case(stage.EFFECTS["creep"]), 0.4
    first = first_fit(case, 0)
    case.budget = Budget(100)
    work.add(100 * begun)
    parts = []

    def noting(case, fit):
        parts.append(case.budget.beside)
        return diagnose(case, fit)

    monkeypatch.setattr(staircase, "diagnose", noting)
    improve(case, first)
    assert begun < parts[0] == pytest.approx((begun + EXPLORING) / 2, abs=0.01)


def test_the_effects_of_the_job_stay():
    case = stage.case(PAIR, effects=["creep"])
    steps, _ = climbed(stage.considering(case, "quadratic_gain", "drift", "thermal_relaxation", "asymmetry"))
    assert [step.fit.effects for step in steps] == [("creep",), ("creep", "quadratic_gain")]


def test_a_wrong_first_pick_is_taken_back():
    case = stage.case(stage.EFFECTS["quadratic_gain"])
    first = first_fit(case, 0)
    wrong = refit(case, first, ("asymmetry",), {})
    right = refit(case, wrong, ("asymmetry", "quadratic_gain"), {})
    assert remove_unneeded(case, first, replace(right, validate=0.0)) == []  # what the unseen records would miss stays
    (back,) = remove_unneeded(case, first, right)
    assert (back.added, back.removed) == (None, "asymmetry")
    assert back.fit.effects == ("quadratic_gain",)
    assert back.fit.identify == pytest.approx(stage.NOISE, rel=0.1)
    assert abs(back.explained) < 0.1


def test_what_is_needed_is_not_taken_back():
    case = stage.case(PAIR)
    first = first_fit(case, 0)
    one = refit(case, first, ("creep",), {"creep.ratio": 0.08, "creep.tau": 1.0})
    two = refit(case, one, ("creep", "quadratic_gain"), {})
    assert remove_unneeded(case, first, two) == []
    assert remove_unneeded(case, two, refit(case, two, ("creep", "quadratic_gain", "drift"), {})) == []


def test_what_a_step_explains_is_a_share_of_the_misfit():
    case = stage.case(PAIR)
    first = first_fit(case, 0)
    one = refit(case, first, ("quadratic_gain",), {})
    two = refit(case, one, ("quadratic_gain", "creep"), {"creep.ratio": 0.08, "creep.tau": 1.0})
    floor = case.floor**2
    share = (first.identify**2 - one.identify**2) / (first.identify**2 - floor)
    assert explained_share(case, first, one) == pytest.approx(share)
    assert explained_share(case, one, two) == pytest.approx(1, abs=0.05)
    assert explained_share(case, one, first) < 0


def test_what_no_effect_explains_ends_unexplained():
    def strange(record):
        pattern = np.sign(np.sin(0.37 * record.drive[0]) + 0.3 * np.sin(np.pi * record.time**1.5))
        return 12 * stage.NOISE * pattern * (np.gradient(record.drive[0]) != 0)

    case = stage.with_response(stage.case(), strange)
    case.ruled_out = ("distributed_memory", "friction", "periodic_disturbance", "resonance")  # most of the work
    steps, last = climbed(case)
    assert last.verdict == "unexplained"
    assert steps[-1].fit.identify > 5 * stage.NOISE


def test_two_effects_that_hide_each_other_are_two_stairs_the_better_one_first():
    case = stage.case(PAIR)
    first = first_fit(case, 0)
    diagnosis = diagnose(case, first)
    hidden = [item for item in diagnosis.candidates if item.score.effect in ("creep", "quadratic_gain")]
    one, two = add_pair(case, first, first, replace(diagnosis, candidates=hidden))
    assert {one.added, two.added} == set(two.fit.effects) == {"creep", "quadratic_gain"}
    assert one.fit.effects == (one.added,)
    assert first.total > one.fit.total > two.fit.total
    assert one.explained == pytest.approx(explained_share(case, first, one.fit))
    assert two.explained == pytest.approx(explained_share(case, one.fit, two.fit))
    assert two.fit.validate == pytest.approx(stage.NOISE, rel=0.1)


@pytest.mark.parametrize("hopeless", [0, np.inf])
def test_an_effect_that_rests_in_a_side_minimum_is_a_stair_once_nothing_else_is_left(monkeypatch, hopeless):
    monkeypatch.setattr(climb, "FAR", hopeless)
    case = stage.case(stage.EFFECTS["quadratic_gain"])
    first = first_fit(case, 0)
    problem = case.problem(("quadratic_gain",))
    resting = fit_at(("quadratic_gain",), problem, problem.unit_point(first.values | {"quadratic_gain.curvature": 0.0}))
    candidate = Candidate(Score("quadratic_gain"), resting, refits={"quadratic_gain": resting})
    (step,) = add_restarted(case, first, first, Diagnosis("unexplained", "", first, [candidate], []))
    assert step.added == "quadratic_gain"
    assert step.fit.identify == pytest.approx(stage.NOISE, rel=0.1)


@pytest.mark.parametrize("on_bounds", [True, False])
def test_far_from_the_noise_effects_are_fitted_anew(monkeypatch, on_bounds):
    """Of the short list; beside a fit that rests on bounds those that lead lowest at a glance, whatever their scores,
    in every form, but for those with amounts of each record."""
    case, tried = stage.case({}), []
    words = ("friction", "saturation", "drift", "delay")
    items = [item for word in words for item in fitting_forms(case, (), word) if word != "drift"]
    glanced = ["friction.coulomb", "delay", "saturation.knee"]
    now = replace(with_errors(100.0), effects=())
    now.__dict__["on_bounds"] = ("bouc_wen.alpha",) if on_bounds else ()

    def first_fit(case, seed, effects, rival):
        tried.append((effects[-1], rival))
        return replace(with_errors(50.0 - len(tried)), effects=effects)

    monkeypatch.setattr(climb, "at_a_glance", lambda case, effects: [*glanced, *items].index(effects[-1]))
    monkeypatch.setattr(climb, "first_fit", first_fit)
    refits = {"drift": {"drift": now}, "saturation": {"saturation": now, "saturation.cubic": now}}
    every = [Candidate(Score(word), refits=refits.get(word, {})) for word in words]
    found = list(climb.started_anew(case, now, Diagnosis("unexplained", "", now, every, [])))
    expected = glanced if on_bounds else ["saturation", "saturation.cubic"]
    assert [score.effect for score, _ in found] == [item for item, _ in tried]
    assert [item for item, _ in tried[:3]] == expected and len(tried) == (climb.MOST_ANEW if on_bounds else 2)
    assert [rival for _, rival in tried[:2]] == [np.inf, 49.0]


@pytest.mark.parametrize(("noise", "takes", "astray"), [(1.0, 0.2, True), (1.0, 0.9, False), (30.0, 0.2, False)])
def test_a_model_is_astray_far_from_the_noise_where_no_effect_takes_up_half(noise, takes, astray):
    case = SimpleNamespace(floor=noise, floors=np.full(1, noise))
    now, best = (with_errors(100 * np.sqrt(share)) for share in (1, 1 - takes))
    assert climb.is_astray(case, now, now, best) == astray
    unseen = with_errors(2.0 * noise, 100.0 * noise)
    assert climb.is_astray(case, unseen, unseen, unseen)
    assert not climb.is_astray(case, unseen, unseen, with_errors(2.0 * noise, 10.0 * noise))


def test_a_model_of_which_an_effect_clears_an_axis_is_not_astray():
    case = SimpleNamespace(floor=1.0, floors=np.ones(2))
    now, half, both = with_errors([90.0, 10.0]), with_errors([90.0, 1.0]), with_errors([80.0, 8.0])
    assert not climb.is_astray(case, now, now, half)
    assert climb.is_astray(case, now, now, both)


def with_errors(identify, validate=None):
    """A fit with these errors, of each axis."""
    errors = {"identify": np.atleast_1d(identify), "validate": validate and np.atleast_1d(validate)}
    sizes = np.ones(len(errors["identify"]))
    problem = SimpleNamespace(sizes=sizes, by_axis=lambda points, use: errors[use][None])
    together = {use: own if own is None else float(np.sqrt(np.mean(own**2))) for use, own in errors.items()}
    return Fit((), problem, np.zeros(1), together["identify"], together["validate"])


def test_two_effects_that_explain_half_each_are_added_together(monkeypatch):
    """No fit is restarted for them."""
    case = stage.case(stage.EFFECTS["quadratic_gain"] | stage.EFFECTS["creep"])
    case.ruled_out = tuple({*blocks.effects()} - {"quadratic_gain", "creep"})
    first = first_fit(case, 0)
    monkeypatch.setattr(climb, "is_astray", lambda case, first, now, best: True)
    monkeypatch.setattr(climb, "add_restarted", lambda *arguments: pytest.fail("restarted"))
    diagnosis = diagnose(case, first)
    steps = climb.next_steps(case, first, [Step(first)], diagnosis, diagnosis.best)
    assert {step.added for step in steps} == {"quadratic_gain", "creep"}


@pytest.mark.parametrize("first_again", [True, False])
def test_a_path_begins_with_the_two_effects_that_account_for_all(monkeypatch, first_again):
    """A coupling and a spring were at 1.08 noise floors; beside the coupling alone a memory scored more than the
    spring. The other paths of the model begin with another effect."""
    now, both = fit(12.0, 12.0), fit(1.0, 1.0, ("creep", "friction"))
    best, other = (Candidate(Score(word), fit(4.0, 4.0, [word]), "missing") for word in ("creep", "drift"))
    best.account = both
    left = {"creep": 4.0, "friction": 3.0}
    monkeypatch.setattr(
        climb, "refit", lambda case, now, effects, values: fit(left[effects[-1]], left[effects[-1]], effects)
    )
    monkeypatch.setattr(climb, "exchange_behind", lambda *arguments: [])
    monkeypatch.setattr(climb, "is_astray", lambda *arguments: False)
    monkeypatch.setattr(climb, "wider_bounds", lambda *arguments: [])
    diagnosis = Diagnosis("missing", "", now, [best, other], ["creep"])
    steps = climb.next_steps(CASE, now, [Step(now)], diagnosis, best if first_again else other)
    assert [step.added for step in steps] == (["friction", "creep"] if first_again else ["drift"])
    assert (steps[-1].fit is both) == first_again
    monkeypatch.setattr(climb, "wider_bounds", lambda case, first, fit: [Step(fit)])
    steps = climb.next_steps(CASE, now, [Step(now)], diagnosis, best)
    assert [step.added for step in steps] == ["friction"], "its bounds are widened first"


@pytest.mark.parametrize("kept", [True, False])
def test_a_step_is_settled_first_where_no_other_effect_promises_most_of_what_it_leaves(monkeypatch, kept):
    """A promise that is not kept is asked for afterwards."""
    case, settled = stage.considering(stage.case(PAIR), "quadratic_gain", *["creep"] * kept), []
    if not kept:
        monkeypatch.setattr(climb, "promises_most", lambda case, first, fit: "creep")
        monkeypatch.setattr(climb, "keeps_promise", lambda case, fit, effect: True)
    monkeypatch.setattr(climb, "settle", lambda case, first, before, step: settled.append(step.added) or [])
    first = first_fit(case, 0)
    diagnosis = diagnose(case, first)
    found = climb.climb(case, [Step(first)], diagnosis, diagnosis.best, lambda step: None)
    added = [step.added for step in found.steps if step.added]
    assert (added[0] in settled) != kept and added[-1] in settled


@pytest.mark.parametrize(("word", "kept"), [("creep", True), ("delay", False)])
def test_a_promise_that_a_refit_does_not_keep_settles_the_step_at_once(monkeypatch, word, kept):
    """Other forms of what was added are tried before all effects are refitted beside it."""
    case, settled = stage.considering(stage.case(PAIR), "quadratic_gain", "creep", "delay"), []
    first = first_fit(case, 0)
    begun = refit(case, first, ("quadratic_gain",), {})
    assert climb.keeps_promise(case, begun, word) == kept
    monkeypatch.setattr(climb, "promises_most", lambda case, first, fit: word)
    monkeypatch.setattr(climb, "settle", lambda case, first, before, step: settled.append(step.added) or [])
    step = Step(begun, "quadratic_gain")
    assert climb.complete(case, first, [Step(first)], [step], False) == kept
    assert settled == ["quadratic_gain"] * (not kept)


@pytest.mark.parametrize("confirmed", [True, False])
def test_a_promise_that_is_not_kept_settles_the_step_unless_unseen_records_do_not_confirm_what_kept_it(
    monkeypatch, confirmed
):
    """What explains nearly all of the fitted records and fails on the others is tried behind other forms first."""
    case, settled = stage.considering(stage.case(PAIR), "quadratic_gain"), []
    first = first_fit(case, 0)
    diagnosis = diagnose(case, first)
    monkeypatch.setattr(climb, "promises_most", lambda case, first, fit: "creep")
    monkeypatch.setattr(climb, "keeps_promise", lambda case, fit, effect: True)
    monkeypatch.setattr(climb, "unconfirmed", lambda case, first, now, fits: None if confirmed else first)
    monkeypatch.setattr(climb, "settle", lambda case, first, before, step: settled.append(step.added) or [])
    monkeypatch.setattr(climb, "exchange_behind", lambda *arguments: [])
    climb.climb(case, [Step(first)], diagnosis, diagnosis.best, lambda step: None)
    assert settled == ["quadratic_gain"] * confirmed


@pytest.mark.parametrize(("lower", "taken"), [(0.999, False), (0.9, True)])
def test_a_restart_that_leads_hardly_lower_leaves_a_step_its_fit(monkeypatch, lower, taken):
    """Else all effects would be scored again beside it."""
    case = stage.considering(stage.case(PAIR), "quadratic_gain", "creep")
    first = first_fit(case, 0)
    after = replace(refit(case, first, ("creep",), {}), identify=3 * case.floor, validate=3 * case.floor)
    restarted = replace(after, identify=lower * after.identify, validate=lower * after.validate)
    monkeypatch.setattr(climb, "restart", lambda case, fit: restarted)
    monkeypatch.setattr(climb, "exchange_accounts", lambda *arguments: [])
    step = Step(after, "creep")
    assert climb.settle(case, first, first, step) == []
    assert step.fit is (restarted if taken else after)


def test_a_path_ends_where_it_joins_a_known_one_that_is_as_low():
    case = stage.case(stage.EFFECTS["creep"])
    first = first_fit(case, 0)
    diagnosis = diagnose(case, first)

    def climbed(known):
        return climb.climb(case, [Step(first)], diagnosis, diagnosis.best, lambda step: None, known)

    end = climbed([]).end
    assert end.effects and climbed([end]) is None
    assert climbed([replace(end, identify=2 * end.identify, validate=2 * end.validate)]).end.total == end.total


@pytest.mark.parametrize(
    ("explained", "added", "promised"),
    [
        (0.7, ("quadratic_gain",), "sensor_lag"),
        (0.5, (), ""),
        (0.8, ("quadratic_gain", "delay"), ""),
        (0.8, (), "sensor_lag"),
    ],
)
def test_a_look_alike_of_what_was_added_promises_nothing_beside_it(monkeypatch, explained, added, promised):
    scored = [Candidate(Score("sensor_lag", explained_in_bounds=explained)), Candidate(Score("drift"))]
    monkeypatch.setattr(scores, "score_all", lambda *arguments, **more: scored)
    monkeypatch.setattr(scores, "scorer_of", lambda case, fit: None)
    first, fit = SimpleNamespace(effects=()), SimpleNamespace(effects=added)
    assert scores.promises_most(None, first, fit) == promised


@pytest.mark.parametrize("restarted", [False, True])
def test_an_effect_that_only_led_out_of_a_side_minimum_is_removed(monkeypatch, restarted):
    monkeypatch.setattr(exchange, "refit", lambda case, now, effects, guess: with_errors(2.0))
    monkeypatch.setattr(exchange, "restart", lambda case, fit: with_errors(1.0))
    now = replace(with_errors(1.0), effects=("load_mass",))
    case = SimpleNamespace(floor=1.0, budget=Budget())
    steps = remove_unneeded(case, with_errors(12.0), now, newest=0, restarted=restarted)
    assert [step.removed for step in steps] == (["load_mass"] if restarted else [])


@pytest.mark.parametrize(
    ("without", "validate", "removed"), [(5.9, 1.46, []), (5.9, 1.6, ["drift"]), (1.3, 1.46, ["drift"])]
)
def test_what_takes_up_most_of_the_identification_records_is_needed_near_the_noise_of_the_others(
    monkeypatch, without, validate, removed
):
    """A coupling to an axis that rests in the records kept back, which are a little above the noise."""
    bare = replace(with_errors(without), validate=validate)
    monkeypatch.setattr(exchange, "refit", lambda case, now, effects, guess: bare)
    now = replace(with_errors(1.05), validate=validate, effects=("drift",))
    first = replace(with_errors(7.85), validate=7.85)
    steps = remove_unneeded(SimpleNamespace(floor=1.0, budget=Budget()), first, now, newest=0)
    assert [step.removed for step in steps] == removed


def test_a_proxy_is_exchanged_for_what_is_missing():
    case = stage.case(stage.EFFECTS["quadratic_gain"])
    first = first_fit(case, 0)
    (step,) = exchange_any(case, first, refit(case, first, ("asymmetry",), {}))
    assert (step.added, step.removed, step.fit.effects) == ("quadratic_gain", "asymmetry", ("quadratic_gain",))
    assert step.fit.validate == pytest.approx(stage.NOISE, rel=0.1)


def test_what_fits_as_well_in_the_place_of_an_effect_is_told_once_all_are_known(pair_climbed):
    steps, _ = pair_climbed
    for step in steps:
        if step.added in steps[-1].fit.effects:
            assert step.tied[0] == step.added
            assert set(step.tied[1:]) <= set(blocks[step.added].look_alikes)


@pytest.mark.parametrize(("parameters", "taken"), [(1, "sensor_lag"), (3, "friction.coulomb"), (4, "friction.coulomb")])
@pytest.mark.parametrize("twin", [False, True])
def test_beside_other_effects_too_the_simpler_of_tied_look_alikes_is_taken(monkeypatch, parameters, taken, twin):
    """twin: whether the delay, which is worse, fits as another form of the friction does."""

    def fitted(word, total, freedom):
        return SimpleNamespace(effects=("creep", word), total=total, identify=total, validate=None, freedom=freedom)

    now, rival, worse = (
        fitted("friction.coulomb", 1.1, 3),
        fitted("sensor_lag", 1.15, parameters),
        fitted("delay", 2, 1),
    )
    others = {"creep": [], "friction.coulomb": [rival, worse], "forms": [fitted("friction", 2 if twin else 2.1, 3)]}
    monkeypatch.setattr(exchange, "look_alikes", lambda case, now, effect, *_: [effect])
    monkeypatch.setattr(exchange, "other_forms", lambda case, now, effect: ["forms"])
    monkeypatch.setattr(
        exchange, "fits_in_place", lambda case, now, effect, items, **_: others[items[0]] if items else []
    )
    steps, told = [Step(now, "creep"), Step(now, "friction.coulomb")], []
    case = SimpleNamespace(floor=1.0, budget=Budget())
    exchange.find_rivals(case, SimpleNamespace(effects=()), steps, told.append)
    assert steps[-1].fit.effects == ("creep", taken)
    tied = {"friction.coulomb", "sensor_lag", *(["delay"] if twin else [])}
    assert (steps[-1].added, set(steps[-1].tied)) == (taken, tied)
    assert steps[-1].tied[0] == taken
    assert told == steps[2:]


@pytest.mark.parametrize(
    ("left", "freedom", "taken"), [(0.98, 2, "delay"), (1.12, 2, "amplifier_lag"), (0.98, 3, "amplifier_lag")]
)
def test_a_look_alike_of_no_more_parameters_that_leaves_clearly_less_takes_the_place_of_an_effect(
    monkeypatch, left, freedom, taken
):
    """Its rivals are asked for anew beside it, where a lag that rested elsewhere is tied with it."""

    def fitted(word, total, freedom=2):
        same = {"identify": total, "validate": None, "problem": ONE_AXIS}
        return SimpleNamespace(effects=("creep", word), total=total, freedom=freedom, **same)

    now, lower = fitted("amplifier_lag", 1.16), fitted("delay", left, freedom)
    fits = {"amplifier_lag": [lower], "delay": [fitted("sensor_lag", 0.99)], "creep": []}
    monkeypatch.setattr(exchange, "rivals_in_place", lambda case, now, effect, *_, **__: fits[effect])
    monkeypatch.setattr(exchange, "other_forms", lambda *arguments: [])
    monkeypatch.setattr(exchange, "fits_in_place", lambda *arguments, **_: [])
    monkeypatch.setattr(exchange, "adequate", lambda *arguments: True)
    monkeypatch.setattr(exchange, "in_its_limit", lambda *arguments: False)
    steps, told = [Step(now, "creep"), Step(now, "amplifier_lag")], []
    case = SimpleNamespace(floor=1.0, budget=Budget())
    exchange.find_rivals(case, SimpleNamespace(effects=()), steps, told.append)
    assert steps[-1].fit.effects == ("creep", taken) and told == steps[2:]
    assert {*steps[-1].tied} == ({"delay", "sensor_lag"} if taken == "delay" else {"amplifier_lag", "delay"})


@pytest.mark.parametrize(("own", "other", "taken"), [(1.0, 1.07, 0), (1.0, 1.04, 1), (1.06, 1.1, 1)])
def test_a_simpler_one_that_leaves_the_noise_is_tied_and_not_taken(monkeypatch, own, other, taken):
    words = "sensor_lag.second_order", "delay"
    now, simpler = (
        SimpleNamespace(
            effects=("creep", word), total=total, identify=total, validate=None, freedom=freedom, problem=ONE_AXIS
        )
        for word, total, freedom in zip(words, (own, other), (2, 1), strict=True)
    )
    fits = {"sensor_lag.second_order": [simpler]}
    monkeypatch.setattr(exchange, "look_alikes", lambda case, now, effect, *_: [effect])
    monkeypatch.setattr(exchange, "other_forms", lambda *arguments: [])
    monkeypatch.setattr(
        exchange, "fits_in_place", lambda case, now, effect, items, **_: fits.get(*items, []) if items else []
    )
    steps = [Step(now, "creep"), Step(now, words[0])]
    exchange.find_rivals(SimpleNamespace(floor=1.0, budget=Budget()), SimpleNamespace(effects=()), steps, repr)
    assert steps[-1].fit.effects == ("creep", words[taken])
    assert {*steps[-1].tied} == {*words}


@pytest.mark.parametrize(("lasting", "asked"), [(0, []), (1, ["creep"]), (2, ["creep", "delay"])])
def test_the_rivals_of_each_effect_are_asked_for_while_the_budget_lasts(monkeypatch, lasting, asked):
    now = SimpleNamespace(effects=("creep", "delay"), total=1.0, identify=1.0, freedom=2)
    left, tried = iter([True] * lasting + [False]), []
    monkeypatch.setattr(exchange, "rivals_in_place", lambda case, now, effect, *_, **__: tried.append(effect) or [])
    monkeypatch.setattr(exchange, "other_forms", lambda *arguments: [])
    monkeypatch.setattr(exchange, "fits_in_place", lambda *arguments: [])
    case = SimpleNamespace(floor=1.0, budget=SimpleNamespace(allows=lambda what, share: next(left)))
    exchange.find_rivals(case, SimpleNamespace(effects=()), [Step(now, "creep"), Step(now, "delay"), Step(now)], repr)
    assert tried == asked


def test_the_rivals_of_an_effect_that_is_alone_again_are_asked_for_anew(monkeypatch):
    def fitted(*effects, total=1.1):
        return SimpleNamespace(effects=effects, total=total, identify=total, freedom=3)

    alone, rival = fitted("sensor_lag"), fitted("delay", total=1.11)
    monkeypatch.setattr(exchange, "look_alikes", lambda case, now, effect, *_: ["delay"])
    monkeypatch.setattr(exchange, "fits_in_place", lambda case, now, effect, items, **_: [rival])
    case = SimpleNamespace(floor=1.0, budget=Budget())
    lone = [Step(alone, "sensor_lag", rivals={"sensor_lag": alone})]
    exchange.find_rivals(case, SimpleNamespace(effects=()), lone, None)
    assert lone[-1].tied == ("sensor_lag",)
    exchanged = [Step(rival, "delay"), Step(alone, "sensor_lag", "delay", {"sensor_lag": alone})]
    for steps in (exchanged, [*lone, Step(fitted("sensor_lag", "creep"), "creep"), Step(alone, None, "creep")]):
        exchange.find_rivals(case, SimpleNamespace(effects=()), steps, None)
        assert steps[-1].fit is alone and {"sensor_lag", "delay"} in [set(step.tied) for step in steps]


THIRD_ORDER = {"delay", "sensor_lag.third_order"}


@pytest.mark.parametrize(
    ("total", "freedom", "tied"), [(1.05, 3, {"delay"}), (1.05, 2, THIRD_ORDER), (1.5, 3, THIRD_ORDER)]
)
def test_a_form_that_may_contain_the_effect_is_no_exchange_but_a_tie_far_above_the_noise(
    monkeypatch, total, freedom, tied
):
    """And one of one more parameter is a tie at the noise as well."""

    def fitted(item, total, freedom=1):
        same = {"identify": total, "validate": None, "problem": ONE_AXIS}
        return SimpleNamespace(effects=("creep", item), total=total, freedom=freedom, **same)

    now, worse = fitted("delay", total), fitted("creep", 9)
    better = fitted("sensor_lag.third_order", total - 0.002, freedom)
    fits = {better.effects[-1]: better}

    def in_place(case, now, effect, items, **_):
        return [fits.get(item, worse) for item in items]

    monkeypatch.setattr(exchange, "fits_in_place", in_place)
    one_axis = {"words": ("bouc_wen",), "effects": (), "ruled_out": (), "records": [SimpleNamespace(axes="x")]}
    case = SimpleNamespace(floor=1.0, budget=Budget(), **one_axis)
    steps = [Step(now, "creep"), Step(now, "delay")]
    exchange.find_rivals(case, SimpleNamespace(effects=()), steps, None)
    assert set(steps[1].tied) == tied and len(steps) == 2


@pytest.mark.parametrize(("total", "taken"), [(1.5, "cross_coupling.voltage"), (1.6, "kinematic_coupling.voltage")])
def test_what_fits_as_a_form_of_the_effect_itself_does_keeps_its_name(monkeypatch, total, taken):
    own, other = (
        SimpleNamespace(effects=(word,), total=level)
        for word, level in (("cross_coupling.voltage", total), ("kinematic_coupling.voltage", 1.5))
    )
    monkeypatch.setattr(exchange, "other_forms", lambda case, now, effect: ["cross_coupling.voltage"])
    monkeypatch.setattr(exchange, "fits_in_place", lambda case, now, effect, items, **_: [own])
    named = exchange.under_own_name(SimpleNamespace(floor=1.0), None, "cross_coupling", other)
    assert named.effects == (taken,)


@pytest.mark.parametrize(
    ("effect", "tied", "asked"),
    [
        ("kinematic_coupling", (), ["cross_coupling"]),
        ("kinematic_coupling", ("cross_coupling.voltage",), ["cross_coupling", "cross_coupling.voltage"]),
        ("kinematic_coupling.voltage", (), ["cross_coupling", "cross_coupling.voltage"]),
    ],
)
def test_a_look_alike_is_asked_for_in_the_form_of_the_effect_and_that_in_which_it_was_tied(effect, tied, asked):
    case = SimpleNamespace(words=("bouc_wen",), effects=(), ruled_out=(), records=[SimpleNamespace(axes="xy")])
    assert exchange.look_alikes(case, SimpleNamespace(effects=(effect,)), effect, tied) == asked


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize(
    "names", [("kinematic_coupling", "cross_coupling"), ("cross_coupling.voltage", "kinematic_coupling.voltage")]
)
def test_of_two_names_of_a_model_that_nearest_to_the_reading_is_told_or_that_of_the_equation(monkeypatch, names, first):
    def fitted(word, total=1.1):
        return SimpleNamespace(effects=("creep", word), total=total, identify=total, freedom=3)

    now, twin, close = fitted(names[first]), fitted(names[1 - first]), fitted("amplitude_gain", 1.11)
    monkeypatch.setattr(exchange, "look_alikes", lambda *arguments: [])
    monkeypatch.setattr(exchange, "other_forms", lambda *arguments: [])
    monkeypatch.setattr(exchange, "fits_in_place", lambda *arguments, **_: [twin, close])
    monkeypatch.setattr(exchange, "is_tied", lambda *arguments: True)
    steps = [Step(now, names[first], "drift")]
    exchange.find_rivals(SimpleNamespace(floor=1.0, budget=Budget()), SimpleNamespace(effects=("creep",)), steps, repr)
    assert steps[-1].fit.effects[-1] == names[0]
    assert {*steps[-1].tied} == {*names, "amplitude_gain"}


@pytest.mark.parametrize(("total", "left"), [(5.02, ("creep", "friction", "drift")), (9.0, ("creep", "drift"))])
def test_a_rival_of_another_kind_is_one_as_long_as_it_fits_as_well_beside_what_was_added_later(
    monkeypatch, total, left
):
    now = SimpleNamespace(effects=("creep", "quadratic_gain"), total=5.0)
    rival = SimpleNamespace(effects=("quadratic_gain", "friction"), total=total)
    monkeypatch.setattr(exchange, "fits_in_place", lambda case, now, effect, items, **_: [rival] if items else [])
    steps = [Step(now), Step(now, "creep", rivals=dict.fromkeys(("creep", "friction", "drift"), now))]
    exchange.drop_outdone_rivals(SimpleNamespace(floor=1.0, budget=Budget()), now, steps)
    assert steps[1].tied == left


def test_what_scores_far_less_than_an_effect_is_not_refitted_in_its_place(monkeypatch):
    """The effect explains 80 % by its score, so what explains less than 24 % cannot take its place."""
    explained = {"creep": 0.8, "drift": 0.25, "sensor_lag": 0.23, "delay": 0.0}
    scorer = SimpleNamespace(score=lambda item: Score(item, explained[item]))
    now, without = SimpleNamespace(effects=("creep",), identify=2.0), SimpleNamespace(effects=())
    monkeypatch.setattr(exchange, "refit", lambda case, before, effects, guess: without)
    monkeypatch.setattr(exchange, "scorer_of", lambda case, fit: scorer)
    monkeypatch.setattr(exchange, "refit_beside", lambda case, fits, effects, guess, rival: effects)
    assert exchange.fits_in_place(None, now, "creep", ["drift", "sensor_lag", "delay"]) == [("drift",)]


@pytest.mark.parametrize("beside", ["creep", ""], ids=["tied beside the memory", "tied nowhere"])
def test_what_is_tied_beside_an_unproven_effect_is_a_rival_too(monkeypatch, beside):
    """Without the memory, creep fits worse than the lag in its place; with the memory as well."""

    def fitted(*effects, total):
        return SimpleNamespace(effects=effects, total=total, identify=total, validate=None)

    alone, doubted = fitted("sensor_lag", total=1.3), fitted("memory", "sensor_lag", total=1.1)
    delay = fitted("memory", "delay", total=1.2)
    creep = fitted("memory", "creep", total=1.15 if beside else 1.3)
    monkeypatch.setattr(exchange, "look_alikes", lambda case, now, effect, tied: ["delay", "creep"])
    monkeypatch.setattr(exchange, "fits_in_place", lambda case, now, effect, items, **_: [delay, creep])
    known = {"sensor_lag": alone, "delay": fitted("delay", total=1.4)}
    steps = [Step(alone), Step(doubted, "sensor_lag", rivals=known), Step(alone, None, "memory")]
    case = SimpleNamespace(floor=1.0, budget=Budget())
    exchange.add_rivals_beside(case, SimpleNamespace(effects=()), steps, doubted)
    together = {"sensor_lag": doubted, "delay": delay, "creep": creep}
    assert steps[1].rivals == (together if beside else known)


@pytest.mark.parametrize(("as_rivals", "guess", "total"), [(True, 3, 1.1), (True, 1, 2.0), (False, 3, 2.0)])
def test_a_rival_that_explains_as_much_by_its_score_is_started_elsewhere(monkeypatch, as_rivals, guess, total):
    def fitted(effects, total):
        return SimpleNamespace(effects=effects, total=total, identify=total, validate=None)

    score = {
        "sensor_lag": Score("sensor_lag", 0.8),
        "creep": Score("creep", 0.8, guesses=[dict.fromkeys(map(str, range(guess)), 0.0)]),
    }
    monkeypatch.setattr(exchange, "refit", lambda case, now, effects, guess: fitted(effects, 5.0))
    monkeypatch.setattr(exchange, "scorer_of", lambda case, fit: SimpleNamespace(score=score.get))
    monkeypatch.setattr(exchange, "refit_beside", lambda case, fits, effects, guess, rival: fitted(effects, 2.0))
    monkeypatch.setattr(exchange, "restart", lambda case, fit: fitted(fit.effects, 1.1))
    case, now = SimpleNamespace(floor=1.0, budget=Budget()), fitted(("sensor_lag",), 1.0)
    [fit] = exchange.fits_in_place(case, now, "sensor_lag", ["creep"], as_rivals)
    assert (fit.effects, fit.total) == (("creep",), total)


@pytest.mark.parametrize("share", [0.3, 0.65, 0.75])
def test_a_grating_of_which_the_stroke_holds_few_periods_is_named(share):
    """No curve of the reading that the catalogue has, and no memory, stands in for it."""
    stroke = np.ptp(stage.case({}).records[0].response)
    hidden = {"sine": 1e-7, "cosine": 6e-8, "pitch": share * stroke}
    named = {f"encoder_cyclic_error.{word}": value for word, value in hidden.items()}
    simulated = stage.case(named, model=("bouc_wen", "encoder_cyclic_error"))
    case = Case(("bouc_wen",), (), simulated.records, {})
    others = ("quadratic_gain", "cubic_stiffness", "saturation", "distributed_memory", "drift")
    found = improve(stage.considering(case, "encoder_cyclic_error", *others), first_fit(case, 0))
    assert found.last.verdict == "adequate" and found.end.effects == ("encoder_cyclic_error",)
    assert found.end.values["encoder_cyclic_error.pitch"] == pytest.approx(1e6 * share * stroke, rel=0.02)
