"""Mechanics that slow data do not determine are left out where they stand in for effects."""

from types import SimpleNamespace

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis import lean, staircase, undetermined, verdict
from pzt_ident.diagnosis.bounds import Widened
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.paths import Begun
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.step import Step
from pzt_ident.diagnosis.undetermined import (
    enough_without_mechanics,
    undetermined_axes,
    undetermined_mechanics,
    unseen_mechanics,
    without_mechanics,
)
from pzt_ident.model.registry import blocks

SEVERAL = stage.EFFECTS["creep"] | stage.EFFECTS["sensor_lag"] | stage.EFFECTS["quadratic_gain"]
BLOCKS = ("bouc_wen", "lumped")
POSSIBLE = ("creep", "sensor_lag", "quadratic_gain", "delay", "amplifier_lag", "saturation", "viscous_damping")


def slow(parameters, fixed=None):
    """A stage without mechanics, and a model that has some."""
    case = stage.case(parameters, fixed)
    return case.with_words(BLOCKS)


def test_slow_loops_determine_at_most_one_number_of_a_mode():
    assert undetermined_mechanics(first_fit(slow(stage.EFFECTS["sensor_lag"]), 0)) == "lumped"


def test_what_the_data_determine_is_asked_of_the_samples_once_a_fit(monkeypatch):
    fit, asked = first_fit(slow(stage.EFFECTS["sensor_lag"]), 0), []
    samples = fit.problem.samples
    monkeypatch.setattr(fit.problem, "samples", lambda point: asked.append(point) or samples(point))
    once = undetermined_mechanics(fit), len(asked)
    assert (undetermined_mechanics(fit), len(asked)) == once and asked


def test_mechanics_that_the_job_knows_are_kept():
    known = slow(stage.EFFECTS["sensor_lag"], {"lumped.mass": 0.15})
    assert undetermined_mechanics(first_fit(known, 0)) is None


def fast(drive, steps=1):
    return stage.case(model=BLOCKS, drives=[drive, 0.8 * drive], dt=2e-5, steps=steps)


RINGING = np.repeat([0.0, 40.0, 10.0, 60.0, 0.0], 200)
SMOOTH = 5 - 5 * np.cos(np.linspace(0, np.pi, RINGING.size))


def test_a_mode_that_rings_is_determined():
    assert undetermined_mechanics(first_fit(fast(RINGING), 0)) is None


def test_mechanics_that_one_axis_shows_are_kept():
    """Beside one that hardly moves."""
    fit = first_fit(stage.beside(fast(RINGING), fast(1e-3 * SMOOTH)), 0)
    assert undetermined_axes(fit) == {1}
    assert undetermined_mechanics(fit) is None


def test_mechanics_that_take_up_nothing_are_no_suspect():
    case = slow({})
    assert without_mechanics(case, first_fit(case, 0)) is None


def test_effects_are_named_in_the_place_of_mechanics_that_stand_in_for_them():
    case, reported = slow(SEVERAL), []
    case.ruled_out = tuple({*blocks.effects()} - {*POSSIBLE})
    found = staircase.improve(case, first_fit(case, 0), reported.append)
    assert [step.change for step in found.steps[:2]] == ["", "without lumped"]
    assert found.last.verdict == "adequate"
    assert found.case.words == ("bouc_wen",)
    assert found.steps[1] in reported
    assert found.suspects[-1].effect == "lumped"
    assert "lumped takes up" in found.suspects[-1].why_not


@pytest.mark.parametrize("beside", [None, "lumped"])
def test_mechanics_that_are_determined_beside_the_best_effect_are_kept(monkeypatch, beside):
    """A misfit that an effect explains had hidden what the data say of them."""
    case = slow(SEVERAL)
    first = first_fit(case, 0)
    diagnosis, tried = verdict.diagnose(case, first), []
    best = min(diagnosis.passing, key=lambda item: item.fit.total).fit
    monkeypatch.setattr(lean, "unseen_mechanics", lambda fit: beside if fit is best else "lumped")
    monkeypatch.setattr(lean, "without_mechanics", lambda case, first: tried.append(case))
    assert lean.alternative_to(case, first, diagnosis) is None
    assert bool(tried) == (beside is not None)


SOFT = {"lumped.mass": Widened((1e3, 1e4)), "lumped.stiffness": Widened((1e5, 1e6))}


def test_where_nothing_is_missing_without_mechanics_nothing_is_named():
    """The bounds of the job have no mechanics as stiff as those of the stage."""
    case = slow({}).with_specs(SOFT)
    first = first_fit(case, 0)
    assert first.total > 2 * case.floor
    found = staircase.improve(case, first)
    assert [step.change for step in found.steps] == ["", "without lumped"]
    assert found.last.verdict == "adequate" and found.case.words == ("bouc_wen",)


@pytest.mark.parametrize("case", [slow(stage.EFFECTS["creep"]), slow({}, {"lumped.mass": 5.0})], ids=["creep", "known"])
def test_where_something_is_missing_without_them_or_they_are_known_they_are_kept(case):
    assert enough_without_mechanics(case.with_specs(SOFT | case.specs), first_fit(case, 0)) is None


@pytest.mark.parametrize("effects", [("cubic_stiffness",), ("load_mass",)])
def test_mechanics_that_an_effect_of_the_job_acts_in_are_kept(effects):
    case = slow(stage.EFFECTS["sensor_lag"])
    case.effects = effects
    assert without_mechanics(case, first_fit(case, 0)) is None


MODE = {"resonance.share": 0.8, "resonance.frequency": 3438.0, "resonance.damping": 0.011}
KNOWN = stage.STAGE | {"bouc_wen.gain": 0.082}  # um/V
ELSEWHERE = KNOWN | {"lumped.mass": 10.0, "lumped.damping": 3e3}


def fit_at_values(case, effects, values):
    problem = case.problem(effects)
    return fit_at(effects, problem, problem.unit_point({name: values[name] for name in problem.names}))


@pytest.mark.parametrize("form", [item for item in blocks.forms("resonance") if not item.endswith("voltage")])
def test_a_second_mode_without_mechanics_is_that_of_the_mechanics(form):
    case = fast(RINGING, steps=8)
    end = fit_at_values(case.with_words(["bouc_wen"]), (form,), KNOWN | MODE)
    found = lean.with_mechanics_moved(case, fit_at_values(case, (), ELSEWHERE), end, lambda step: None)
    assert [step.change for step in found.steps] == ["", lean.MOVED]
    assert found.end.effects == () and found.last.verdict == "adequate"


def test_effects_beside_that_mode_are_kept():
    case = fast(RINGING, steps=8)
    bent = stage.with_response(case, lambda record: 1e-2 * record.response**2 / np.ptp(record.response))
    values = KNOWN | MODE | {"quadratic_gain.curvature": 3e-4}
    end = fit_at_values(bent.with_words(["bouc_wen"]), ("quadratic_gain", "resonance"), values)
    found = lean.with_mechanics_moved(bent, fit_at_values(bent, (), ELSEWHERE), end, lambda step: None)
    assert [(step.added, step.change) for step in found.steps] == [
        (None, ""),
        (None, lean.MOVED),
        ("quadratic_gain", ""),
    ]


def test_a_mode_beside_a_stiff_stage_is_a_second_one():
    second = MODE | {"resonance.share": 0.3}
    case = stage.case(second, model=("bouc_wen", "resonance"), drives=[RINGING, 0.8 * RINGING], dt=2e-5)
    given = case.with_words(BLOCKS)
    end = fit_at_values(case.with_words(["bouc_wen"]), ("resonance",), KNOWN | second)
    assert end.total < 1.5 * case.floor
    assert lean.with_mechanics_moved(given, fit_at_values(given, (), ELSEWHERE), end, lambda step: None) is None


def verdict_of(word):
    return verdict.Diagnosis(word, "", None, [], [])


@pytest.mark.parametrize(
    ("without", "beside", "taken"),
    [("adequate", "adequate", "lean"), ("unexplained", "adequate", "given"), ("unexplained", "unexplained", "lean")],
)
def test_the_first_path_with_mechanics_is_taken_where_it_alone_reaches_the_noise(monkeypatch, without, beside, taken):
    """Before those without them are gone on with: what is left is then for its proof."""
    case, begun, led = slow(SEVERAL), [], SimpleNamespace(end=SimpleNamespace(total=0.0), last=None)
    first = first_fit(case, 0)
    path = SimpleNamespace(last=verdict_of(without))
    other = lean.Lean(lean.Alternative("lumped", case, first), [Step(first)], Begun(None, path))
    given = SimpleNamespace(end=first, last=verdict_of(beside), steps=[Step(first)], case=None)
    led.last = verdict_of("adequate" if without == "adequate" else "unexplained")

    def begin(case, base, on_step, diagnosis):
        begun.append(case)
        return Begun(diagnosis, given)

    for word in (
        "beyond_bounds",
        "fit_behind",
        "bounds_beside",
        "own_at_once",
        "own_account",
        "enough_without_mechanics",
    ):
        monkeypatch.setattr(staircase, word, lambda *arguments: None)
    monkeypatch.setattr(lean, "alternative_to", lambda *arguments: other.alternative)
    monkeypatch.setattr(lean, "begin_lean", lambda *arguments: other)
    monkeypatch.setattr(lean, "begin", begin)
    monkeypatch.setattr(lean, "improve_lean", lambda *arguments: led)
    monkeypatch.setattr(staircase, "improve_within", lambda *arguments: arguments[-1].path)
    monkeypatch.setattr(staircase, "with_least_bounds", lambda case, path: path)
    found = staircase.improve_judged(case, first, lambda step: None, SimpleNamespace(account=None))
    assert found is (led if taken == "lean" else given)
    assert len(begun) == (without != "adequate")


@pytest.mark.parametrize(("share", "ratio", "seen"), [(0.4, 0.25, True), (0.4, 0.35, False), (0.6, 0.25, False)])
def test_mechanics_that_ring_in_no_record_are_tried_without_like_those_that_the_data_do_not_determine(
    monkeypatch, share, ratio, seen
):
    """share: of the sampling rate, beyond half of which the samples show another frequency."""
    monkeypatch.setattr(undetermined, "undetermined_mechanics", lambda fit: None)
    case = fast(RINGING, steps=8)
    mass, pace = 0.02, 2 * np.pi * share / case.records[0].dt
    there = KNOWN | {"lumped.mass": mass, "lumped.stiffness": mass * pace**2, "lumped.damping": 2 * ratio * mass * pace}
    fit = fit_at_values(case, (), there)
    assert unseen_mechanics(fit) == (None if seen else "lumped")
    begun = []
    monkeypatch.setattr(lean, "without_mechanics", lambda case, first: begun.append(first))
    diagnosis = SimpleNamespace(verdict="unexplained", passing=[])
    assert lean.alternative_to(case, fit, diagnosis) is None
    assert bool(begun) != seen


@pytest.mark.parametrize(
    ("alike", "shown", "lasts"),
    [(True, False, True), (False, False, True), (False, False, False), (False, True, True)],
)
def test_two_effects_that_account_for_all_beside_mechanics_are_tried_without_these_at_once(
    monkeypatch, alike, shown, lasts
):
    """A path without mechanics is climbed for them only where they do not account for all there, behind the one with
    them, if that does not show the mechanics and leaves time."""
    case, climbed = slow(stage.EFFECTS["creep"] | stage.EFFECTS["quadratic_gain"]), []
    case.ruled_out = tuple({*blocks.effects()} - {*POSSIBLE})
    first, begin = first_fit(case, 0), lean.begin
    diagnosis = verdict.diagnose(case, first)
    assert {*diagnosis.account.effects} == {"creep", "quadratic_gain"}

    def counted(case, *more):
        climbed.append(case.words)
        return begin(case, *more)

    monkeypatch.setattr(lean, "begin", counted)
    monkeypatch.setattr(lean, "unseen_mechanics", lambda fit: None if shown and len(fit.effects) > 1 else "lumped")
    if not alike:
        adequate = lean.adequate
        monkeypatch.setattr(lean, "adequate", lambda case, *fits: case.words == BLOCKS and adequate(case, *fits))
        monkeypatch.setattr(case.budget, "allows", lambda what, *share: lasts or "without" not in what)
    found, begun = lean.lean_or_begun(case, first, diagnosis, lambda step: None)
    assert climbed == ([] if alike else [BLOCKS, ("bouc_wen",)] if lasts and not shown else [BLOCKS])
    assert (found is not None) == (lasts and not shown) and (begun is not None) == (not alike)
    end = found.end if found else begun.path.end
    assert {*end.effects} == {"creep", "quadratic_gain"}
