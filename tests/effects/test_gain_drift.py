"""Electronics whose gain changes as they warm up, and a diagnosis that tells it and adds nothing."""

import numpy as np
import pytest

import rig
import stage
from pzt_ident.diagnosis import thinning
from pzt_ident.diagnosis.starts import first_fit
from rig import path, response

GROWTH, TAU = 0.03, 1.2


def test_the_gain_grows_from_the_start_of_the_record():
    u = path(0, 100, -100, 60, points=77)
    found = response(["gain_drift"], {"gain_drift.growth": GROWTH, "gain_drift.tau": TAU}, u, dt=0.01)
    grown = 1 + GROWTH * (1 - np.exp(-0.01 * np.arange(u.size) / TAU))
    np.testing.assert_allclose(found, u * grown, rtol=1e-12, atol=1e-12)


def grown(record):
    known = {word: value for word, value in stage.STAGE.items() if "bouc" in word}
    still = rig.response(["bouc_wen"], known, record.drive[0], dt=record.dt)
    return still * GROWTH * (1 - np.exp(-record.dt * np.arange(still.size) / TAU))


def test_it_is_told_with_its_remedy_and_never_added():
    case = stage.with_response(stage.case(), grown)
    found = thinning.improve(case, lambda case: first_fit(case, 0))
    assert (found.last.verdict, found.last.faults, found.end.effects) == ("unexplained", ("gain_drift",), ())
    (with_it,) = (step.fit for step in found.steps if step.added == "gain_drift")
    assert with_it.values["gain_drift.growth"] == pytest.approx(GROWTH, rel=0.1)
