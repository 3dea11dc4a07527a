"""Scores beside a fit whose simulation has fine steps."""

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis import baseline
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.score import Scorer
from pzt_ident.diagnosis.starts import first_fit

KNOWN = {"lumped.mass": 0.15, "lumped.stiffness": 1e6, "lumped.damping": 40.0}


@pytest.mark.parametrize("effect", ["creep", "quadratic_gain", "sensor_lag", "amplifier_lag"])
def test_traces_in_coarser_steps_score_as_in_those_of_the_fit(effect, monkeypatch):
    """Mechanics that ring within a few samples; the residual itself is that of the fine steps."""
    drives = [50 - 40 * np.cos(2 * np.pi * (1 + 30 * t) * t) for t in 5e-4 * np.arange(3000) * np.array([[1], [0.7]])]
    case = stage.case(KNOWN | stage.EFFECTS[effect], KNOWN, model=("bouc_wen", "lumped"), drives=drives, dt=5e-4)
    problem = case.problem((), (8,) * len(case.records))
    point = first_fit(case, 0).point
    fit = fit_at((), problem, point)
    coarse = Scorer(case, fit)
    monkeypatch.setattr(baseline, "COARSE", 0.0)
    fine = Scorer(case, fit)
    assert max(coarse.coarse.steps) < 8 == min(fine.coarse.steps)
    np.testing.assert_array_equal(coarse.residual, fine.residual)
    assert coarse.left == pytest.approx(fine.left, rel=0.02)
    assert coarse.score(effect).explained == pytest.approx(fine.score(effect).explained, abs=0.02)
    assert fine.score(effect).explained > 0.5
