"""What is hidden in the measurement that ships is named, added, and seen no more."""

import numpy as np
import pytest

import pzt_ident as pzt
from pzt_ident.api import diagnosis as diagnosing
from pzt_ident.api.diagnosis import _proposed
from pzt_ident.api.fit import Fit
from pzt_ident.api.refit import from_refit, restated
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.job.demo import hidden
from pzt_ident.run.events import verdict_line
from pzt_ident.run.improve import case_of

QUADRATIC, CREEP = "quadratic_gain", "creep"


@pytest.fixture(scope="module")
def diagnosis(fit):
    return pzt.diagnose(fit)


def test_the_diagnosis_names_a_hidden_effect(diagnosis, fit):
    assert diagnosis.verdict == "missing"
    assert diagnosis.missing == [QUADRATIC]
    best = diagnosis.candidates[0]
    assert best["rmse"]["identify"] == pytest.approx(0.02936, abs=1e-5)
    assert best["rmse"]["validate"] == pytest.approx(0.03431, abs=1e-5)
    assert fit.rmse == pytest.approx({"identify": 0.05656, "validate": 0.1111}, abs=5e-5)


def test_effects_added_by_hand_make_the_staircase(fit, improvement):
    for step, effect in zip(improvement.steps[1:], (QUADRATIC, CREEP), strict=True):
        before, fit = fit.rmse, fit.add(effect)
        assert step.added == effect
        assert all(fit.rmse[use] < before[use] for use in before)
        assert fit.rmse == pytest.approx(step.rmse, rel=0.01)
    assert fit.model.effects == (QUADRATIC, CREEP)


def test_improving_ends_at_the_noise_with_what_is_hidden(improvement):
    assert {item["effect"] for item in hidden()} == set(improvement.effects)
    assert improvement.verdict == "adequate"
    assert improvement.fit.rmse == pytest.approx({"identify": 0.005033, "validate": 0.004929}, abs=2e-6)
    assert improvement.fit.rmse["validate"] < 1.1 * improvement.fit.noise_floor["x"]
    assert np.std(improvement.fit.residuals["test"]) == pytest.approx(improvement.fit.rmse["validate"], rel=0.01)


def test_what_has_nothing_hidden_stays_as_it_is(improvement):
    assert pzt.diagnose(improvement.fit).missing == []
    assert pzt.diagnose(improvement.fit).verdict == "adequate"


def test_a_fit_that_other_starts_do_not_reach_is_diagnosed_itself(improvement, monkeypatch):
    """As given it leaves 1.03 noise floors, in the middle of all bounds far more."""
    fit = improvement.fit
    monkeypatch.setattr(
        diagnosing,
        "first_fit",
        lambda case, seed: fit_at(case.effects, case.problem(case.effects), np.full(fit.point.size, 0.5)),
    )
    found = pzt.diagnose(fit)
    assert found.content["rmse"] == pytest.approx(fit.rmse, rel=1e-9)
    assert found.verdict == "adequate"


def test_a_poor_fit_is_diagnosed_from_where_other_starts_end(fit, demo):
    train, test = (pzt.Record(*record) for record in demo)
    poor = pzt.identify("bouc_wen", train, validate=test, evaluations=20, polish=False)
    assert poor.rmse["identify"] > 1.5 * fit.rmse["identify"]
    assert pzt.diagnose(poor).content["rmse"]["identify"] == pytest.approx(fit.rmse["identify"], rel=0.01)


def test_what_is_restated_keeps_the_value_of_what_is_held(fit):
    bent = fit.model.with_effects([QUADRATIC])
    statement, _, sections = restated(fit, bent, settings={"bouc_wen.alpha": {"value": 0.25}})
    assert statement.job.parameters["bouc_wen.alpha"].value == 0.25
    assert sections["parameters"]["bouc_wen.alpha"] == {"value": 0.25}
    assert restated(fit, fit.model)[2]["parameters"] == fit.sections["parameters"]


def test_a_step_without_mechanics_is_a_fit_without_them(quick):
    fit = quick(model=pzt.Model("bouc_wen", "lumped"))
    case = case_of(fit.statement)
    problem = case.with_words(["bouc_wen"]).problem(())
    step = fit_at((), problem, np.full(problem.dimensions, 0.5))
    lean = Fit(*from_refit(fit, case, step))
    assert [*lean.model.blocks] == ["bouc_wen"]
    assert lean.rmse["identify"] == pytest.approx(step.identify * 1e6, rel=1e-9)


def test_the_next_drive_has_the_column_of_each_axis(tmp_path):
    (tmp_path / "next.csv").write_text("time [s],u_x [V],u_y [mV]\n0,1,10\n0.5,2,20\n", encoding="utf-8")
    proposal = {"file": "next.csv", "splits": ["creep", "drift"], "why": "creep follows the step"}
    found = _proposed({"next_experiment": proposal}, tmp_path)
    assert (found.splits, found.why) == (("creep", "drift"), "creep follows the step")
    assert found.t.tolist() == [0, 0.5]
    assert {axis: drive.tolist() for axis, drive in found.u.items()} == {"x": [1, 2], "y": [10, 20]}
    assert _proposed({"next_experiment": None}, tmp_path) is None


@pytest.mark.parametrize("form", [str, lambda item: item._repr_html_()])
def test_they_show_themselves(form, diagnosis, improvement):
    stairs = form(improvement)
    assert all(part in stairs for part in ("+ creep", "0.004929", "0.1111", "adequate", "identification [µm]"))
    assert all(
        part in form(diagnosis)
        for part in (QUADRATIC, "0.03431", "73\N{NO-BREAK SPACE}%", "not missing", "validation [µm]")
    )


def test_a_model_prints_its_effects_after_its_blocks():
    model = pzt.Model("bouc_wen", "lumped", effects=("creep", "drift"))
    assert str(model) == "bouc_wen -> lumped + creep + drift"


@pytest.mark.parametrize(
    ("verdict", "reason", "line"),
    [
        ("missing", "Missing: creep. It explains much.", "Missing: creep. It explains much."),
        ("adequate", "The model is adequate: it leaves little.", "The model is adequate: it leaves little."),
        ("unexplained", "No effect explains it.", "unexplained: No effect explains it."),
    ],
)
def test_a_verdict_is_said_once(verdict, reason, line):
    assert verdict_line(verdict, reason) == line
