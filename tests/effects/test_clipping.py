"""An amplifier whose supply ends before the command, and a diagnosis that tells it and adds nothing."""

import numpy as np
import pytest

import rig
import stage
from pzt_ident.diagnosis import thinning
from pzt_ident.diagnosis.starts import first_fit
from rig import path, response

SUPPLY = 88.0  # V, of drives up to 100 V


def test_the_output_stays_within_the_supply_at_both_ends():
    u = path(0, 100, -100, 30, points=40)
    np.testing.assert_allclose(response(["clipping"], {"clipping.rail": 1 / SUPPLY}, u), np.clip(u, -SUPPLY, SUPPLY))


def clipped(record):
    known = {word: value for word, value in stage.STAGE.items() if "bouc" in word}
    whole, cut = (
        rig.response(["bouc_wen"], known, u, dt=record.dt)
        for u in (record.drive[0], np.minimum(record.drive[0], SUPPLY))
    )
    return cut - whole


def test_it_is_told_with_its_remedy_and_never_added():
    case = stage.with_response(stage.case(), clipped)
    found = thinning.improve(case, lambda case: first_fit(case, 0))
    assert (found.last.verdict, found.last.faults, found.end.effects) == ("unexplained", ("clipping",), ())
    (with_it,) = (step.fit for step in found.steps if step.added == "clipping")
    assert with_it.values["clipping.rail"] == pytest.approx(1 / SUPPLY, rel=1e-3)
