"""A periodic disturbance: any phase of a line at its frequency."""

import numpy as np
import pytest

from pzt_ident.effects.periodic_disturbance import PeriodicDisturbance
from pzt_ident.model import Plan
from rig import model, record


def test_sine_and_cosine_make_any_phase():
    t = np.linspace(0, 0.1, 500)
    sine, cosine = PeriodicDisturbance.basis(t, 50.0)
    np.testing.assert_allclose(0.3 * (np.cos(0.7) * sine + np.sin(0.7) * cosine), 0.3 * np.sin(100 * np.pi * t + 0.7))


@pytest.mark.parametrize(("frequency", "left"), [(50.0, 0), (73.0, 0.03 / np.sqrt(2))])
def test_takes_its_own_line_out_of_a_record_and_no_other(frequency, left):
    drive = np.linspace(0, 100, 1000)
    hum = 0.03 * np.sin(100 * np.pi * 1e-3 * np.arange(1000) + 1)
    plan = Plan(model("periodic_disturbance"), record(drive, response=[drive + hum]))
    assert np.sqrt(plan.squares(np.array([[frequency]]))[0, 0] / 1000) == pytest.approx(left, rel=1e-3, abs=1e-12)
