"""An amplifier with a dead zone, and a diagnosis that tells it and adds nothing."""

import numpy as np
import pytest

import rig
import stage
from pzt_ident.diagnosis import thinning
from pzt_ident.diagnosis.starts import first_fit
from rig import path, response

WIDTH, CENTRE = 1.5, 42.0  # V


def dead(u):
    return np.where(u > CENTRE, np.maximum(u - WIDTH, CENTRE), np.minimum(u + WIDTH, CENTRE))


def test_the_output_stands_still_in_the_zone_and_follows_beside_it():
    u = path(0, 100, -100, 60, points=77)
    known = {"dead_zone.width": WIDTH, "dead_zone.centre": CENTRE}
    np.testing.assert_allclose(response(["dead_zone"], known, u), dead(u), rtol=0, atol=1e-12)


def missed(record):
    known = {word: value for word, value in stage.STAGE.items() if "bouc" in word}
    u = record.drive[0]
    given, put_out = (rig.response(["bouc_wen"], known, drive, dt=record.dt) for drive in (u, dead(u)))
    return put_out - given


def test_it_is_told_with_its_remedy_and_never_added():
    case = stage.with_response(stage.case(), missed)
    found = thinning.improve(case, lambda case: first_fit(case, 0))
    assert (found.last.verdict, found.last.faults, found.end.effects) == ("unexplained", ("dead_zone",), ())
    (with_it,) = (step.fit for step in found.steps if step.added == "dead_zone")
    assert with_it.values["dead_zone.width"] == pytest.approx(WIDTH, rel=0.05)
    assert with_it.values["dead_zone.centre"] == pytest.approx(CENTRE, rel=0.02)
