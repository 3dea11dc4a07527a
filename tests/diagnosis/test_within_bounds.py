"""A payload is told beside a bound that is too narrow, where either leads to the noise."""

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis.bounds import Widened, beyond_bounds, beyond_names
from pzt_ident.diagnosis.climb import WIDER, Staircase
from pzt_ident.diagnosis.least_bounds import WITHIN, with_least_bounds
from pzt_ident.diagnosis.staircase import improve
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.step import Step
from pzt_ident.diagnosis.verdict import Diagnosis
from pzt_ident.diagnosis.within_bounds import adding_effects, beyond_known_sentence, within_bounds_sentence
from pzt_ident.model.registry import blocks

RINGING = np.repeat([0.0, 40.0, 10.0, 60.0, 0.0], 200)
MADE = {"model": ("bouc_wen", "lumped"), "drives": [RINGING, 0.8 * RINGING], "dt": 2e-5, "steps": 1}


def weighed(hidden, low, high):
    """A stage of known mass whose stiffness has bounds, as shares of the true one."""
    case = stage.case(hidden, {"lumped.mass": 0.15}, **MADE)
    return case.with_specs({"lumped.stiffness": Widened((low * 7e7, high * 7e7))})


def beyond(case):
    """The fit of the model as given, with bounds as wide as it needs."""
    first = first_fit(case, 0)
    return beyond_bounds(case, first, first)[1]


@pytest.mark.parametrize("load", [0.0, 0.006])
def test_a_payload_and_a_stiffness_below_its_bound_are_told_as_one(load):
    """A resonance at a known mass has k / m; 4 % less of it is either."""
    case = weighed({"lumped.load": load} if load else {}, *((0.998, 1.002) if load else (1.04, 1.05)))
    end = beyond(case)
    assert list(beyond_names(case, end)) == ["lumped.stiffness"] and adding_effects(case, end)
    assert within_bounds_sentence(case, end).startswith(" With load_mass the model fits as well within the bounds")
    case.ruled_out = ("load_mass",)
    assert "load_mass" not in within_bounds_sentence(case, end)


@pytest.mark.parametrize(("low", "named"), [(0.998, ["load_mass"]), (0.97, [])])
def test_a_payload_is_named_where_the_stiffness_is_known_and_the_bound_where_it_has_a_range(low, named):
    """A resonance 4 % too low, of a stiffness that the job has within 0.4 %, or above a bound that is 1 % too high."""
    case = weighed({"lumped.load": 0.006}, low, 1.002 if named else 1.12)
    case.ruled_out = tuple({*blocks.effects()} - {"load_mass", "viscous_damping", "delay"})
    found = improve(case, first_fit(case, 0))
    assert [*found.end.effects] == named
    said = beyond_known_sentence(case, found.end)
    assert said.startswith(" Without load_mass it fits as well with lumped.stiffness = ") == bool(named)
    assert bool(beyond_names(case, found.end)) == (not named)


@pytest.mark.parametrize(("width", "named"), [(0.004, ("load_mass",)), (0.2, ())])
def test_a_staircase_in_wider_bounds_ends_with_the_payload_where_the_stiffness_is_known(width, named):
    case = weighed({"lumped.load": 0.006}, 0.998, 0.998 + width)
    first = first_fit(case, 0)
    wide, end = beyond_bounds(case, first, first)
    steps = [Step(first), Step(end, change=WIDER, case=wide)]
    given = Staircase(steps, Diagnosis("adequate", "", end, [], []), case=wide)
    found = with_least_bounds(case, given)
    assert found.end.effects == named and (found.case is None) == bool(named)
    assert found.last.before is found.end
    assert [step.change for step in found.steps] == ["", WIDER, *([WITHIN, ""] if named else [])]
    if named:
        assert found.end.identify < 1.1 * end.identify and beyond_names(case, found.end) == {}


def test_a_stiffness_above_its_bound_is_no_payload():
    case = weighed({}, 0.94, 0.95)
    end = beyond(case)
    assert list(beyond_names(case, end)) == ["lumped.stiffness"]
    assert within_bounds_sentence(case, end) == ""


def test_of_a_model_within_its_bounds_nothing_is_said():
    case = weighed({}, 0.9, 1.1)
    end = first_fit(case, 0)
    assert beyond_names(case, end) == {} and within_bounds_sentence(case, end) == ""
