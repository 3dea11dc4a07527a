"""A bound that is too narrow is a cheaper account than an effect, and is told from one."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import stage
from made_fits import CASE, fit
from pzt_ident.diagnosis import bounds, paths, staircase
from pzt_ident.diagnosis.bounds import (
    DECADES,
    FAR_SLIP,
    SLIP,
    Widened,
    are_decisive,
    are_too_narrow,
    beyond_bounds,
    bounds_that_changed,
    brought_back,
    continued,
    freed,
    narrow_bounds_sentence,
    stands_in,
    widened,
)
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.climb import WIDER, Staircase
from pzt_ident.diagnosis.criteria import adequate
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.paths import exchange_for_bounds, improve_within
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.score import scorer_of
from pzt_ident.diagnosis.staircase import bounds_beside, improve
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.step import Step
from pzt_ident.diagnosis.verdict import diagnose
from pzt_ident.model.registry import word_of

GAIN = 1e6 * stage.STAGE["bouc_wen.gain"]  # um/V


def bounded(low, high, effects=(), **more):
    """The case with bounds for the gain, as shares of the true one, and effects hidden."""
    hidden = {name: value for effect in effects for name, value in stage.EFFECTS[effect].items()}
    return stage.case(hidden, **more).with_specs({"bouc_wen.gain": Widened((low * GAIN, high * GAIN))})


def lifted():
    """A curvature that lifts the gain which is fitted without it, far from the bound that keeps out the true one."""
    case = stage.considering(
        stage.case({"quadratic_gain.curvature": 2e-3}), "quadratic_gain", "cubic_stiffness", "creep"
    )
    return case.with_specs({"bouc_wen.gain": Widened((1.05 * GAIN, 1.6 * GAIN))})


@pytest.mark.parametrize("low", [1.05, 1.1, 1.25])
def test_a_gain_beside_its_bounds_is_the_bound_and_no_effect(low):
    case = bounded(low, 1.3)
    first = first_fit(case, 0)
    assert first.identify > 5 * stage.NOISE
    found = improve(case, first)
    assert found.last.verdict == "adequate"
    assert [(step.added, step.change) for step in found.steps] == [(None, ""), (None, "wider bounds")]
    end = found.steps[-1].fit
    assert end.values["bouc_wen.gain"] == pytest.approx(GAIN, rel=1e-2)
    assert found.case.specs["bouc_wen.gain"].bounds[0] < GAIN < found.case.specs["bouc_wen.gain"].bounds[1]
    assert "bouc_wen.gain is" in narrow_bounds_sentence(case, end)
    assert [list(bounds_that_changed(case, step.fit)) for step in found.steps] == [[], ["bouc_wen.gain"]]
    assert brought_back(case, end) is None


@pytest.mark.parametrize("effect", ["creep", "quadratic_gain"])
def test_beside_a_narrow_bound_the_effect_is_found_and_alone(effect):
    case = bounded(1.05, 1.3, [effect])
    found = improve(case, first_fit(case, 0))
    assert found.last.verdict == "adequate"
    assert list(map(word_of, found.steps[-1].fit.effects)) == [effect]


@pytest.mark.parametrize("low", [1.02, 1.03])
def test_a_bound_that_keeps_out_less_than_an_effect_does_is_widened_where_the_wider_one_is_not_reached(low):
    case = stage.case({"amplifier_lag.tau": 1e-2}).with_specs({"bouc_wen.gain": Widened((low * GAIN, 1.3 * GAIN))})
    first = first_fit(case, 0)
    wide, after = beyond_bounds(case, first, first)
    assert 0.1 < share_explained(first.total, after.total, case.floor) < 0.5
    assert are_too_narrow(case, wide, first, after)
    end = improve(case, first).end
    assert [word_of(effect) for effect in end.effects] == ["amplifier_lag"]
    assert end.values["bouc_wen.gain"] == pytest.approx(GAIN, rel=1e-2)


@pytest.mark.parametrize(
    ("given", "reached", "left", "narrow"),
    [
        (True, False, 0.9, True),
        (True, True, 0.9, False),
        (False, False, 0.9, False),
        (True, True, 0.3, True),
        (False, False, 0.3, True),
    ],
)
def test_bounds_are_too_narrow_where_they_keep_out_most_or_are_of_the_job_and_not_reached_when_wider(
    monkeypatch, given, reached, left, narrow
):
    """left: of an error far above the noise."""
    monkeypatch.setattr(bounds, "widened", lambda case, fit: {"bouc_wen.gain": None})
    monkeypatch.setattr(bounds, "freed", lambda case, problem: {})
    monkeypatch.setattr(bounds, "stands_in", lambda wide, case, fit: reached)
    case = SimpleNamespace(floor=1.0, floors=np.ones(1), specs={"bouc_wen.gain": None} if given else {})
    assert bounds.are_too_narrow(case, case, fit(100.0, 100.0), fit(100 * left, 100 * left)) == narrow


def test_an_effect_that_is_small_beside_what_a_narrow_bound_leaves_is_found():
    """It is measured by what the model leaves within wider bounds."""
    case = bounded(1.08, 1.3, noise=stage.NOISE / 50)
    hidden = stage.case({"quadratic_gain.curvature": 1e-5}, noise=stage.NOISE / 50).with_specs(case.specs)
    first = first_fit(hidden, 0)
    found = improve(hidden, first)
    wide = found.steps[1].fit
    assert wide.identify < 0.03 * first.identify
    assert found.steps[-1].fit.effects == ("quadratic_gain",)
    assert found.last.verdict == "adequate"


def test_a_bound_that_only_the_first_effect_reaches_is_widened_before_a_second_one_is_blamed():
    case = lifted()
    first = first_fit(case, 0)
    assert first.on_bounds == ()
    found = improve(case, first)
    assert found.last.verdict == "adequate"
    assert [step.added or step.change for step in found.steps[1:]] == ["quadratic_gain", "wider bounds"]
    assert found.steps[-1].fit.values["bouc_wen.gain"] == pytest.approx(GAIN, rel=1e-2)


@pytest.mark.parametrize(("left", "widened"), [(None, True), (10.0, True), (1.0, False)])
def test_where_no_effect_passes_that_does_as_well_the_bounds_that_the_best_one_reaches_are_widened(left, widened):
    """left: what the effect that passes leaves, in what the best one leaves."""
    case = lifted()
    first = first_fit(case, 0)
    diagnosis = diagnose(case, first)
    assert bounds_beside(case, first, diagnosis) is None
    best = diagnosis.best
    passing = [replace(best, fit=replace(best.fit, identify=left * best.fit.identify))] if left else []
    found = bounds_beside(case, first, replace(diagnosis, passing=passing))
    assert bool(found) == widened
    if found:
        wide, fit = found
        assert wide.specs["bouc_wen.gain"].bounds[0] < GAIN
        assert fit.effects == ("quadratic_gain",) and adequate(case, first, fit)


@pytest.mark.parametrize("leads", [True, False])
def test_bounds_that_lead_to_the_noise_beside_one_effect_are_widened_before_other_effects_are_tried(monkeypatch, leads):
    case = lifted()
    first, tried = first_fit(case, 0), []
    wide, after = beyond_bounds(case, first, diagnose(case, first).best.fit)
    after = after if leads else replace(after, identify=10 * after.identify)
    monkeypatch.setattr(staircase, "bounds_beside", lambda *arguments: (wide, after))
    monkeypatch.setattr(
        staircase, "improve_within", lambda case, *more: tried.append(case) or improve_within(case, *more)
    )
    assert improve(case, first).last.verdict == "adequate"
    assert (tried[0] is wide) == leads


def test_a_parameter_on_its_bound_lies_not_beyond_it():
    """However it is rounded on the way to the cube and back."""
    case = bounded(1.05, 1.3)
    problem = case.with_specs({"bouc_wen.gain": Widened((1.05 * GAIN * (1 - 1e-9), 1.3 * GAIN))}).problem(())
    on_bound = fit_at((), problem, problem.unit_point(stage.STAGE | {"bouc_wen.gain": problem.lower[0]}))
    assert narrow_bounds_sentence(case, on_bound) == ""


def test_bounds_that_hold_the_truth_are_kept():
    case = bounded(0.9, 1.001, ["quadratic_gain"])
    found = improve(case, first_fit(case, 0))
    assert found.case is None or found.case is case
    assert found.steps[-1].fit.effects == ("quadratic_gain",)
    assert narrow_bounds_sentence(case, found.steps[-1].fit) == ""


def test_only_bounds_of_the_job_that_are_reached_are_widened_and_not_beyond_those_declared():
    case = bounded(0.9, 1.2)
    problem = case.problem(())
    values = stage.STAGE | {"bouc_wen.gain": 1.2 * GAIN, "bouc_wen.alpha": 1.0}
    fit = fit_at((), problem, problem.unit_point(values))
    (name,) = widened(case, fit)
    low, high = widened(case, fit)[name].bounds
    assert (name, low) == ("bouc_wen.gain", pytest.approx(0.9 * GAIN))
    assert high == pytest.approx((1 + SLIP) * 1.2 * GAIN)
    _, most = problem.declared_bounds(0)
    widest = case.with_specs({"bouc_wen.gain": Widened((0.9 * GAIN, most))})
    at_most = fit_at((), widest.problem(()), widest.problem(()).unit_point(values | {"bouc_wen.gain": most}))
    assert widened(widest, at_most) == {}


MASS = 4e-3  # kg, given: the stiffness of its resonance is below all that a job without bounds looks for
SOFT = {"lumped.mass": MASS, "lumped.stiffness": MASS * (2 * np.pi * 60) ** 2, "lumped.damping": 2 * 0.03 * MASS * 377}


@pytest.mark.parametrize("given", [False, True])
def test_beside_a_guessed_bound_is_as_good_as_on_it(given):
    """Far from the noise another machine rounds to another place on the same plateau."""
    case = stage.case(SOFT, {"lumped.mass": MASS}, model=("bouc_wen", "lumped"))
    as_given, rigid = case.problem(()), "lumped.stiffness"
    least, most = as_given.declared_bounds(as_given.model.names.index(rigid))
    case = case.with_specs({rigid: Widened((least, most))}) if given else case
    problem = case.problem(())
    values = dict(zip(problem.names, problem.physical(np.full(problem.dimensions, 0.5))[0], strict=True))
    beside, between = (fit_at((), problem, problem.unit_point(values | {rigid: k * least})) for k in (1.05, 30))
    assert not beside.on_bounds and widened(case, between) == {}
    assert widened(case, beside) == ({} if given else {rigid: Widened((least / DECADES, most))})


@pytest.mark.parametrize("effect", ["", "quadratic_gain"])
def test_a_bound_that_the_job_does_not_give_is_a_guess_and_no_payload(effect):
    """It is told, and is in the job that is written."""
    t = np.arange(3000) * 1e-3
    chirps = [50 + reach * np.sin(2 * np.pi * (10 + 20 * t) * t) for reach in (30, 20)]
    known = SOFT | stage.EFFECTS.get(effect, {})
    case = stage.case(known, {"lumped.mass": MASS}, model=("bouc_wen", "lumped"), drives=chirps, dt=1e-3, steps=1)
    first = first_fit(stage.considering(case, "load_mass", "viscous_damping", "quadratic_gain", "resonance"), 0)
    least, most = first.problem.declared_bounds(first.problem.model.names.index("lumped.stiffness"))
    assert known["lumped.stiffness"] < least
    found = improve(case, first)
    end = found.steps[-1].fit
    assert found.last.verdict == "adequate" and end.effects == tuple(filter(None, [effect]))
    assert end.values["lumped.stiffness"] == pytest.approx(known["lumped.stiffness"], rel=1e-2)
    assert bounds_that_changed(case, end) == {"lumped.stiffness": (least / DECADES, most)}
    assert "by default: give it bounds in the job" in narrow_bounds_sentence(case, end)


def test_nothing_is_said_of_bounds_of_mechanics_that_a_fit_does_without():
    case = stage.case(model=("bouc_wen", "lumped")).with_specs({"lumped.stiffness": Widened((1e6, 1e7))})
    lean = first_fit(case.with_words(("bouc_wen",)), 0)
    assert narrow_bounds_sentence(case, lean) == "" and bounds_that_changed(case, lean) == {}


def test_wider_bounds_that_help_too_little_are_no_account():
    case = bounded(0.9, 1.2)
    first = first_fit(case, 0)
    assert beyond_bounds(case, first, first) is None


@pytest.mark.parametrize(("left", "slips"), [(9.5, [SLIP]), (8.0, [SLIP, FAR_SLIP])], ids=["little", "on the way"])
def test_bounds_are_widened_far_only_where_the_first_part_of_the_way_takes_up_some_of_the_misfit(
    monkeypatch, left, slips
):
    """A fit of 10 noise floors on a bound; what is wanted beyond both leaves half of it after a quarter of the way."""
    tried = []
    monkeypatch.setattr(bounds, "widened", lambda case, fit, slip: {"gain": slip})
    monkeypatch.setattr(bounds, "beyond_by", lambda slip, case, rested: tried.append(slip) or (case, fit(left, left)))
    monkeypatch.setattr(bounds, "removes_enough", lambda *fits: False)
    monkeypatch.setattr(bounds, "are_decisive", lambda *fits: False)
    assert beyond_bounds(CASE, fit(10.0, 10.0), fit(10.0, 10.0)) is None
    assert tried == slips


def test_bounds_that_keep_out_one_axis_are_widened_though_the_other_lacks_more():
    curved = stage.case({"quadratic_gain.curvature": -4e-3})
    beyond = stage.case({"bouc_wen.gain": 1.04 * stage.STAGE["bouc_wen.gain"]}, seed=9)
    both = stage.considering(stage.beside(curved, beyond), "quadratic_gain", "saturation", "creep")
    case = both.with_specs({"bouc_wen.gain": Widened((0.3 * GAIN, 1.01 * GAIN))})
    first = first_fit(case, 0)
    _, wide = beyond_bounds(case, first, first)
    assert share_explained(first.total, wide.total, case.floor) < 0.5
    assert are_decisive(case, first, wide) and not are_decisive(case, first, first)
    found = improve(case, first)
    assert found.last.verdict == "adequate"
    assert [step.added or step.change for step in found.steps[1:]] == ["wider bounds", "quadratic_gain"]
    assert found.steps[-1].fit.values["y.bouc_wen.gain"] == pytest.approx(1.04 * GAIN, rel=1e-2)


def test_both_ends_of_a_bound_that_axes_share_are_widened_and_only_these_may_stand_in():
    cases = [stage.case({"bouc_wen.gain": share * stage.STAGE["bouc_wen.gain"]}, seed=9) for share in (0.95, 1.05)]
    case = stage.beside(*cases).with_specs({"bouc_wen.gain": Widened((0.98 * GAIN, 1.02 * GAIN))})
    first = first_fit(case, 0)
    assert {"x.bouc_wen.gain", "y.bouc_wen.gain"} <= {*first.on_bounds}
    specs = widened(case, first)
    assert specs["bouc_wen.gain"].bounds == pytest.approx(((1 - SLIP) * 0.98 * GAIN, (1 + SLIP) * 1.02 * GAIN))
    wide, after = beyond_bounds(case, first, first)
    assert not stands_in(wide, case, after)
    beyond = case.with_specs({"bouc_wen.gain": Widened((0.98 * GAIN, 1.03 * GAIN))})
    assert stands_in(beyond, case, continued(beyond, first))
    one_end = case.with_specs({"bouc_wen.gain": Widened((0.98 * GAIN, 1.2 * GAIN))})
    assert not stands_in(one_end, case, continued(one_end, first))


@pytest.mark.parametrize(("alpha", "felt"), [(0.5, True), (0.0, False)])
def test_a_parameter_that_no_record_feels_makes_up_for_nothing_beyond_its_bounds(alpha, felt):
    """Without a hysteretic part the shape of a loop is any."""
    case = stage.case(fixed={"bouc_wen.alpha": alpha}).with_specs({"bouc_wen.beta": Widened((0.01, 0.012))})
    wide = case.with_specs({"bouc_wen.beta": Widened((0.01, 0.0135))})
    problem, first = wide.problem(()), first_fit(case, 0)
    there = fit_at((), problem, problem.unit_point(first.values | {"bouc_wen.beta": 0.0135}))
    assert "bouc_wen.beta" in there.on_bounds
    assert stands_in(wide, case, there) == felt
    assert (brought_back(case, there) is None) == felt


@pytest.mark.parametrize(("within", "near", "kept"), [(True, False, True), (False, True, True), (False, False, False)])
def test_without_a_budget_for_both_the_wider_bounds_are_kept_that_clear_up_most(monkeypatch, within, near, kept):
    """Those that are not reached, or with which the model is near the noise."""
    case = bounded(1.05, 1.3)
    first = first_fit(case, 0)
    wide, after = beyond_bounds(case, first, first)
    ended = Staircase([Step(first), Step(after, change="wider bounds", case=wide)], diagnose(wide, after), case=wide)
    monkeypatch.setattr(staircase, "improve_beyond", lambda *arguments: ended)
    monkeypatch.setattr(staircase, "accounts", lambda *arguments: False)
    monkeypatch.setattr(staircase, "keeps_within", lambda *arguments: within)
    monkeypatch.setattr(staircase, "near_noise", lambda *arguments: near)
    monkeypatch.setattr(staircase, "outdoes", lambda *arguments: False)
    case.budget = Budget(0.0)
    case.budget.lasts = lambda: True
    assert (improve(case, first) is ended) == kept
    assert ("effects within the bounds of the job" in case.budget.untried) == kept


@pytest.mark.parametrize(("times", "words"), [(1.1, ["quadratic_gain", "wider bounds"]), (0.9, ["quadratic_gain"])])
def test_what_is_larger_than_the_catalogue_expects_is_told_so_before_another_effect_is_blamed(times, words):
    size = times * 0.5 / 120  # 1/V: half the gain is gone at 120 V
    case = stage.considering(stage.case({"quadratic_gain.curvature": -size}), "quadratic_gain", "saturation", "creep")
    found = improve(case, first_fit(case, 0))
    assert [step.added or step.change for step in found.steps[1:]] == words
    assert found.last.verdict == "adequate"
    assert found.end.values["quadratic_gain.curvature"] == pytest.approx(-size, rel=0.01)
    assert bool(narrow_bounds_sentence(case, found.end)) == (times > 1)


@pytest.mark.parametrize(
    ("low", "slip", "stands_in"), [(0.0826, SLIP, True), (0.085, SLIP, True), (0.085, 0.02, True), (0.05, SLIP, False)]
)
def test_an_effect_that_made_up_for_a_bound_of_the_job_gives_way_to_a_wider_one(monkeypatch, low, slip, stands_in):
    """The gain is 0.082 um/V; a growth of the gain with the amplitude stands for a bound above it, which is reached
    with that growth or only without it, and may be farther off than the first part of the way."""
    monkeypatch.setattr(paths, "SLIP", slip)
    case = stage.case(stage.EFFECTS["quadratic_gain"]).with_specs({"bouc_wen.gain": Widened((low, 0.2))})
    first = first_fit(case, 0)
    now = refit(case, refit(case, first, ("quadratic_gain",), {}), ("quadratic_gain", "amplitude_gain"), {})
    steps = exchange_for_bounds(case, first, now)
    assert [(step.change, step.removed) for step in steps] == [(WIDER, None), ("", "amplitude_gain")] * stands_in
    if steps:
        assert steps[-1].fit.values["bouc_wen.gain"] == pytest.approx(0.082, rel=0.01)
        assert steps[0].case.specs["bouc_wen.gain"].bounds[0] < 0.082


@pytest.mark.parametrize(
    ("best", "rests", "beyond", "taken"),
    [(1.8, False, 1.0, True), (1.0, False, 1.0, False), (1.8, False, 1.6, False), (1.1, True, 1.0, True),
     (1.01, True, 1.0, False)],
    ids=["", "enough", "in vain", "on its bound", "enough on its bound"],
)  # fmt: skip
@pytest.mark.parametrize("form", [False, True])
@pytest.mark.parametrize("own", [None, 1.7])
def test_another_effect_that_is_adequate_beyond_a_bound_of_the_job_is_gone_on_with(
    monkeypatch, best, rests, beyond, taken, form, own
):
    """In noise floors; the best one rests on no bound, or leaves `own` beyond its own. rests: whether it is at a bound
    of the job. form: whether the other is one of its forms."""
    case = stage.case(fixed={"bouc_wen.alpha": 0.55})
    first = first_fit(case, 0)
    lowest, other = (replace(first, identify=left * case.floor, validate=left * case.floor) for left in (best, 2.2))
    wide = replace(first, identify=beyond * case.floor, validate=beyond * case.floor)
    little = (case, replace(first, identify=own * case.floor, validate=own * case.floor)) if own else None
    forms = [{"a": lowest, "a.b": other}] if form else [{"a": lowest}, {"c": other}]
    items = [SimpleNamespace(fit=next(iter(refits.values())), refits=refits) for refits in forms]
    resting = [id(fit) for fit in (other, lowest)[: 1 + rests]]
    specs = {"bouc_wen.alpha": None}
    monkeypatch.setattr(staircase, "widened", lambda case, fit: specs if id(fit) in resting else {})
    monkeypatch.setattr(staircase, "beyond_bounds", lambda case, first, fit: (case, wide) if fit is other else little)
    found = bounds_beside(case, first, SimpleNamespace(candidates=items, passing=[] if own else items, account=None))
    assert found == ((case, wide) if taken else little)


@pytest.mark.parametrize("others", [("resonance", "creep"), ("quadratic_gain", "creep"), None])
def test_the_best_effect_is_gone_on_with_beyond_a_bound_of_the_job_ahead_of_two_others(others):
    """Which account for all within the bounds."""
    case = lifted()
    diagnosis = diagnose(case, first := first_fit(case, 0))
    for item in diagnosis.candidates:
        item.account = None
    diagnosis.best.account = replace(first, effects=others) if others else None
    found = bounds_beside(case, first, diagnosis)
    assert (found[1].effects if found else None) == (("quadratic_gain",) if others and "resonance" in others else None)


WEIGHTS = {f"prandtl_ishlinskii.weight_{i + 1}": 4e-9 for i in range(8)}
PLAYS = {"prandtl_ishlinskii.gain": 5e-8, "prandtl_ishlinskii.reach": 30.0} | WEIGHTS  # m/V, V


@pytest.mark.parametrize("effect", [None, "quadratic_gain", "amplifier_lag"])
def test_a_value_that_the_catalogue_guesses_is_freed_before_an_effect_makes_up_for_it(effect):
    model = ("prandtl_ishlinskii",)
    case = stage.case(PLAYS | stage.EFFECTS.get(effect, {}), model=model)
    case = stage.considering(case, "quadratic_gain", "amplifier_lag", "distributed_memory", "friction")
    first = first_fit(case, 0)
    assert "prandtl_ishlinskii.reach" not in first.values and not adequate(case, first, first)
    found = improve(case, first)
    assert found.last.verdict == "adequate"
    assert found.end.values["prandtl_ishlinskii.reach"] == pytest.approx(30, rel=0.05)
    assert [*map(word_of, found.end.effects)] == ([effect] if effect else [])
    assert [step.change for step in found.steps if step.change] == [WIDER]
    assert "prandtl_ishlinskii.reach" in bounds_that_changed(case, found.end)
    assert "V, not 60 V as by default: give it bounds in the job." in narrow_bounds_sentence(case, found.end)


def test_a_value_that_the_job_gives_is_not_freed():
    case = stage.case(PLAYS, {"prandtl_ishlinskii.reach": 60.0}, model=("prandtl_ishlinskii",))
    assert freed(case, case.problem(())) == {}


def test_a_model_with_a_value_freed_is_not_that_of_the_job():
    case = stage.case(PLAYS, model=("prandtl_ishlinskii",))
    wide = case.with_specs(freed(case, case.problem(())))
    fit = continued(wide, first_fit(case, 0))
    assert brought_back(case, fit) is None and not stands_in(wide, case, fit)
    assert narrow_bounds_sentence(wide, fit) == "" and bounds_that_changed(wide, fit) == {}


def test_a_memory_that_makes_up_for_a_value_that_the_catalogue_guesses_is_exchanged_for_it():
    case, memory = stage.case(PLAYS, model=("prandtl_ishlinskii",)), "distributed_memory.fine_plays"
    first = first_fit(case, 0)
    finer = refit(case, first, (memory,), scorer_of(case, first).score(memory).guess)
    assert adequate(case, first, finer)
    steps = exchange_for_bounds(case, first, finer)
    assert [(step.change, step.removed) for step in steps] == [(WIDER, None), ("", memory)]
    assert steps[-1].fit.values["prandtl_ishlinskii.reach"] == pytest.approx(30, rel=0.05)
