"""The stage in real time is the stage in lanes."""

import numpy as np
import pytest

from contracts.test_blocks import CHAINS, made, waves
from pzt_ident.control.stage import EVERYTHING, MATERIAL, MECHANICS
from pzt_ident.engine.simulator import simulate
from rig import assert_close, rounding, stage_of


@pytest.mark.parametrize("words", [words for words in CHAINS if "bouc_wen_oscillator" not in words])
def test_one_sample_at_a_time_is_what_lanes_compute(words):
    chain, measured, theta = made(words, waves(3, 150), count=1, dt=1e-4)
    found = stage_of(chain, measured, theta).respond(measured.drive, EVERYTHING)
    assert_close(found[list(chain.measured)], simulate(chain, measured, theta)[0], rounding(chain, measured, theta)[0])


def test_a_drive_between_samples_is_a_line():
    """Where lanes take a spline, since the equation is finer than the samples."""
    errors = []
    for samples in (500, 2000, 8000):
        chain, measured, theta = made("bouc_wen_oscillator", waves(3, samples), count=1, dt=0.2 / samples)
        found = stage_of(chain, measured, theta).respond(measured.drive, EVERYTHING)
        errors.append(np.abs(found - simulate(chain, measured, theta)[0]).max())
    assert np.allclose([errors[0] / errors[1], errors[1] / errors[2]], 16, rtol=0.1), "second order in the step"


def test_a_part_goes_on_where_it_ended():
    chain, measured, theta = made("delay bouc_wen lumped", waves(4, 90), count=1, dt=1e-4)
    stage = stage_of(chain, measured, theta)
    part = stage.part()
    pieces = [part.respond(measured.drive[:, rows]) for rows in (slice(0, 1), slice(1, 40), slice(40, 90))]
    assert np.array_equal(np.hstack(pieces), stage.respond(measured.drive))


def test_parts_behind_each_other_are_the_whole():
    chain, measured, theta = made("bouc_wen cross_coupling lumped resonance", waves(5, 90), count=1, dt=1e-4)
    stage = stage_of(chain, measured, theta)
    behind = stage.respond(stage.respond(measured.drive, MATERIAL), MECHANICS)
    assert_close(behind, stage.respond(measured.drive))
