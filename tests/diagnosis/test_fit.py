"""The errors of a fit, its freedom, and which of its parameters are on a bound."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import made_fits
import rig
from pzt_ident.diagnosis import refit
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.caveats import bounds_sentence
from pzt_ident.diagnosis.fit import EDGE, fit_at
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.engine.simulator import simulate
from pzt_ident.model.parameter import Parameter
from pzt_ident.search.problem import Problem


def test_without_records_to_validate_there_is_no_error_of_them(plain):
    without_validation = Case(plain.words, (), plain.records[:1], {})
    assert first_fit(without_validation, 0).validate is None


def test_a_shape_whose_range_ends_of_itself_is_not_on_a_bound(creeping):
    """0 decades are one Kelvin-Voigt element, 7 are all that the bounds allow."""
    fit = refit.refit(creeping, first_fit(creeping, 0), ("creep",), {})
    places = np.where([name == "creep.decades" for name in fit.problem.names], 1.0, 0.5)
    assert replace(fit, point=places).on_bounds == ("creep.decades",)
    assert replace(fit, point=places * (places < 1)).on_bounds == ()


def test_a_parameter_that_is_worse_on_its_bound_is_not_on_it():
    """A damping of 0.4 N s/m within [0, 5000] is as near to zero as the digits of a search, and determined."""
    ringing = np.where(np.arange(2000) % 1000 < 20, 0.0, 10.0)
    made, theta = rig.model("lumped"), np.array([[0.2, 0.4, 8e4]])
    response = simulate(made, rig.record(ringing, dt=2e-4), theta)[0]
    bounds = SimpleNamespace(bounds=(0.0, 5000.0), value=None)
    problem = Problem(made, [rig.record(ringing, dt=2e-4, response=response)], {"lumped.damping": bounds})
    point = problem.unit_point(dict(zip(made.names, theta[0], strict=True)))
    fit = fit_at((), problem, point)
    assert 0 < point[problem.names.index("lumped.damping")] < EDGE
    assert "lumped.damping" not in fit.on_bounds
    nearer = np.where(np.array(problem.names) == "lumped.damping", 1e-9, point)
    assert "lumped.damping" in fit_at((), problem, nearer).on_bounds


def test_a_parameter_on_a_bound_is_told_unless_it_is_its_null(creeping):
    fit = refit.refit(creeping, first_fit(creeping, 0), ("amplifier_lag",), {})
    place = {name: i for i, name in enumerate(fit.problem.names)}
    point = np.full(fit.problem.dimensions, 0.5)
    point[place["bouc_wen.gamma"]] = 1.0
    point[place["amplifier_lag.tau"]] = 0.0
    assert replace(fit, point=point).on_bounds == ("bouc_wen.gamma",)
    point[place["amplifier_lag.tau"]] = 1.0
    assert set(replace(fit, point=point).on_bounds) == {"bouc_wen.gamma", "amplifier_lag.tau"}
    sentence = bounds_sentence(replace(fit, point=point))
    assert "amplifier_lag.tau and bouc_wen.gamma ended on their bounds of 0.05 s and 0.5 1/V" in sentence


def test_amounts_of_each_record_count_among_the_parameters(plain):
    """A ripple has four of them, and a frequency as a hum, which has two."""
    numbers = {}
    for effect in ("periodic_disturbance", "periodic_disturbance.ripple", "drift"):
        problem = plain.problem((effect,))
        numbers[effect] = fit_at((effect,), problem, np.full(problem.dimensions, 0.5)).freedom
    free = plain.problem(()).dimensions
    assert numbers == {"periodic_disturbance": free + 3, "periodic_disturbance.ripple": free + 5, "drift": free + 2}


@pytest.mark.parametrize(
    ("end", "free"), [("upper", {"lower"}), ("lower", {"upper"}), ("both", set()), (None, {"lower", "upper"})]
)
def test_a_shape_rests_on_no_bound_where_its_range_ends_of_itself(end, free):
    """A drift whose time constant is far longer than the record is a ramp."""
    tau = Parameter("s", (1, 3000), "", scale="log", end=end)
    assert {word for word, value in (("lower", 1.0), ("upper", 3000.0)) if not tau.ends_at(value, word)} == free


def test_the_total_is_root_mean_square_over_both_uses():
    assert made_fits.fit(1.0, 7.0).total == made_fits.fit(7.0, 1.0).total == pytest.approx(5)
    assert made_fits.fit(3.0).total == 3
