"""A step at the start is told from a motion, a hysteresis and a rest."""

from dataclasses import replace

import numpy as np
import pytest

from pzt_ident.data.start_step import first_move, start_step
from rig import record

T = np.arange(400) * 5e-3
U = 2 + 1.8 * np.sin(2 * np.pi * T)
STEP = 10 * U * 1e-6 - 20e-6 * np.exp(-T / 0.02)  # from 0 V, through a lag of 20 ms


def test_what_a_lag_leaves_of_a_step_is_told():
    told = start_step(record(U, response=[STEP]))
    assert told == f"x moves by {100 * first_move(U, STEP):.0f} % of its range while the drive moves by 10 % of its"
    assert first_move(U, STEP) > 0.3


@pytest.mark.parametrize("known", [{"rest_at": (0.0,)}, {"run_in": 1}])
def test_what_the_job_says_is_not_asked_for(known):
    assert start_step(replace(record(U, response=[STEP]), **known)) == ""


@pytest.mark.parametrize(
    "response",
    [
        U,
        U + 0.5 * np.abs(U - 2),
        0.02 * np.random.default_rng(0).normal(size=T.size) + U,
        *(np.roll(U, n) for n in (4, 50, 120)),
    ],
    ids=["linear", "bent", "noisy", "late", "in quadrature", "against the drive"],
)
def test_a_motion_is_no_step(response):
    assert start_step(record(U, response=[response])) == ""


def test_a_drive_that_does_not_move_shows_no_step():
    assert first_move(np.full(400, 3.0), STEP) == 0
