"""How drives go between their samples is felt by mechanics and delays, and is no effect of the stage."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import rig
import stage
from pzt_ident.diagnosis import drive_shape, scores, staircase
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.climb import Staircase
from pzt_ident.diagnosis.drive_shape import LINEAR as ON_LINES
from pzt_ident.diagnosis.drive_shape import SMOOTH, better_as_usual, other_behind, reshaped, with_other_drives
from pzt_ident.diagnosis.forms import Candidate
from pzt_ident.diagnosis.score import Score
from pzt_ident.diagnosis.staircase import improve
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.step import Step
from pzt_ident.diagnosis.verdict import Diagnosis
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks, word_of

RATE, LINES = 200.0, 90  # of 100 up to the Nyquist frequency
GAIN = 1e-7  # m/V


def multisine(seed, size=10.0):
    """A period of a drive with lines close to its Nyquist frequency: amplitudes and phases of each."""
    phases = np.random.default_rng(seed).uniform(0, 2 * np.pi, LINES)
    return size * np.exp(1j * phases) / np.sqrt(LINES)


def of_lines(lines, samples=200, delay=0.0):
    spectrum = np.zeros(samples // 2 + 1, complex)
    turns = 2j * np.pi * np.arange(1, LINES + 1) * RATE / samples
    spectrum[1 : LINES + 1] = lines * np.exp(-turns * delay) * samples / 2
    return np.fft.irfft(spectrum, samples)


def records(delay, noise=2e-9):
    """A stage without hysteresis that follows smooth drives late."""
    made, random = [], np.random.default_rng(5)
    for seed, use in enumerate(("identify", "identify", "validate")):
        lines = multisine(seed)
        late = GAIN * of_lines(lines, delay=delay)
        blank = rig.record(of_lines(lines), response=[late + random.normal(0, noise, late.size)], dt=1 / RATE)
        made.append(replace(blank, use=use, name=f"{use} {seed}", run_in=1, response_units=("um",)))
    return made


LINEAR = stage.specs({"bouc_wen.alpha": 0.0, "bouc_wen.beta": 1.0, "bouc_wen.gamma": 0.0})


@pytest.mark.parametrize("delay", [1e-3, 6.3e-3])
def test_a_smooth_periodic_drive_arrives_late_as_its_fourier_series_does(delay):
    record = replace(records(delay, noise=0.0)[0], steps=8)
    chain = Chain(blocks.chain(("bouc_wen", "delay")), ("x",), (0,))
    values = {"bouc_wen.gain": GAIN, "bouc_wen.alpha": 0.0, "bouc_wen.beta": 1.0, "bouc_wen.gamma": 0.0}
    theta = np.array([[(values | {"delay.time": delay})[name] for name in chain.names]])
    errors = [np.std(Simulator(chain, each).errors(theta)) for each in (record, replace(record, smooth_drive=True))]
    late = np.std(record.response)
    assert errors[0] > 0.2 * late
    assert errors[1] < 0.03 * late  # lines between the eight steps of a sample


@pytest.mark.parametrize("effect", ["delay", None])
def test_a_delay_of_smooth_drives_is_named_and_nothing_for_the_lines_between_samples(effect):
    case = Case(("bouc_wen",), (), records(3e-3 if effect else 0.0), LINEAR)
    found = improve(case, first_fit(case, 0))
    end = found.steps[-1].fit
    assert [*map(word_of, end.effects)] == ([effect] if effect else [])
    assert (SMOOTH in [step.change for step in found.steps]) == bool(effect)
    assert all(bool(record.smooth_drive) == bool(effect) for record in end.problem.records)


@pytest.mark.parametrize("explained", [0.9, 0.4])
def test_smooth_drives_are_looked_for_behind_the_likeliest_effect_ahead_of_a_diagnosis(monkeypatch, explained):
    """explained: by the score of an effect; what explains less than half of the misfit has none."""
    case = Case(("bouc_wen",), (), records(3e-3), LINEAR)
    first, asked = first_fit(case, 0), []
    scored = [Candidate(Score("sensor_lag", explained_in_bounds=explained)), Candidate(Score("drift"))]
    monkeypatch.setattr(scores, "score_all", lambda *arguments, **more: scored)
    monkeypatch.setattr(staircase, "with_other_drives", lambda *arguments: None)
    monkeypatch.setattr(staircase, "other_behind", lambda case, first, best: asked.append(best) or (best and "smooth"))
    monkeypatch.setattr(staircase, "improve_otherwise", lambda *arguments: "smooth")
    monkeypatch.setattr(staircase, "diagnose", lambda *arguments: Diagnosis("refused", "", first, [], []))
    monkeypatch.setattr(
        staircase,
        "improve_judged",
        lambda *arguments: Staircase([Step(first)], Diagnosis("adequate", "", first, [], [])),
    )
    found = staircase.improve_as_usual(case, first, lambda step: None)
    assert (found == "smooth") == (explained > 0.5)
    assert [fit and fit.effects for fit in asked] == [("sensor_lag",) if explained > 0.5 else None]


def test_drives_that_are_linear_between_samples_stay_so():
    """Lines between samples, late by half of one, are no smooth curve that is late."""
    lines = records(0.0)
    late = [replace(each, response=(each.response + np.roll(each.response, 1, axis=1)) / 2) for each in lines]
    case = Case(("bouc_wen",), (), late, LINEAR)
    assert with_other_drives(case, first_fit(case, 0)) is None


@pytest.mark.parametrize(("identify", "validate", "taken"), [(0.8, 0.8, True), (1.01, 0.5, False), (0.5, 1.01, False)])
def test_what_is_worse_on_one_kind_of_record_is_no_better_shape(monkeypatch, identify, validate, taken):
    case = Case(("bouc_wen",), (), records(3e-3), LINEAR)
    given = SimpleNamespace(total=1.0, effects=(), by_use=np.ones((2, 1)), identify=20 * case.floor, validate=None)
    left = np.array([[identify], [validate]])
    after = SimpleNamespace(total=np.sqrt(np.mean(left**2)), by_use=left)
    monkeypatch.setattr(drive_shape, "refit", lambda home, *more: after if home.records[0].smooth_drive else given)
    assert bool(with_other_drives(case, given)) == taken


@pytest.mark.parametrize(("left", "better"), [(0.5, True), (1.0, False), (2.0, False)])
def test_drives_on_lines_are_gone_back_to_where_the_last_model_leaves_less_so(monkeypatch, left, better):
    case = Case(("bouc_wen",), (), records(3e-3), LINEAR)
    end = replace(first_fit(case, 0), identify=20 * case.floor, validate=20 * case.floor)
    monkeypatch.setattr(drive_shape, "refit", lambda *more: replace(end, identify=left * end.identify))
    assert better_as_usual(case, end) == better


def test_slow_drives_are_the_same_either_way():
    case = stage.case()
    assert reshaped(case) is case


def test_drives_are_made_smooth_once():
    case = Case(("bouc_wen",), (), records(0.0), LINEAR)
    smooth = reshaped(case)
    assert reshaped(smooth) is smooth and reshaped(case) is smooth


@pytest.mark.parametrize(("removed", "first_of_all", "behind"), [(0.01, 0, 0), (0.1, 1, 0), (0.6, 1, 1)])
def test_it_takes_little_of_the_misfit_as_given_and_most_of_what_the_best_effect_leaves(
    monkeypatch, removed, first_of_all, behind
):
    """removed: the share of the mean square that goes with smooth drives."""
    case = Case(("bouc_wen",), (), records(3e-3), LINEAR)
    given = replace(first_fit(case, 0), identify=20 * case.floor, validate=20 * case.floor)

    def refitted(home, *more):
        left = given.identify * (1 - removed * bool(home.records[0].smooth_drive)) ** 0.5
        return replace(given, identify=left, validate=left)

    monkeypatch.setattr(drive_shape, "refit", refitted)
    assert bool(with_other_drives(case, given)) == first_of_all
    assert bool(other_behind(case, given, replace(given))) == behind
    assert other_behind(case, given, None) is None


OSCILLATOR = {"mass": 2.0, "damping": 120.0, "stiffness": 1.2e6, "alpha": 8e5, "beta": 2.5e5, "gamma": -1e5}


@pytest.mark.parametrize("smooth", [False, True])
def test_a_model_that_takes_drives_as_smooth_is_tried_with_drives_on_lines(smooth):
    """What is between the samples of a drive takes up more than the noise at a sixth of the Nyquist frequency."""
    values = {f"bouc_wen_oscillator.{word}": value for word, value in OSCILLATOR.items()}
    made, random = [], np.random.default_rng(3)
    for seed, use in enumerate(("identify", "validate")):
        lines = multisine(seed, 10.0)
        lines[15:] = 0
        drive = of_lines(lines)
        moved = rig.response(["bouc_wen_oscillator"], values, drive, dt=1 / 5000, smooth_drive=smooth)
        blank = rig.record(drive, response=[moved + random.normal(0, 3e-9, moved.size)], dt=1 / 5000)
        made.append(replace(blank, use=use, response_units=("um",)))
    case = Case(("bouc_wen_oscillator",), (), made, stage.specs({"bouc_wen_oscillator.mass": 2.0}))
    found = improve(case, first_fit(case, 0))
    assert found.end.effects == () and found.last.verdict == "adequate"
    assert (ON_LINES in [step.change for step in found.steps]) == (not smooth)


def test_how_the_job_says_that_drives_go_is_kept():
    case = Case(("bouc_wen",), (), [replace(record, smooth_drive=False) for record in records(3e-3)], LINEAR)
    assert reshaped(case) is case


@pytest.mark.parametrize(("effects", "ruled_out", "told"), [(("delay",), (), True), ((), ("delay",), False)])
def test_a_delay_of_the_job_tells_as_well_and_none_is_tried_where_it_is_ruled_out(effects, ruled_out, told):
    case = Case(("bouc_wen",), effects, records(3e-3), LINEAR, ruled_out)
    case.floor = 2e-9
    assert bool(with_other_drives(case, first_fit(case, 0))) == told
