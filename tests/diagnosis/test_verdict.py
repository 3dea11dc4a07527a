"""What is said of a model: missing, a tie, adequate, unexplained, refused, and what these data cannot show."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import rig
import stage
from pzt_ident.diagnosis import refit
from pzt_ident.diagnosis.refit import first_fit
from pzt_ident.diagnosis.score import Score
from pzt_ident.diagnosis.verdict import Candidate, diagnose, doubted, drop, earns, sentence, settle
from pzt_ident.model.registry import blocks


def judged(made):
    return diagnose(made, first_fit(made, 0))


@cache
def missing(effect):
    made = stage.case(stage.EFFECTS[effect])
    return made, judged(made)


def decisions(found):
    return {item.score.effect: item.decision for item in found.candidates}


def of(found, effect):
    return next(item for item in found.candidates if item.score.effect == effect)


@pytest.mark.parametrize("effect", ["creep", "quadratic_gain"])
def test_what_is_missing_is_named_and_its_refit_is_at_the_noise_on_records_that_it_never_saw(effect):
    _, found = missing(effect)
    assert found.verdict == "missing"
    assert found.tied == [effect]
    assert found.reason.startswith(f"Missing: {effect}. It explains ")
    assert found.candidates[0].score.explained > 0.95
    best = found.candidates[0]
    assert best is found.best and best.score.effect == effect
    assert [item for item, said in decisions(found).items() if said == "missing"] == [effect]
    assert best.fit.identify == pytest.approx(stage.NOISE, rel=0.1)
    assert best.fit.validate == pytest.approx(stage.NOISE, rel=0.1)
    assert found.before.validate > 1.5 * best.fit.validate


def test_look_alikes_that_fit_hardly_worse_are_in_its_class():
    made = stage.case(stage.EFFECTS["amplifier_lag"], noise=1e-8)
    found = judged(made)
    assert {"amplifier_lag"} < set(found.tied) <= {"amplifier_lag", *blocks["amplifier_lag"].look_alikes}
    for word in found.tied[1:]:
        assert drop(of(found, word).fit.total, found.best.fit.total) < 0.4 * made.floor


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
    found = diagnose(wrong, fit)
    assert found.verdict == "unexplained"
    assert "on those to validate" in found.reason


def test_candidates_stand_best_first_and_each_once():
    _, found = missing("creep")
    rmse = [item.fit.total if item.fit else np.inf for item in found.candidates]
    assert rmse == sorted(rmse)
    words = [item.score.effect for item in found.candidates]
    assert len(set(words)) == len(words)


@pytest.mark.parametrize("seed", range(3))
def test_nothing_is_missing_at_the_noise(seed):
    found = judged(stage.case(seed=seed))
    assert found.verdict == "adequate"
    assert "leaves 1.0" in found.reason or "leaves 0.9" in found.reason
    assert found.best is None
    assert "missing" not in decisions(found).values()


def test_coloured_noise_is_no_effect():
    rng = np.random.default_rng(5)

    def coloured(record):
        return 0.5 * stage.NOISE * np.convolve(rng.normal(size=record.samples + 19), np.ones(20) / np.sqrt(20), "valid")

    found = judged(stage.with_response(stage.case(), coloured))
    assert found.verdict == "adequate"


def test_what_no_effect_explains_is_given_no_name():
    def strange(record):
        pattern = np.sign(np.sin(0.37 * record.drive[0]) + 0.3 * np.sin(np.pi * record.time**1.5))
        return 12 * stage.NOISE * pattern * (np.gradient(record.drive[0]) != 0)

    found = judged(stage.with_response(stage.case(), strange))
    assert found.verdict == "unexplained"
    assert "No effect of the catalogue explains what is left" in found.reason
    assert found.best is None


@pytest.mark.parametrize(("finest", "verdict"), [(8, "adequate"), (1, "refused")])
def test_what_a_shorter_step_would_change_is_blamed_on_no_effect(monkeypatch, finest, verdict):
    soft = {"lumped.mass": 1.0, "lumped.stiffness": 1e5, "lumped.damping": 30.0}  # 50 Hz, sampled at 200 Hz
    lag = stage.EFFECTS["amplifier_lag"]
    monkeypatch.setattr(refit, "FINEST", finest)
    found = judged(stage.case(lag | soft, soft, ["amplifier_lag"], ("bouc_wen", "lumped"), noise=1e-10))
    assert found.verdict == verdict
    assert ("halving its step" in found.reason) == (verdict == "refused")


def test_a_fit_that_has_not_converged_is_blamed_on_no_effect(monkeypatch):
    made = stage.case(stage.EFFECTS["creep"])
    monkeypatch.setattr(refit, "descend", lambda problem, point: point)
    found = judged(made)
    assert found.verdict == "refused"
    assert "do not agree" in found.reason and "bounds" in found.reason
    assert found.candidates == []


def test_where_one_start_reaches_the_noise_nothing_is_left_to_blame_on_the_search():
    made = stage.case()
    found = diagnose(made, replace(first_fit(made, 0), converged=False))
    assert found.verdict == "adequate"


LINEAR = {"bouc_wen.alpha": 0.0, "bouc_wen.beta": 0.01, "bouc_wen.gamma": 0.0}


def test_lags_before_and_behind_a_linear_stage_are_the_same_to_these_data():
    found = judged(stage.case(stage.EFFECTS["sensor_lag"] | LINEAR, LINEAR))
    assert found.verdict == "inconclusive"
    assert {"amplifier_lag", "sensor_lag"} <= set(found.tied)
    assert "these data cannot tell them apart" in found.reason
    assert all(word in found.reason for word in found.tied)
    assert "cannot be seen" not in [of(found, word).decision for word in found.tied]


def test_what_leaves_less_than_the_noise_at_its_strongest_cannot_be_seen():
    scores = (
        Score("delay", explained=0.5, power=0.1),
        Score("creep", explained=0.001, power=3.0),
        Score("drift", explained=0.1, power=3.0),
        Score("saturation", explained=0.9, power=3.0),
        Score("friction", explained=9.0, power=3.0),
    )
    items, made = [Candidate(score) for score in scores], stage.case()
    fit = first_fit(made, 0)
    settle(made, fit, fit, items)
    decided = ["cannot be seen", "not missing", "too small", "too small", "not missing"]
    assert [item.decision for item in items] == decided


def test_an_effect_that_helps_only_the_records_that_were_fitted_earns_nothing():
    made, found = missing("creep")
    before, after = found.before, found.best.fit
    assert earns(made, before, before, after)
    assert not earns(made, before, after, before)
    worse = refit.Fit(after.effects, after.problem, after.point, after.identify, 1.01 * before.validate)
    assert not earns(made, before, before, worse)
    alone = refit.Fit(after.effects, after.problem, after.point, after.identify, None)
    assert earns(made, before, before, alone)


def test_records_that_show_nothing_of_an_effect_leave_it_to_explain_all():
    made, found = missing("creep")
    before = replace(found.before, validate=made.floor)
    after = replace(before, identify=made.floor)
    assert earns(made, before, before, after)
    assert not earns(made, before, before, replace(after, identify=1.5 * made.floor))
    assert not earns(made, before, before, replace(after, validate=1.5 * made.floor))
    assert "show nothing of it" in sentence(made, before, before, replace(found.best, fit=after), ["creep"])
    assert "show nothing of it" not in found.reason


def test_a_drop_is_root_mean_square_and_has_a_sign():
    assert drop(5.0, 4.0) == pytest.approx(3)
    assert drop(4.0, 5.0) == pytest.approx(-3)
    assert drop(None, 4.0) == drop(4.0, None) == np.inf
    assert drop(4.0, np.inf) == -np.inf


def test_drives_of_one_level_only_leave_a_gain_that_grows_unseen():
    one = [np.tile(rig.triangle(100, 2, 60), 4), np.tile(rig.triangle(100, 2, 60), 3)]
    found = judged(stage.case(drives=one))
    assert of(found, "amplitude_gain").score.visibility < 0.05
    assert decisions(found)["amplitude_gain"] != "missing"


def test_a_look_alike_of_the_best_is_fitted_again_from_elsewhere():
    """A friction whose fit rests in a side minimum, beside plays that stand in for it; what is no look-alike stays."""
    loops = [np.concatenate([np.zeros(100), rig.path(0, top, 0, top, 0), np.zeros(150)]) for top in (100, 60)]
    hidden = {"friction.force": 0.25e-6, "friction.reach": 0.5e-6, "friction.stiction": 0.0, "friction.stribeck": 1e-6}
    simulated = stage.case(hidden, model=("bouc_wen", "friction"), drives=loops)
    made = refit.Case(("bouc_wen",), (), simulated.records, {})
    first = first_fit(made, 0)
    fits = {word: refit.refit(made, first, (word,), {}) for word in ("friction", "distributed_memory", "creep")}
    for word in ("friction", "creep"):
        resting = fits[word].problem
        null = resting.unit_point(first.values | {name: 0.0 for name in resting.names if name.startswith(word)})
        aside = refit.made((word,), resting, null)
        fits[word] = replace(aside, identify=fits["distributed_memory"].identify)
    items = [Candidate(Score(word, guess=dict.fromkeys(("one", "two"), 0.0)), fit) for word, fit in fits.items()]
    doubted(made, first, first, items)
    after = {item.score.effect: item.fit for item in items}
    assert after["friction"].identify == pytest.approx(stage.NOISE, rel=0.1)
    assert after["friction"].validate == pytest.approx(stage.NOISE, rel=0.1)
    assert after["creep"] is fits["creep"]
