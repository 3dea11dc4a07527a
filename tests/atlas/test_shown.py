"""Words at work, at values from their declarations, on the standard drives."""

import numpy as np
import pytest

from pzt_ident.atlas.fitted import fitted
from pzt_ident.atlas.shown import LARGEST, VISIBLE, shown
from pzt_ident.atlas.stage import SPAN, STROKE, VALUES, drives
from pzt_ident.atlas.traces import refitted, slopes, traced


def test_an_effect_is_shown_as_large_as_it_may_be():
    creep = shown("creep")
    values = {item.name: item.value for item in creep.values}
    assert values == pytest.approx({"creep.ratio": LARGEST * 0.4, "creep.tau": 10**0.5, "creep.decades": 3.5})
    gain = shown("quadratic_gain")
    assert np.abs(gain.respond(drives()["loops"]) - gain.bare(drives()["loops"])).max() < VISIBLE * STROKE


def test_a_gain_with_the_voltage_is_what_its_equation_says():
    subject, drive = shown("quadratic_gain"), drives()["small"]
    (curvature,) = (item.value for item in subject.values)
    added = subject.respond(drive) - subject.bare(drive)
    np.testing.assert_allclose(added, 1e-6 * VALUES["bouc_wen.gain"] * curvature * drive.u**2, rtol=2e-3, atol=1e-11)


def test_an_addition_has_its_amounts():
    subject, drive = shown("drift.ramp"), drives()["rest"]
    (size,) = (item.value for item in subject.values)
    assert subject.respond(drive)[-1] == pytest.approx(1e-6 * size)


def test_an_effect_inside_an_equation_shows_the_parameters_of_its_form():
    assert [item.name for item in shown("asymmetry").values] == ["bouc_wen.asymmetry"]
    assert [item.name for item in shown("rate_dependence.power").values] == ["bouc_wen.rate", "bouc_wen.exponent"]


def test_an_operator_follows_the_standard_stage():
    drive = drives()["loops"]
    standard, plays = shown("bouc_wen").respond(drive), shown("prandtl_ishlinskii").respond(drive)
    left = plays - standard
    assert np.std(left) < 0.01 * STROKE
    assert np.std(plays - shown("prandtl_ishlinskii").bare(drive)) > 3 * np.std(left)


def test_words_with_the_same_parameters_are_shown_at_the_same_values():
    (_, first), (_, other) = fitted("lumped_rod"), fitted("rod")
    assert list(first.values()) == list(other.values())


def test_a_refit_takes_up_what_the_standard_parameters_do():
    change = {name: 0.01 * slopes(name)[0] for name in ("loops", "sweep")}
    assert all(np.abs(left).max() < 1e-6 * STROKE for left in refitted(change).values())


def test_a_delay_is_a_lag_on_loops_and_none_at_rest():
    found = traced("delay")
    assert found.size("rest") == 0 and found.size("fast") > 0.01
    assert np.ptp(drives()["fast"].u) == SPAN
