"""What two effects leave is not given to one that contains the other."""

import pytest

import stage
from pzt_ident.diagnosis import refit as refitting
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.contained import join_look_alikes, parts_of, separate_accounts
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.refit import refit
from pzt_ident.model.registry import blocks, word_of

RUBBING = {"friction.force": 0.6e-6, "friction.reach": 0.4e-6, "friction.stiction": 0.3, "friction.stribeck": 20e-6}
GUESS = {"friction.force": 0.6, "friction.reach": 0.4, "friction.stiction": 0.3, "friction.stribeck": 20.0}  # in um
VISCOUS = "friction.lugre_viscous"


def with_viscous_friction(late):
    """A case of a stage that rubs, with what `late` says, its first fit, and that with viscous friction."""
    effects = ("friction", "delay") if "delay.time" in late else (VISCOUS,)
    made = stage.records(RUBBING | late, model=("bouc_wen", *effects), noise=stage.NOISE / 2)
    case = Case(("bouc_wen",), (), made, {})
    problem = case.problem(())
    first = fit_at((), problem, case.descend(problem, problem.unit_point(stage.STAGE)))
    return case, first, refit(case, first, (VISCOUS,), {"friction.viscous": 0.01} | GUESS)


def test_a_delay_that_viscous_friction_stood_in_for_is_told_beside_friction():
    case, first, now = with_viscous_friction({"delay.time": 0.012})
    steps = separate_accounts(case, first, now)
    assert [(step.added, step.removed) for step in steps] == [("friction", VISCOUS), ("delay", None)]
    end = steps[-1].fit
    assert end.values["delay.time"] == pytest.approx(0.012, rel=0.05)
    assert end.identify < now.identify / 2


@pytest.mark.parametrize("tau", [3e-3, 3e-4])
def test_a_form_that_holds_a_lag_begins_with_it(tau, monkeypatch):
    """To a factor of three, however small the lag is beside what the catalogue has for friction."""
    values = stage.STAGE | RUBBING | {"sensor_lag.tau": tau}
    made = stage.records(values, model=("bouc_wen", "friction", "sensor_lag"), dt=1e-4, effects={})
    case = Case(("bouc_wen",), (), made, {})
    problem, begun = case.problem(("friction", "sensor_lag")), {}
    now = fit_at(("friction", "sensor_lag"), problem, problem.unit_point(values))
    monkeypatch.setattr(refitting, "refit", lambda case, now, effects, guess: begun.update(guess))
    refitting.refit_holding(case, now, (VISCOUS,))
    assert tau / 3 <= begun["friction.viscous"] <= 3 * tau


def test_viscous_friction_is_one_effect():
    case, first, now = with_viscous_friction({"friction.viscous": 0.02})
    assert separate_accounts(case, first, now) == []


@pytest.mark.parametrize(
    ("stage_has", "values", "joined"),
    [
        (("amplifier_lag.two_poles",), {"amplifier_lag.tau": 0.03, "amplifier_lag.damping": 1.0}, True),
        (("amplifier_lag", "delay"), {"amplifier_lag.tau": 0.01, "delay.time": 0.03}, False),
    ],
)
def test_a_lag_of_two_poles_is_one_effect_and_a_lag_behind_a_delay_is_two(stage_has, values, joined):
    made = stage.records(values, model=("bouc_wen", *stage_has), noise=stage.NOISE / 2, effects={})
    case = Case(("bouc_wen",), (), made, {})
    problem = case.problem(())
    first = fit_at((), problem, case.descend(problem, problem.unit_point(stage.STAGE)))
    now = refit(case, first, ("amplifier_lag", "delay"), {"amplifier_lag.tau": 0.02, "delay.time": 0.01})
    steps = join_look_alikes(case, first, now)
    told = [(None, "delay"), ("amplifier_lag.two_poles", "amplifier_lag")]
    assert [(step.added, step.removed) for step in steps] == (told if joined else [])
    assert not joined or steps[-1].fit.total < now.total


@pytest.fixture(scope="module")
def rubbing_late():
    return with_viscous_friction({"delay.time": 0.012})


@pytest.mark.parametrize("item", [item for word in blocks.effects() for item in blocks.forms(word)])
def test_the_parts_of_a_form_are_what_it_contains_and_look_alikes_of_that_and_nothing_the_model_has(rubbing_late, item):
    case, _, now = rubbing_late
    parts = parts_of(case, now, item)
    assert bool(parts) == bool(blocks[item].contains)
    assert not {*parts} & {*map(word_of, now.effects)}
