"""What a diagnosis and an improvement found, as their files say it."""

from types import SimpleNamespace

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis import caveats
from pzt_ident.diagnosis import staircase as stairs
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.suspect import Suspect
from pzt_ident.diagnosis.verdict import Diagnosis
from pzt_ident.job.schema import load_job
from pzt_ident.run import findings
from pzt_ident.run.improve import case_of
from pzt_ident.run.statement import Statement


@pytest.mark.parametrize("verdict", ["adequate", "unexplained", "refused"])
def test_an_improvement_says_what_it_added_and_what_it_suspects(verdict, monkeypatch):
    silent = {"stair": {}, "caveats": "", "narrow_bounds_sentence": "", "units_and_floors": {}, "limits_of": "10 V"}
    silent |= {"own_mechanics_sentence": "", "history_sentence": "", "refined_operator": ""}
    silent |= dict.fromkeys(("within_bounds_sentence", "beyond_known_sentence"), "")
    for name, nothing in silent.items():
        monkeypatch.setattr(findings, name, lambda *arguments, nothing=nothing: nothing)
    before, after = (
        SimpleNamespace(effects=effects, validate=None, total=1.0) for effects in (("drift",), ("drift", "creep"))
    )
    rival = SimpleNamespace(total=1.1)
    steps = [stairs.Step(before), stairs.Step(after, "creep", None, {"creep": after, "thermal_relaxation": rival})]
    job, case = SimpleNamespace(name="job", effects=("drift",)), SimpleNamespace(records=(), budget=Budget(), floor=1.0)
    doubted = Suspect("asymmetry.constant", 0.4, -0.02, before)
    staircase = stairs.Staircase(steps, after, [doubted])
    content = findings.improvement_of(job, case, staircase, {"verdict": verdict, "reason": "Nothing is missing."})
    assert (content["verdict"], content["effects"]) == (verdict, ["creep"])
    assert content["forms"] == {"creep": "spread"}
    (suspect,) = content["suspects"]
    assert (suspect["effect"], suspect["explained"]) == ("asymmetry", -0.02)
    assert suspect["why not"] in content["reason"]
    assert suspect["why not"].startswith(
        "asymmetry (constant) takes up 40 % of the misfit on the identification records and 0 % on the validation"
    )
    assert (
        "cannot tell creep from thermal_relaxation. No drive within 10 V tells them apart: allow more"
        in content["reason"]
    )
    rival.total = 1.0
    content = findings.improvement_of(job, case, staircase, {"verdict": verdict, "reason": ""})
    assert "No drive within 10 V tells them apart: these names are one model" in content["reason"]
    proposed = {"splits": ["creep", "thermal_relaxation"]}
    content = findings.improvement_of(job, case, staircase, {"verdict": verdict, "reason": ""}, proposed)
    assert "No drive" not in content["reason"] and content["next_experiment"] is proposed
    steps[1].rivals = {"creep": after}
    content = findings.improvement_of(job, case, staircase, {"verdict": verdict, "reason": ""})
    assert "cannot tell" not in content["reason"]


@pytest.mark.parametrize(
    ("effects", "left", "said"),
    [(("drift", "creep"), 4.0, True), (("drift", "creep"), 8.0, False), (("drift",), 4.0, False), ((), None, False)],
)
def test_a_model_that_predicts_better_and_is_not_proven_is_told(effects, left, said):
    fits = [SimpleNamespace(effects=words, validate=error) for words, error in ((effects, left), (("drift",), 10.0))]
    sentence = findings.prediction_sentence(SimpleNamespace(floor=1.0), [stairs.Step(fit) for fit in fits])
    assert (
        ("With `effects: [drift, creep]` the model leaves 4.0 instead of 10.0 noise floors" in sentence)
        == said
        == bool(sentence)
    )


def test_a_model_that_predicts_hardly_better_is_not_told():
    fits = [SimpleNamespace(effects=words, validate=error) for words, error in ((("drift", "creep"), 1.0), ((), 1.05))]
    assert findings.prediction_sentence(SimpleNamespace(floor=1.0), [stairs.Step(fit) for fit in fits]) == ""


def test_what_is_to_be_said_of_the_last_fit_is_said_once(monkeypatch, tmp_path):
    """Sentences on its bounds and on effects with an amount of each record, with a diagnosis and an improvement."""
    monkeypatch.setattr(caveats, "bounds_sentence", lambda fit: f" {fit.effects} ended on its bound.")
    job = load_job(stage.write(tmp_path, stage.case().records))
    case = case_of(Statement(job))
    fit = fit_at((), case.problem(()), np.full(case.problem(()).dimensions, 0.5))
    last = findings.diagnosis_of(job, case, Diagnosis("adequate", "The model is adequate.", fit, [], []), tmp_path)
    assert last["reason"].startswith("The model is adequate. () ended on its bound.")
    staircase = stairs.Staircase([stairs.Step(fit)], last)
    assert findings.improvement_of(job, case, staircase, last)["reason"].count("ended on its bound") == 1
    unfinished = {"verdict": "unfinished", "reason": "It did not come to its end."}
    assert findings.improvement_of(job, case, staircase, unfinished)["reason"].count("ended on its bound") == 1


def test_of_an_effect_that_was_exchanged_and_came_back_the_last_tie_is_told():
    lag, other = (SimpleNamespace(effects=(word,)) for word in ("amplifier_lag", "sensor_lag"))
    steps = [
        stairs.Step(lag, "amplifier_lag", None, {"amplifier_lag": lag, "sensor_lag": other}),
        stairs.Step(other, "sensor_lag", "amplifier_lag", {"sensor_lag": other}),
        stairs.Step(lag, "amplifier_lag", "sensor_lag", {"amplifier_lag": lag, "delay": other}),
    ]
    assert findings.ties(steps) == steps[2:]
