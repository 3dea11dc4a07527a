"""An axis without a response is like the measured one until a coupling shows that it is not."""

from dataclasses import replace

import numpy as np
import pytest

import rig
import stage
from made_fits import CASE, fit
from pzt_ident.diagnosis import staircase, unmeasured
from pzt_ident.diagnosis.bounds import bounds_that_changed
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.climb import climb
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.forms import Candidate
from pzt_ident.diagnosis.possible import fits
from pzt_ident.diagnosis.refit import refit, values_in
from pzt_ident.diagnosis.score import Score
from pzt_ident.diagnosis.staircase import improve
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.step import Step
from pzt_ident.diagnosis.unlike import own_at_once
from pzt_ident.diagnosis.unmeasured import (
    OWN,
    OWN_LOOPS,
    freed_mechanics,
    own_hysteresis,
    own_mechanics,
    own_mechanics_sentence,
    with_own_hysteresis,
    with_own_mechanics,
)
from pzt_ident.diagnosis.verdict import diagnose
from pzt_ident.model.registry import blocks, word_of

DT, MODEL = 1e-3, ("bouc_wen", "lumped")
STIFFNESS = 5e4  # N/m of y, three times that of x: 92 against 53 Hz
X = stage.STAGE | {"lumped.mass": 0.15, "lumped.stiffness": 0.15 * (2 * np.pi * 53) ** 2, "lumped.damping": 6.0}
SHARE = 0.05  # of y in the reading of x


def chirp(low, high, reach, start):
    t = DT * np.arange(2500)
    return 50 + reach * np.sin(2 * np.pi * (low + (high - low) * t / t[-1] / 2) * t + start)


def coupled(stiffness, known=None, loops=None, model=MODEL, share=SHARE):
    """A stage whose y moves with this stiffness, and with hysteresis parameters of its own, and is not measured."""
    truth, noise, made = {f"x.{name}": value for name, value in X.items()}, np.random.default_rng(3), []
    truth |= {f"y.{name}": value for name, value in X.items()} | {"y.lumped.stiffness": stiffness}
    truth |= {f"y.{name}": value for name, value in (loops or {}).items()}
    truth |= {"x.kinematic_coupling.ratio": share, "y.kinematic_coupling.ratio": 0.0}
    for use, x, y in (
        ("identify", chirp(2, 20, 40, 0), chirp(20, 130, 30, 0)),
        ("identify", chirp(10, 90, 30, 1), chirp(1, 5, 40, 0)),
        ("validate", chirp(5, 60, 30, 0), chirp(30, 120, 35, 1)),
    ):
        response = rig.response([*model, "kinematic_coupling"], truth, x, y, dt=DT)[0]
        response += noise.normal(0, 5 * stage.NOISE, response.size)
        record = rig.record(x, y, response=[response, 0 * response], measured=[0], dt=DT)
        made.append(replace(record, use=use, name=f"{use} {len(made)}", response_units=("um", None)))
    mass = {"lumped.mass": X["lumped.mass"]} if model is MODEL else {}
    return Case(model, (), made, stage.specs(mass | (known or {})))


@pytest.mark.parametrize("stiffness", [STIFFNESS, 1.15 * X["lumped.stiffness"]])
def test_a_coupling_shows_the_stiffness_of_an_axis_without_a_response(stiffness, monkeypatch):
    """A resonance that is a little higher is no second mode of the measured axis; no path is climbed without it."""
    monkeypatch.setattr(staircase, "lean_or_begun", lambda *arguments: pytest.fail("climbed"))
    case = stage.considering(coupled(stiffness), "kinematic_coupling", "cross_coupling", "resonance")
    found = improve(case, first_fit(case, 0))
    end = found.steps[-1].fit
    assert found.last.verdict == "adequate" and [*map(word_of, end.effects)] == ["kinematic_coupling"]
    assert [step.change for step in found.steps] == ["", OWN, ""]
    assert end.values["y.lumped.stiffness"] == pytest.approx(stiffness, rel=0.01)
    assert "y.lumped.stiffness" in bounds_that_changed(case, end)
    assert f"y.lumped.stiffness is {str(stiffness)[0]}" in own_mechanics_sentence(case, end)


@pytest.mark.parametrize(
    ("stiffness", "effect", "shown"),
    [
        (STIFFNESS, "kinematic_coupling", True),
        (X["lumped.stiffness"], "kinematic_coupling", False),
        (STIFFNESS, "sensor_lag", False),
    ],
)
def test_a_coupling_beside_other_effects_shows_the_stiffness_of_an_axis_without_a_response(stiffness, effect, shown):
    """Where it leaves most of the misfit until that is free; without a coupling nothing shows it."""
    case = coupled(stiffness, share=2 * SHARE)
    first = first_fit(case, 0)
    known = {"kinematic_coupling.ratio": 2 * SHARE, "sensor_lag.tau": 1e-5}
    now = refit(case, first, (effect,), {name: value for name, value in known.items() if name.startswith(effect)})
    freed = freed_mechanics(case, now)
    assert (freed is not None) == shown
    if freed:
        own, fit = freed
        assert fit.effects == now.effects and fit.total < 1.1 * case.floor < now.total
        assert fit.values["y.lumped.stiffness"] == pytest.approx(stiffness, rel=0.01)
        assert freed_mechanics(own, fit) is None


def test_a_path_goes_on_with_the_mechanics_of_each_axis_that_its_coupling_shows():
    """A coupling that was taken with those of the measured axis needs no second effect for what they leave."""
    case = stage.considering(coupled(STIFFNESS, share=2 * SHARE), "kinematic_coupling", "resonance", "sensor_lag")
    first = first_fit(case, 0)
    fit = refit(case, first, ("kinematic_coupling",), {"kinematic_coupling.ratio": 2 * SHARE})
    taken = Candidate(Score("kinematic_coupling"), fit)
    path = climb(case, [Step(first)], diagnose(case, first), taken, lambda step: None)
    assert [step.change for step in path.steps] == ["", "", OWN] and path.last.verdict == "adequate"
    assert path.case.specs.keys() - case.specs.keys() == own_mechanics(case).keys()


@pytest.mark.parametrize(
    ("left", "shown_by", "steps"),
    [
        (1.2, ("cross_coupling",), [(None, None)]),
        (1.2, ("kinematic_coupling",), [("kinematic_coupling", "cross_coupling"), (None, None)]),
        (2.0, ("kinematic_coupling",), []),
        (1.2, (), []),
    ],
)
def test_near_the_noise_another_coupling_may_show_the_mechanics_of_an_axis(monkeypatch, left, shown_by, steps):
    """A coupling and a slew limit left 1.1 noise floors of the records that were fitted and 7.2 of the others; that of
    the readings, which had left as much, 0.9 of both with a resonance of y."""
    now, own = fit(left, 7.2, ["cross_coupling", "slew_limit"]), object()
    other = fit(left, 7.2, ["slew_limit", "kinematic_coupling"])

    def freed(case, fit):
        return (own, replace(fit, identify=1.0, validate=1.0)) if {*shown_by} & {*fit.effects} else None

    monkeypatch.setattr(unmeasured, "freed_mechanics", freed)
    monkeypatch.setattr(unmeasured, "own_mechanics", lambda case: {"y.lumped.stiffness": None})
    monkeypatch.setattr(unmeasured, "applicable", lambda case, effects: ["kinematic_coupling", "creep"])
    monkeypatch.setattr(
        unmeasured, "fits_in_place", lambda case, fit, effect, items: [other for item in items if item in other.effects]
    )
    found = unmeasured.mechanics_of_each_axis(CASE, fit(20.0, 20.0), now)
    assert [(step.added, step.removed) for step in found] == steps
    assert [step.case for step in found[-1:]] == [own] * bool(steps)
    assert unmeasured.mechanics_of_each_axis(CASE, fit(20.0, 20.0), fit(1.0, 1.0, ["cross_coupling"])) == []


@pytest.mark.parametrize(
    ("stiffness", "share", "at_once"),
    [
        (STIFFNESS, SHARE, True),
        (1.15 * X["lumped.stiffness"], 2 * SHARE, True),
        (X["lumped.stiffness"], 4 * SHARE, False),
        (STIFFNESS, 0.0, False),
    ],
)
def test_an_own_resonance_is_looked_for_ahead_of_second_effects_where_a_coupling_falls_short(stiffness, share, at_once):
    """Where none passes, or one that leaves more than the noise; not where one reaches that as it is, nor where nothing
    is missing."""
    case = stage.considering(coupled(stiffness, share=share), "kinematic_coupling", "cross_coupling", "resonance")
    first, told = first_fit(case, 0), []
    found = own_at_once(case, first, diagnose(case, first), told.append)
    assert (found is not None) == at_once == bool(told)
    assert with_own_mechanics(case, first) is with_own_mechanics(case, first)  # sought once
    if found:
        assert [step.change for step in found.steps] == ["", OWN, ""] and found.last.verdict == "adequate"


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_a_coupling_shows_the_hysteresis_of_an_axis_without_a_response(share):
    """It is no second coupling, by the voltage."""
    case = coupled(STIFFNESS, loops={"bouc_wen.alpha": 0.3}, model=("bouc_wen",), share=share)
    found = improve(case, first_fit(stage.considering(case, "kinematic_coupling", "cross_coupling", "creep"), 0))
    end = found.steps[-1].fit
    assert found.last.verdict == "adequate" and [*map(word_of, end.effects)] == ["kinematic_coupling"]
    assert [step.change for step in found.steps] == ["", OWN_LOOPS, ""]
    assert "y.bouc_wen.alpha" in bounds_that_changed(case, end)
    assert "y.bouc_wen.gamma are its own" in own_mechanics_sentence(case, end)


def test_a_hysteresis_of_its_own_has_the_shapes_that_the_measured_axis_has_free():
    case = coupled(STIFFNESS, {"bouc_wen.gamma": stage.STAGE["bouc_wen.gamma"], "y.bouc_wen.beta": 0.02})
    first = fit_at((), case.problem(()), np.full(case.problem(()).dimensions, 0.5))
    assert [*own_hysteresis(case, first)] == ["y.bouc_wen.alpha"]
    fit = with_own_hysteresis(case, first)[1]
    assert fit.values["y.bouc_wen.alpha"] == pytest.approx(first.values["bouc_wen.alpha"])
    assert fit.identify == pytest.approx(first.identify, rel=1e-9)
    other = [replace(record, drive_units=("V", "kV")) for record in case.records]
    assert own_hysteresis(case.with_records(other), first) == {}


def test_an_axis_that_is_like_the_measured_one_is_taken_for_it():
    case = stage.considering(coupled(X["lumped.stiffness"]), "kinematic_coupling", "cross_coupling", "resonance")
    found = improve(case, first_fit(case, 0))
    assert {*map(word_of, found.steps[-1].fit.effects)} <= {"kinematic_coupling", "cross_coupling"}
    assert bounds_that_changed(case, found.steps[-1].fit) == {}
    assert own_mechanics_sentence(case, found.steps[-1].fit) == ""


@pytest.fixture(scope="module")
def beside():
    """A stage with an axis of each kind, and its fit with a coupling."""
    case = coupled(STIFFNESS)
    problem = case.problem(("cross_coupling",))
    return case, fit_at(("cross_coupling",), problem, np.full(problem.dimensions, 0.5))


@pytest.mark.parametrize("item", [item for word in blocks.effects() for item in blocks.forms(word)])
@pytest.mark.parametrize("measured_only", [False, True])
def test_from_any_effect_on_either_axis_a_model_without_it_is_gone_on_with(beside, item, measured_only):
    case, fit = beside
    if not fits(case, fit.effects, item):
        return
    problem = case.problem((*fit.effects, item), fit.steps, measured_only)
    ended = fit_at((*fit.effects, item), problem, np.full(problem.dimensions, 0.4), measured_only=measured_only)
    assert values_in(fit.problem, ended).keys() >= {*fit.problem.names}


@pytest.mark.parametrize(
    ("said", "free"),
    [
        ("y.lumped.stiffness", []),
        ("y.lumped.damping", ["y.lumped.stiffness"]),
        ("x.lumped.stiffness", ["y.lumped.stiffness", "y.lumped.damping"]),
        ("lumped.stiffness", ["y.lumped.stiffness", "y.lumped.damping"]),
    ],
)
def test_what_the_job_says_of_that_axis_holds(said, free):
    """A stage with one measured axis has its names without an axis, too."""
    assert [*own_mechanics(coupled(STIFFNESS, {said: 1.0}))] == free
