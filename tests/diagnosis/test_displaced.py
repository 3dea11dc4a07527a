"""An effect with loops of its own that takes the place of the model's operator."""

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis.displaced import beyond_curve, displaced_operator, loop_widths
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.model.registry import blocks

FRICTION = {
    "friction.force": 0.5e-6,
    "friction.reach": 1e-6,
    "friction.stiction": 0.0,
    "friction.stribeck": 1e-3,
}


def with_values(case, effects=(), **changed):
    """The model of a case at the stage's parameters, some of them changed."""
    problem = case.problem(effects)
    values = stage.STAGE | FRICTION | {f"bouc_wen.{word}": value for word, value in changed.items()}
    units = dict(zip(problem.names, problem.factors[problem.free], strict=True))
    point = problem.unit_point({name: values[name] / units[name] for name in problem.names})
    return fit_at(effects, problem, point)


@pytest.fixture(scope="module")
def plain():
    return stage.case()


def test_the_loops_of_an_operator_grow_with_its_share_and_its_gain_and_go_with_its_dissipation(plain):
    given = loop_widths(with_values(plain))
    alpha, gain = stage.STAGE["bouc_wen.alpha"], stage.STAGE["bouc_wen.gain"]
    less = loop_widths(with_values(plain, alpha=0.6 * alpha, gain=1.1 * gain))
    np.testing.assert_allclose(less, 0.66 * given, rtol=1e-6)
    assert loop_widths(with_values(plain, alpha=0.0))[0] < 1e-9 * given[0]
    assert loop_widths(with_values(plain, beta=0.0))[0] < 0.05 * given[0]  # then h is a function of the drive


@pytest.mark.parametrize(("beta", "displaced"), [(0.015, ""), (0.007, ""), (0.0, "bouc_wen")])
def test_friction_takes_the_place_of_an_operator_of_which_hardly_any_loop_is_left(plain, beta, displaced):
    now = with_values(plain, ("friction",), beta=beta)
    assert displaced_operator(plain, with_values(plain), now, "friction") == displaced


@pytest.mark.parametrize("effect", [word for word in blocks.effects() if not blocks[word].loops])
def test_an_effect_without_loops_takes_the_place_of_none(plain, effect):
    assert displaced_operator(plain, with_values(plain), with_values(plain, beta=0.0), effect) == ""


def test_loops_below_the_noise_say_nothing(plain):
    flat = with_values(plain, alpha=1e-4)
    assert displaced_operator(plain, flat, with_values(plain, ("friction",), alpha=0.0), "friction") == ""


def test_a_polynomial_of_the_drive_is_no_loop():
    drive = np.sin(np.arange(500) / 20) * 3 + 1
    assert beyond_curve(drive, drive**7 - drive**2) < 1e-15 * np.var(drive**7)
    assert beyond_curve(np.ones(9), np.arange(9.0)) == 0


@pytest.mark.parametrize(("betas", "displaced"), [((0.0, 0.0), "bouc_wen"), ((0.0, 0.015), "")])
def test_an_operator_is_displaced_on_all_axes_or_none(plain, betas, displaced):
    case = stage.beside(plain, plain)
    given = with_axes(case, ())
    now = with_axes(
        case, ("friction",), **{f"{axis}.bouc_wen.beta": beta for axis, beta in zip("xy", betas, strict=True)}
    )
    assert displaced_operator(case, given, now, "friction") == displaced


def with_axes(case, effects, **changed):
    """The same of a stage of two axes."""
    problem = case.problem(effects)
    known = {f"{axis}.{word}": value for axis in "xy" for word, value in (stage.STAGE | FRICTION).items()} | changed
    units = dict(zip(problem.names, problem.factors[problem.free], strict=True))
    return fit_at(effects, problem, problem.unit_point({name: known[name] / units[name] for name in problem.names}))
