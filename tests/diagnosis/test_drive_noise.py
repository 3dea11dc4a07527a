"""Noise of a recorded drive makes its path longer, which is no effect of the stage."""

from dataclasses import replace

import numpy as np
import pytest

import rig
import stage
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.drive_noise import QUIET, quieted
from pzt_ident.diagnosis.staircase import improve
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.model.registry import word_of

DRIVES = rig.path(0, 100, 20, 80, 0, 60, 60, points=400), rig.path(0, 70, 10, 110, 40, 40, 0, points=400)


def recorded_with_noise(effect=None, noise=5e-3):
    """A stage whose drives are recorded with noise that they do not have."""
    made, random = stage.records(stage.EFFECTS.get(effect, {}), drives=DRIVES), np.random.default_rng(4)
    noisy = [replace(each, drive=each.drive + random.normal(0, noise, each.drive.shape)) for each in made]
    return Case(("bouc_wen",), (), noisy, stage.specs({}))


@pytest.mark.parametrize("effect", [None, "quadratic_gain", "sensor_lag"])
def test_what_is_missing_is_named_and_nothing_for_the_noise(effect):
    case = recorded_with_noise(effect)
    found = improve(case, first_fit(case, 0))
    end = found.steps[-1].fit
    assert found.last.verdict == "adequate" and found.steps[1].change == QUIET
    assert [*map(word_of, end.effects)] == ([effect] if effect else [])
    assert all(record.denoise_drive for record in end.problem.records)


def test_drives_without_noise_stay_as_they_are():
    case = recorded_with_noise(noise=0.0)
    assert quieted(case) is case
