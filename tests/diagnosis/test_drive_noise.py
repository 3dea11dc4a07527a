"""Noise of a recorded drive makes its path longer, which is no effect of the stage."""

from dataclasses import replace

import numpy as np
import pytest

import rig
import stage
from pzt_ident.diagnosis import drive_noise
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.drive_noise import (
    QUIET,
    drive_noise_sentence,
    passed_on,
    quiet_behind,
    quieted,
    with_quiet_drives,
)
from pzt_ident.diagnosis.staircase import improve
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.model.registry import word_of

DRIVES = rig.path(0, 100, 20, 80, 0, 60, 60, points=400), rig.path(0, 70, 10, 110, 40, 40, 0, points=400)


def recorded_with_noise(effect=None, noise=5e-3):
    """A stage whose drives are recorded with noise that they do not have."""
    made, random = stage.records(stage.EFFECTS.get(effect, {}), drives=DRIVES), np.random.default_rng(4)
    noisy = [replace(each, drive=each.drive + random.normal(0, noise, each.drive.shape)) for each in made]
    case = Case(("bouc_wen",), (), noisy, stage.specs({}))
    return stage.considering(case, "quadratic_gain", "sensor_lag", "amplifier_lag", "delay", "distributed_memory")


@pytest.mark.parametrize("effect", [None, "quadratic_gain", "sensor_lag"])
def test_what_is_missing_is_named_and_nothing_for_the_noise(effect):
    case = recorded_with_noise(effect)
    found = improve(case, first_fit(case, 0))
    end = found.steps[-1].fit
    assert found.last.verdict == "adequate" and found.steps[1].change == QUIET
    assert [*map(word_of, end.effects)] == ([effect] if effect else [])
    assert all(record.denoise_drive for record in end.problem.records)


def test_noise_is_left_out_once():
    quiet = quieted(recorded_with_noise())
    assert quieted(quiet) is quiet


@pytest.mark.parametrize(
    ("removed", "first_of_all", "behind"), [(0.01, False, False), (0.1, True, False), (0.7, True, True)]
)
def test_noise_is_left_out_where_it_is_much_of_the_misfit_and_behind_effects_where_it_is_most_of_the_rest(
    monkeypatch, removed, first_of_all, behind
):
    """removed: the share of the mean square that goes with it."""
    case = recorded_with_noise()
    given = replace(first_fit(case, 0), identify=20 * case.floor, validate=20 * case.floor)
    left = (1 - removed) ** 0.5 * given.identify
    monkeypatch.setattr(drive_noise, "refit", lambda *more: replace(given, identify=left, validate=left))
    assert bool(with_quiet_drives(case, given)) == first_of_all
    assert bool(quiet_behind(case, given, case, replace(given))) == behind


def test_drives_without_noise_stay_as_they_are():
    case = recorded_with_noise(noise=0.0)
    assert quieted(case) is case


def smooth(bent=0.0, floor=1e-11):
    """A linear stage of 0.08 um/V without noise, whose drive was recorded with 20 mV. bent: m, what no model of it
    follows. floor: the noise that its windows are taken to show."""
    made, random = stage.records({}, drives=DRIVES), np.random.default_rng(4)
    noisy = [
        replace(
            record,
            drive=record.drive + random.normal(0, 0.02, record.drive.shape),
            response=8e-8 * record.drive + bent * np.sin(np.arange(record.samples)),
        )
        for record in made
    ]
    case = Case(("bouc_wen",), (), noisy, stage.specs({"bouc_wen.alpha": 0.0}))
    case.floor, case.floors = floor, np.array([floor])
    return case


def test_what_a_model_makes_of_the_noise_of_its_drive_is_that_noise_times_its_gain():
    fit = first_fit(case := smooth(), 0)
    assert passed_on(fit) == pytest.approx([0.02 * 8e-8], rel=0.1)
    assert fit.identify == pytest.approx(0.02 * 8e-8, rel=0.1)
    assert "makes 0.0016 um rms" in drive_noise_sentence(case, fit)


@pytest.mark.parametrize("made", [smooth(bent=1e-7), smooth(floor=1e-9)])
def test_noise_of_the_drive_that_is_little_of_the_rest_or_near_the_floor_is_not_told(made):
    assert drive_noise_sentence(made, first_fit(made, 0)) == ""


@pytest.mark.parametrize(
    ("errors", "axes"), [((1.0, 1.0), "xy"), ((1.5, 1.0), "xy"), ((3.0, 1.0), "y"), ((3.0, 0.5), "")]
)
@pytest.mark.parametrize("floor", [0.1, 0.3])
def test_what_each_axis_makes_of_the_noise_is_told_where_it_may_be_what_that_leaves(monkeypatch, errors, axes, floor):
    """errors: of x and y, of which 1 is made of the noise each: one that leaves less follows the drive as recorded. Of
    y a floor of 0.3 is near."""
    case = stage.beside(stage.case(), stage.case())
    fit = first_fit(case, 0)
    sizes = fit.problem.sizes
    case.floors = np.array([0.1, floor]) * 1e-6 / sizes
    fit.__dict__["by_use"] = np.array([errors, errors]) * 1e-6 / sizes
    monkeypatch.setattr(drive_noise, "passed_on", lambda fit: np.full(2, 1e-6))
    said = drive_noise_sentence(case, fit)
    expected = axes if floor == 0.1 else axes.replace("y", "")
    assert [axis for axis in "xy" if f"1 um in {axis} rms" in said] == [*expected]
