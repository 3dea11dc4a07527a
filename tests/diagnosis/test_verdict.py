"""What is said of a model: missing, a tie, adequate, unexplained, refused, and what these data cannot show."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

import rig
import stage
from pzt_ident.diagnosis import budget, refit, starts, threads
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.candidates import decide_by_score, refit_all
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import removed_rms, removes_enough
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.forms import NOT_ALL, Candidate, contending_forms, least_score, refit_other_forms
from pzt_ident.diagnosis.look_alikes import restart_look_alikes
from pzt_ident.diagnosis.reasons import missing_sentence, nothing_explains
from pzt_ident.diagnosis.score import LEAST_SCORE, Score, Scorer
from pzt_ident.diagnosis.scores import score_all, worth_other_forms
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.ties import are_look_alikes
from pzt_ident.diagnosis.verdict import Diagnosis, diagnose, unexplained
from pzt_ident.engine import work
from pzt_ident.model.registry import blocks, word_of


def judged(case):
    return diagnose(case, first_fit(case, 0))


@cache
def missing(effect):
    case = stage.case(stage.EFFECTS[effect])
    return case, judged(case)


def decisions(diagnosis):
    return {item.score.effect: item.decision for item in diagnosis.candidates}


def of(diagnosis, effect):
    return next(item for item in diagnosis.candidates if item.score.effect == effect)


@pytest.mark.parametrize("effect", ["creep", "quadratic_gain"])
def test_what_is_missing_is_named_and_its_refit_is_at_the_noise_on_records_that_it_never_saw(effect):
    _, diagnosis = missing(effect)
    assert diagnosis.verdict == "missing"
    assert diagnosis.tied == [effect]
    assert diagnosis.reason.startswith(f"Missing: {effect}. It explains ")
    assert diagnosis.candidates[0].score.explained > 0.95
    best = diagnosis.candidates[0]
    assert best is diagnosis.best and best.score.effect == effect
    assert [item for item, decision in decisions(diagnosis).items() if decision == "missing"] == [effect]
    assert best.fit.identify == pytest.approx(stage.NOISE, rel=0.1)
    assert best.fit.validate == pytest.approx(stage.NOISE, rel=0.1)
    assert diagnosis.before.validate > 1.5 * best.fit.validate


def test_what_is_found_is_the_same_from_one_thread_and_from_three(monkeypatch):
    _, expected = missing("quadratic_gain")
    monkeypatch.setattr(threads, "THREADS", 3)
    found = judged(stage.case(stage.EFFECTS["quadratic_gain"]))
    assert np.array_equal(found.before.point, expected.before.point)
    assert [item.score for item in found.candidates] == [item.score for item in expected.candidates]
    assert np.array_equal(found.best.fit.point, expected.best.fit.point)


@pytest.mark.parametrize("share", [0.2, 0.4, 0.6])
def test_what_a_budget_suffices_for_is_the_same_from_one_thread_and_from_three(share, monkeypatch):
    monkeypatch.setattr(budget, "computing_time", lambda: 0.0)
    answers, before = [], work.done()
    possible = "creep", "drift", "thermal_relaxation", "quadratic_gain"
    judged(stage.considering(stage.case(stage.EFFECTS["creep"]), *possible))
    seconds = share * (work.done() - before)
    for number in (1, 3):
        monkeypatch.setattr(threads, "THREADS", number)
        case = stage.considering(stage.case(stage.EFFECTS["creep"]), *possible)
        case.budget = Budget(seconds)
        diagnosis = judged(case)
        fits = {item: fit.point.tolist() for entry in diagnosis.candidates for item, fit in entry.refits.items()}
        answers.append((diagnosis.verdict, case.budget.untried, fits))
    assert answers[0] == answers[1]
    assert answers[0][1]


def test_look_alikes_of_what_explains_nearly_all_are_compared_in_every_form_that_may_explain_as_much():
    case = stage.case({"sensor_lag.tau": 2e-3}, noise=1e-8)
    before = first_fit(case, 0)
    candidates = score_all(case, before, before, Scorer(case, before))
    named = next(item for item in candidates if item.score.effect == "sensor_lag")
    shortlist = refit_all(case, before, before, [named])
    tried = {*named.refits}
    refit_other_forms(case, before, before, candidates, shortlist)
    alike = [item for item in candidates if are_look_alikes("sensor_lag", item.score.effect)]
    assert {"amplifier_lag", "delay"} <= {word_of(item.score.effect) for item in shortlist}
    for candidate in alike:
        assert set(candidate.refits) == {item.effect for item in contending_forms(candidate)}
        assert {item.effect for item in candidate.forms if item.explained >= NOT_ALL} <= {*candidate.refits}
    assert shortlist == [named, *(item for item in alike if item.refits)]
    assert {*named.refits} == tried


@pytest.mark.parametrize("quiet", [True, False])
def test_an_effect_at_the_noise_is_not_tried_in_its_other_forms(quiet):
    case = stage.case({"sensor_lag.tau": 2e-3}, noise=1e-8)
    before = first_fit(case, 0)
    named = Candidate.of(Scorer(case, before).scores("sensor_lag"))
    shortlist = refit_all(case, before, before, [named])
    case.floor *= 1 if quiet else 0.5
    refit_other_forms(case, before, before, [named], shortlist)
    assert ({*named.refits} == {score.effect for score in named.forms}) is not quiet


def test_an_effect_that_explains_most_is_tried_in_its_other_forms_before_others_of_which_few_are_tried_then():
    made = stage.records({"saturation.knee": 0.004}, effects=["saturation"], forms=["saturation.cubic"])
    case = stage.considering(Case(("bouc_wen",), (), made, {}), "saturation", "quadratic_gain", "creep")
    before = first_fit(case, 0)
    candidates = sorted(score_all(case, before, before, Scorer(case, before)), key=lambda item: -item.score.explained)
    assert [item.score.effect for item in candidates][::2] == ["saturation", "creep"]
    assert LEAST_SCORE < candidates[2].score.explained < NOT_ALL
    refitted = []
    case.on_event = lambda event: refitted.append(event["effects"][-1])
    made = refit_all(case, before, before, candidates)
    assert refitted == ["saturation", "saturation.cubic", "quadratic_gain"]
    assert made == candidates[:2]
    assert made[0].refits["saturation"].identify > 3 * case.floor > 2.9 * made[0].refits["saturation.cubic"].identify


def test_where_no_effect_explains_most_all_that_scores_is_tried_in_every_form_the_short_list_first():
    case = stage.case(stage.EFFECTS["creep"])
    before = first_fit(case, 0)
    candidates = score_all(case, before, before, Scorer(case, before))
    shortlist = [item for item in candidates if item.score.effect in ("drift", "saturation")]
    for candidate in shortlist:
        candidate.refits = {candidate.score.effect: before}
    given = list(shortlist)
    refit_other_forms(case, before, before, candidates, shortlist)
    others = [item for item in candidates if item not in given and item.score.explained > LEAST_SCORE]
    assert others
    assert shortlist == [*given, *others]
    for candidate in shortlist:
        assert set(candidate.refits) == {score.effect for score in candidate.forms}


def test_look_alikes_that_fit_hardly_worse_are_in_its_class():
    case = stage.case(stage.EFFECTS["amplifier_lag"], noise=1e-8)
    diagnosis = judged(case)
    assert {"amplifier_lag"} < set(diagnosis.tied) <= {"amplifier_lag", *blocks["amplifier_lag"].look_alikes}
    for word in diagnosis.tied[1:]:
        assert removed_rms(of(diagnosis, word).fit.total, diagnosis.best.fit.total) < 0.4 * case.floor


def test_an_effect_that_leaves_much_may_stand_in_for_something_else():
    both = stage.case(stage.EFFECTS["quadratic_gain"] | stage.EFFECTS["creep"])
    assert "stands in for something else" in judged(both).reason
    assert "stands in" not in missing("quadratic_gain")[1].reason


def test_what_is_at_the_noise_of_its_own_records_alone_is_not_adequate():
    plain = stage.case()
    wrong = stage.with_response(
        plain, lambda record: 4 * stage.NOISE * np.sin(np.arange(record.samples)) * (record.use == "validate")
    )
    fit = first_fit(wrong, 0)
    assert fit.identify == pytest.approx(stage.NOISE, rel=0.1)
    diagnosis = diagnose(wrong, fit)
    assert diagnosis.verdict == "unexplained"
    assert "on the validation records" in diagnosis.reason


def test_candidates_stand_best_first_and_each_once():
    _, diagnosis = missing("creep")
    rmse = [item.fit.total if item.fit else np.inf for item in diagnosis.candidates]
    assert rmse == sorted(rmse)
    words = [item.score.effect for item in diagnosis.candidates]
    assert len(set(words)) == len(words)


def test_what_each_effect_explains_alone_is_known_beside_the_model_as_given():
    """The most that any diagnosis of it found, and nothing of what explains a rest beside others."""
    case = stage.considering(stage.case(stage.EFFECTS["quadratic_gain"]), "quadratic_gain", "creep")
    first = first_fit(case, 0)
    found = diagnose(case, first)
    assert {*case.shares} == {"quadratic_gain", "creep"}
    assert case.shares["quadratic_gain"] > 0.95 > 0.5 > case.shares["creep"]
    known = dict(case.shares)
    diagnose(case, found.best.fit, first)
    assert case.shares == known
    case.shares["creep"] = 0.6
    diagnose(case, first)
    assert case.shares == known | {"creep": 0.6}


@pytest.mark.parametrize("seed", range(3))
def test_nothing_is_missing_at_the_noise(seed):
    diagnosis = judged(stage.case(seed=seed))
    assert diagnosis.verdict == "adequate"
    assert "leaves an RMSE of 1.0" in diagnosis.reason or "leaves an RMSE of 0.9" in diagnosis.reason
    assert diagnosis.best is None
    assert "missing" not in decisions(diagnosis).values()


def test_coloured_noise_is_no_effect():
    rng = np.random.default_rng(5)

    def coloured(record):
        return 0.5 * stage.NOISE * np.convolve(rng.normal(size=record.samples + 19), np.ones(20) / np.sqrt(20), "valid")

    diagnosis = judged(stage.with_response(stage.case(), coloured))
    assert diagnosis.verdict == "adequate"


def test_what_no_effect_explains_is_given_no_name():
    def strange(record):
        pattern = np.sign(np.sin(0.37 * record.drive[0]) + 0.3 * np.sin(np.pi * record.time**1.5))
        return 12 * stage.NOISE * pattern * (np.gradient(record.drive[0]) != 0)

    diagnosis = judged(stage.with_response(stage.case(), strange))
    assert diagnosis.verdict == "unexplained"
    assert "No effect of the catalogue explains the remaining error" in diagnosis.reason
    assert diagnosis.best is None


@pytest.mark.parametrize(("finest", "verdict"), [(8, "adequate"), (1, "refused")])
def test_what_a_shorter_step_would_change_is_blamed_on_no_effect(monkeypatch, finest, verdict):
    soft = {"lumped.mass": 1.0, "lumped.stiffness": 1e5, "lumped.damping": 30.0}  # 50 Hz, sampled at 200 Hz
    lag = stage.EFFECTS["amplifier_lag"]
    monkeypatch.setattr(refit, "FINEST", finest)
    diagnosis = judged(stage.case(lag | soft, soft, ["amplifier_lag"], ("bouc_wen", "lumped"), noise=1e-10))
    assert diagnosis.verdict == verdict
    assert ("finer steps change" in diagnosis.reason) == (verdict == "refused")


def test_a_fit_that_has_not_converged_is_blamed_on_no_effect(monkeypatch):
    case = stage.case(stage.EFFECTS["creep"])
    monkeypatch.setattr(Case, "descend", lambda case, problem, point, *_, **__: point)
    monkeypatch.setattr(starts, "restart", lambda case, fit: replace(fit, identify=0.9 * fit.identify))
    diagnosis = judged(case)
    assert diagnosis.verdict == "refused"
    assert "do not agree" in diagnosis.reason and "bounds" in diagnosis.reason
    assert diagnosis.candidates == []


def test_where_one_start_reaches_the_noise_nothing_is_left_to_blame_on_the_search():
    case = stage.case()
    diagnosis = diagnose(case, replace(first_fit(case, 0), converged=False))
    assert diagnosis.verdict == "adequate"


LINEAR = {"bouc_wen.alpha": 0.0, "bouc_wen.beta": 0.01, "bouc_wen.gamma": 0.0}


def test_lags_before_and_behind_a_linear_stage_are_the_same_to_these_data():
    diagnosis = judged(stage.case(stage.EFFECTS["sensor_lag"] | LINEAR, LINEAR))
    assert diagnosis.verdict == "inconclusive"
    assert {"amplifier_lag", "sensor_lag"} <= set(diagnosis.tied)
    assert "these data cannot tell them apart" in diagnosis.reason
    assert all(word in diagnosis.reason for word in diagnosis.tied)
    assert "cannot be seen" not in [of(diagnosis, word).decision for word in diagnosis.tied]


def test_what_leaves_less_than_the_noise_at_its_strongest_cannot_be_seen():
    scores = (
        Score("delay", explained=0.5, power=0.1),
        Score("creep", explained=0.001, power=3.0),
        Score("drift", explained=0.1, power=3.0),
        Score("saturation", explained=0.9, power=3.0),
        Score("friction", explained=9.0, power=3.0),
    )
    items, case = [Candidate(score) for score in scores], stage.case()
    fit = first_fit(case, 0)
    decide_by_score(case, fit, fit, items)
    decided = ["cannot be seen", "not missing", "too small", "too small", "not missing"]
    assert [item.decision for item in items] == decided


def test_an_effect_that_helps_only_the_records_that_were_fitted_earns_nothing():
    case, diagnosis = missing("creep")
    before, after = diagnosis.before, diagnosis.best.fit
    assert removes_enough(case, before, before, after)
    assert not removes_enough(case, before, after, before)
    worse = Fit(after.effects, after.problem, after.point, after.identify, 1.01 * before.validate)
    assert not removes_enough(case, before, before, worse)
    alone = Fit(after.effects, after.problem, after.point, after.identify, None)
    assert removes_enough(case, before, before, alone)


def test_records_that_show_nothing_of_an_effect_leave_it_to_explain_all():
    case, diagnosis = missing("creep")
    before = replace(diagnosis.before, validate=case.floor)
    after = replace(before, identify=case.floor)
    assert removes_enough(case, before, before, after)
    assert not removes_enough(case, before, before, replace(after, identify=1.5 * case.floor))
    assert not removes_enough(case, before, before, replace(after, validate=1.5 * case.floor))
    assert "show nothing of it" in missing_sentence(case, before, before, after, ["creep"])
    assert "show nothing of it" not in diagnosis.reason


def test_a_drop_is_root_mean_square_and_has_a_sign():
    assert removed_rms(5.0, 4.0) == pytest.approx(3)
    assert removed_rms(4.0, 5.0) == pytest.approx(-3)
    assert removed_rms(None, 4.0) == removed_rms(4.0, None) == np.inf
    assert removed_rms(4.0, np.inf) == -np.inf


def test_drives_of_one_level_only_leave_a_gain_that_grows_unseen():
    one = [np.tile(rig.triangle(100, 2, 60), 4), np.tile(rig.triangle(100, 2, 60), 3)]
    diagnosis = judged(stage.case(drives=one))
    assert of(diagnosis, "amplitude_gain").score.visibility < 0.05
    assert decisions(diagnosis)["amplitude_gain"] != "missing"


def test_a_look_alike_of_the_best_is_fitted_again_from_elsewhere():
    """A friction whose fit rests in a side minimum, beside plays that stand in for it; what is no look-alike stays."""
    loops = [np.concatenate([np.zeros(100), rig.path(0, top, 0, top, 0), np.zeros(150)]) for top in (100, 60)]
    hidden = {"friction.force": 0.25e-6, "friction.reach": 0.5e-6, "friction.stiction": 0.0, "friction.stribeck": 1e-6}
    simulated = stage.case(hidden, model=("bouc_wen", "friction"), drives=loops)
    case = Case(("bouc_wen",), (), simulated.records, {})
    first = first_fit(case, 0)
    fits = {word: refit.refit(case, first, (word,), {}) for word in ("friction", "distributed_memory", "creep")}
    for word in ("friction", "creep"):
        resting = fits[word].problem
        null = resting.unit_point(first.values | {name: 0.0 for name in resting.names if name.startswith(word)})
        aside = fit_at((word,), resting, null)
        fits[word] = replace(aside, identify=fits["distributed_memory"].identify)
    items = [Candidate.of([Score(word, guesses=[dict.fromkeys(("one", "two"), 0.0)])]) for word in fits]
    for item, (word, fit) in zip(items, fits.items(), strict=True):
        item.refits = {word: fit}
        item.take(word)
    restart_look_alikes(case, first, first, items)
    after = {item.score.effect: item.fit for item in items}
    assert after["friction"].identify == pytest.approx(stage.NOISE, rel=0.1)
    assert after["friction"].validate == pytest.approx(stage.NOISE, rel=0.1)
    assert after["creep"] is fits["creep"]


def test_beside_other_effects_nothing_is_scored_once_the_budget_is_spent():
    case = stage.case(stage.EFFECTS["creep"])
    first = first_fit(case, 0)
    before = refit.refit(case, first, ("drift",), {})
    case.budget = Budget(0)
    assert score_all(case, first, before, Scorer(case, before)) == []
    assert "the scores of all effects" in case.budget.untried
    assert diagnose(case, before, first).verdict == "unexplained"
    assert score_all(case, first, first, Scorer(case, first))


def partly_spent(share):
    """A budget of which a share is spent, whatever the clock says."""
    budget = Budget(1e6)
    budget.spent = lambda limit: share >= limit
    return budget


def refitted_words(case, before, first, share):
    """The words of a short list of two that are refitted once a share of the budget is spent."""
    shortlist = [Candidate.of(Scorer(case, before).scores(word)) for word in ("quadratic_gain", "saturation")]
    case.budget = partly_spent(share)
    return {word_of(item.score.effect) for item in refit_all(case, first, before, shortlist)}


@pytest.mark.parametrize(("share", "refitted"), [(0.3, True), (0.75, True), (0.95, False)])
def test_what_promises_most_of_the_rest_is_refitted_while_effects_are_proven(share, refitted):
    case = stage.case(stage.EFFECTS["quadratic_gain"] | stage.EFFECTS["creep"])
    first = first_fit(case, 0)
    before = refit.refit(case, first, ("creep",), {})
    assert ("quadratic_gain" in refitted_words(case, before, first, share)) == refitted


def test_beside_what_explains_nearly_all_but_not_the_noise_time_is_kept_for_a_second_effect(monkeypatch):
    case = stage.case({"quadratic_gain.curvature": 3e-3, "amplifier_lag.tau": 2e-4}, noise=5e-10)
    first = first_fit(case, 0)
    assert refitted_words(case, first, first, 0.2) == {"quadratic_gain", "saturation"}
    assert refitted_words(case, first, first, 0.5) == {"quadratic_gain"}
    alone = stage.case({"quadratic_gain.curvature": 3e-3})
    given = first_fit(alone, 0)
    assert refitted_words(alone, given, given, 0.5) == {"quadratic_gain", "saturation"}


def test_beside_other_effects_other_forms_are_scored_while_the_budget_is_for_exploring():
    case = stage.case(stage.EFFECTS["creep"])
    first = first_fit(case, 0)
    before = refit.refit(case, first, ("drift",), {})
    for spent, most in ((0.5, 2), (0.7, 1)):
        case.budget = partly_spent(spent)
        found = score_all(case, first, before, Scorer(case, before))
        assert len(found) > 10 and min(2, max(len(item.forms) for item in found)) == most


def test_other_forms_are_asked_for_in_the_order_of_what_the_first_ones_explain():
    shares = {"creep": 0.1, "friction": 0.6, "drift": 0.3}
    candidates = {word: Candidate(Score(word, share, share)) for word, share in shares.items()}
    assert worth_other_forms(candidates) == ["friction", "drift", "creep"]


def test_beside_what_explains_nearly_all_only_its_look_alikes_are_scored_in_other_forms():
    case = stage.case(stage.EFFECTS["amplifier_lag"])
    before = first_fit(case, 0)
    forms = {item.score.effect: len(item.forms) for item in score_all(case, before, before, Scorer(case, before))}
    assert forms["amplifier_lag"] > 1 and forms["sensor_lag"] > 1
    assert forms["rate_dependence"] > 1, "it counts the lag among its look-alikes"
    assert {forms["amplitude_gain"], forms["saturation"], forms["encoder_cyclic_error"]} == {1}


@pytest.mark.parametrize(
    ("given", "left", "least"), [(20, 1.6, NOT_ALL), (20, 2.0, LEAST_SCORE), (2, 1.6, LEAST_SCORE)]
)
def test_beside_effects_whose_form_may_leave_all_of_a_rest_only_what_scores_much_of_it_is_refitted(given, left, least):
    """What takes up less of it cannot be proven."""
    first, before = (Fit((), None, np.zeros(1), error, None) for error in (given, left))
    assert least_score(SimpleNamespace(floor=1.0), first, before) == least


@pytest.mark.parametrize(
    ("effects", "begins"), [(("drift",), "drift explains"), (("drift", "creep"), "drift and creep explain")]
)
@pytest.mark.parametrize("shown", [False, True])
def test_what_proven_effects_explain_is_said_ahead_of_what_none_explains(effects, begins, shown):
    """shown: whether the validation records show what the others do not."""
    case, first = SimpleNamespace(floor=1.0), Fit((), None, np.zeros(1), 10.0, 10.0)
    end = Fit(effects, None, np.zeros(1), 2.0, 3.0)
    reason = "The model leaves what the validation records show." if shown else nothing_explains(case, end) + " More."
    said = unexplained(case, first, Diagnosis("unexplained", reason, end, [], [])).reason
    assert said.startswith(f"{begins} 97 % of the initial misfit{'. ' + reason if shown else ', and no effect'}")
    assert said.count("noise floors") == (0 if shown else 2) and said.endswith("show." if shown else " have. More.")
    assert unexplained(case, end, Diagnosis("unexplained", reason, end, [], [])).reason == reason
