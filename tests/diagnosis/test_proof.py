"""What is proven is decisive beside the rest, on all records, where the model stays above the noise."""

from types import SimpleNamespace

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis import proof
from pzt_ident.diagnosis.bounds import Widened
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.limit import settle_beyond
from pzt_ident.diagnosis.proof import taken_out, unproven
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks

CASE = SimpleNamespace(floor=1.0, on_axis=lambda axis: CASE, shares={})


def fit(identify, validate, effects=(), shapes=None, dimensions=4, felt=True, **declared):
    """shapes: the places in its range, one an axis, of a parameter of some effects, which has no null unless one is
    declared. felt: whether the model is worse elsewhere."""
    places = {(axis, effect): place for effect, own in (shapes or {}).items() for axis, place in enumerate(own)}
    entries = [
        SimpleNamespace(parameter=Parameter("1", (0, 1), "", **declared), block=SimpleNamespace(name=effect), word="s")
        for _, effect in places
    ]
    problem = SimpleNamespace(
        dimensions=dimensions,
        names=[f"{axis}.{effect}.shape" for axis, effect in places],
        free=range(len(places)),
        model=SimpleNamespace(entries=entries, measured=(), amounts=(), additions=()),
        physical=np.atleast_2d,
        loss=lambda point: np.array([identify * (2 if felt else 1)]),
    )
    return Fit(tuple(effects), problem, np.array([*places.values()], float), identify, validate)


@pytest.fixture(name="taken_out")
def suspects_of(monkeypatch):
    """The suspects among some effects, given the error of a model without each set of them."""

    def of(
        errors,
        validation=None,
        first=30.0,
        rivals=None,
        known=(),
        shapes=None,
        sizes=None,
        larger=(),
        instead=(),
        lines=(),
        harmonics=(),
        traces=(),
        many=(),
        flexible=(),
        alone=None,
        coarse=(),
        curves=(),
        **declared,
    ):
        """sizes: the parameters of a model without each effect. larger: those that would settle beyond their bounds.
        instead: those that take the place of the operator. lines: those of the spectrum. harmonics: those of the drive.
        traces: those that others leave. many: those with many amounts. flexible: those that follow anything. alone:
        shapes as of `fit` where no other effect is left. coarse: those with which the simulation is too coarse.
        curves: lines of few periods in the stroke. declared: of the parameters with shapes."""
        validation = validation or errors
        operator = lambda case, first, now, effect: "bouc_wen" if effect in instead else ""  # noqa: E731
        monkeypatch.setattr(proof, "displaced_operator", operator)
        monkeypatch.setattr(proof, "harmonic_of", lambda now, effect: "the drive's" if effect in harmonics else "")
        monkeypatch.setattr(proof, "size_of", lambda now, effect: "")
        monkeypatch.setattr(proof, "curve_of", lambda now, effect: "a curve" if effect in curves else "")
        monkeypatch.setattr(proof, "is_trace", lambda effect, others: effect in traces and bool(others))
        monkeypatch.setattr(proof, "is_of_many", many.__contains__)
        monkeypatch.setattr(proof, "change_if_too_coarse", lambda case, fit: float(bool({*fit.effects} & {*coarse})))
        monkeypatch.setattr(proof, "is_flexible", flexible.__contains__)
        monkeypatch.setattr(proof, "is_own_line", lambda case, without, now, effect: effect in lines)

        def refitted(case, before, effects, guess):
            left = frozenset(effects)
            size = sum((sizes or {}).get(effect, 1) for effect in left)
            own = alone if len(left) == 1 else None
            return fit(errors[left], validation[left], effects, own, size, **(declared if own else {}))

        monkeypatch.setattr(proof, "refit", refitted)
        settle = lambda case, fit, names: {name.split(".")[1] for name in names} <= {*larger}  # noqa: E731
        monkeypatch.setattr(proof, "settle_beyond", settle)
        by_record = proof.differs_by_record
        monkeypatch.setattr(proof, "differs_by_record", lambda effect: len(effect) > 1 and by_record(effect))
        every = max(errors, key=len)
        now = fit(errors[every], validation[every], sorted(every), shapes, **declared)
        given = fit(*first) if isinstance(first, tuple) else fit(first, first)
        return [item.effect for item in unproven(CASE, given, now, rivals or {}, known)]

    return of


def of(**errors):
    """`a=`, `ab=`: by the letters of the effects; `none` has none."""
    return {frozenset("" if word == "none" else word): error for word, error in errors.items()}


@pytest.mark.parametrize(
    ("coarse", "left", "suspects"), [("b", 5.0, ["b"]), ("", 5.0, []), ("b", 1.1, []), ("a", 5.0, ["b", "a"])]
)
def test_what_is_simulated_too_coarsely_proves_nothing(taken_out, coarse, left, suspects):
    seen = of(ab=left, a=25.0, b=20.0, none=300.0)
    assert taken_out(seen, first=300.0, coarse=coarse) == suspects


def test_what_takes_up_less_than_a_third_of_a_rest_is_a_suspect(taken_out):
    assert taken_out(of(ab=5.0, a=5.9, b=25.0, none=300.0)) == ["b"]
    assert taken_out(of(ab=5.0, a=6.2, b=25.0, none=300.0)) == []


def test_one_removes_90_percent_of_what_there_was_and_two_together_seven_eighths(taken_out):
    assert taken_out(of(a=9.5, none=30.0)) == []
    assert taken_out(of(a=9.6, none=30.0)) == ["a"]
    assert taken_out(of(ab=10.6, a=13.0, b=13.5, none=30.0)) == []
    assert taken_out(of(ab=10.7, a=13.0, b=13.5, none=30.0)) == ["b", "a"]


@pytest.mark.parametrize(
    ("effect", "left", "others", "suspects"),
    [
        ("delay", 17.0, {"rate_dependence": 0.3, "sensor_lag": 0.68}, []),  # two thirds, and nothing else explains 0.34
        ("delay", 17.0, {"rate_dependence": 0.4}, ["delay"]),
        ("delay", 22.0, {"rate_dependence": 0.1}, ["delay"]),  # less than half
        ("delay", 17.0, {}, ["delay"]),  # nothing is known of others
        ("creep", 17.0, {"drift": 0.6}, ["creep"]),  # its look-alike follows any slow misfit
        ("periodic_disturbance", 17.0, {"creep": 0.1}, ["periodic_disturbance"]),  # has amounts of each record
    ],
)
def test_one_without_equal_removes_half(taken_out, monkeypatch, effect, left, others, suspects):
    monkeypatch.setattr(CASE, "shares", others)
    monkeypatch.setattr(proof, "differs_by_record", lambda effect: False)
    seen = {frozenset([effect]): left, frozenset(): 30.0}
    assert taken_out(seen, flexible=["drift"]) == suspects


@pytest.mark.parametrize(
    ("tied", "lag", "suspects"),
    [(["delay", "sensor_lag"], 0.1, []), (["delay"], 0.66, []), (["delay"], 0.6, ["delay"])],
)
def test_what_is_alike_to_a_tied_effect_or_one_that_explains_as_much_is_no_rival(
    taken_out, monkeypatch, tied, lag, suspects
):
    monkeypatch.setattr(CASE, "shares", {"resonance": 0.6, "sensor_lag": lag})
    seen = {frozenset(["delay"]): 17.0, frozenset(): 30.0}
    assert taken_out(seen, rivals={"delay": tied}) == suspects


def test_what_one_axis_lacks_is_judged_without_the_shares_of_all():
    """What explains all that one axis lacks may be little of both."""
    case = stage.beside(stage.case(), stage.case())
    case.shares = {"creep": 0.05}
    assert case.on_axis(None).shares and not case.on_axis(0).shares


def test_one_with_many_amounts_removes_95_percent_if_it_is_alone(taken_out):
    assert taken_out(of(a=6.7, none=30.0), many="a") == []
    assert taken_out(of(a=6.9, none=30.0), many="a") == ["a"]
    assert taken_out(of(ab=10.6, a=13.0, b=13.5, none=30.0), many="a") == []


def test_what_is_flexible_is_proven_only_at_the_noise_or_if_it_takes_up_nearly_all(taken_out):
    """It bends to the records kept back as well."""
    assert taken_out(of(ab=1.3, a=20.0, b=20.0, none=30.0)) == []
    assert taken_out(of(ab=1.3, a=20.0, b=20.0, none=30.0), flexible="b") == []
    assert taken_out(of(ab=2.5, a=20.0, b=20.0, none=30.0)) == []
    assert taken_out(of(ab=2.5, a=5.0, b=20.0, none=30.0)) == []
    assert taken_out(of(ab=2.5, a=5.0, b=20.0, none=30.0), flexible="b") == ["b"]
    assert taken_out(of(ab=2.5, a=20.0, b=20.0, none=30.0), flexible="b") == []


def test_only_a_drift_of_any_course_is_flexible():
    assert [item for item in blocks.effects() for item in blocks.forms(item) if proof.is_flexible(item)] == [
        "drift.curve"
    ]


def test_a_density_of_plays_has_many_amounts():
    assert proof.is_of_many("distributed_memory.bent_plays") and not proof.is_of_many("drift")


@pytest.mark.parametrize(
    ("validate", "left", "suspects"), [(10.0, 7.0, []), (10.0, 7.2, ["a"]), (30.0, 12.4, []), (30.0, 12.6, ["a"])]
)
def test_it_is_90_percent_of_all_records_together_and_half_of_each_kind(taken_out, validate, left, suspects):
    """Of the identification records it leaves 5 of 30."""
    seen, unseen = of(a=5.0, none=30.0), of(a=left, none=validate)
    assert taken_out(seen, unseen, first=(30.0, validate)) == suspects


def test_a_refit_that_ended_with_the_budget_proves_nothing_beside_a_known_fit(taken_out):
    assert taken_out(of(a=7.0, none=50.0)) == []
    assert taken_out(of(a=7.0, none=50.0), known=[fit(8.0, 8.0), fit(2.0, 2.0, "b")]) == ["a"]


@pytest.mark.parametrize(
    ("places", "left", "suspects"),
    [
        ([1.0], 5.0, ["a"]),
        ([0.0], 5.0, ["a"]),
        ([0.9], 5.0, []),
        ([1.0], 1.4, []),
        ([0.0, 1.0], 5.0, ["a"]),
        ([0.0, 0.9], 5.0, []),
    ],
)
def test_above_the_noise_what_has_the_shape_of_its_limit_on_all_axes_is_a_suspect(taken_out, places, left, suspects):
    seen = of(ab=left, a=20.0, b=25.0, none=300.0)
    assert taken_out(seen, first=300.0, shapes={"a": places, "b": [0.5]}) == suspects


@pytest.mark.parametrize(("place", "suspects"), [(1.0, ["a"]), (0.9, [])])
def test_near_the_noise_of_a_model_that_is_not_adequate_what_has_the_shape_of_its_limit_is_a_suspect(
    taken_out, place, suspects
):
    seen = of(ab=1.4, a=4.0, b=2.8, none=12.0)
    assert taken_out(seen, first=12.0, shapes={"a": [place], "b": [0.5]}) == suspects


@pytest.mark.parametrize(("place", "suspects"), [(0.0, ["drift"]), (0.5, [])])
def test_above_the_noise_what_has_the_shape_of_its_limit_is_a_suspect_though_each_record_has_its_own_amount(
    taken_out, place, suspects
):
    seen = {frozenset(): 300.0, frozenset(["drift"]): 20.0, frozenset("b"): 25.0, frozenset(["drift", "b"]): 5.0}
    assert taken_out(seen, first=300.0, shapes={"drift": [place], "b": [0.5]}) == suspects


@pytest.mark.parametrize(
    ("places", "left", "suspects"),
    [
        ([1.0, 1.0], 9.0, ["a"]),
        ([1.0, 0.9], 9.0, []),
        ([1.0, 0.0], 9.0, []),
        ([0.0, 0.0], 9.0, []),
        ([1.0, 1.0], 1.2, []),
    ],
    ids=["above the noise", "one axis shows it", "one axis has none", "at its null", "at the noise"],
)
def test_above_the_noise_what_is_as_large_as_the_bounds_allow_on_all_axes_is_a_suspect(
    taken_out, places, left, suspects
):
    assert taken_out(of(none=30, a=left), shapes={"a": places}, null=0) == suspects
    assert taken_out(of(none=30, a=left), shapes={"a": places}, null=0, larger="a") == []


@pytest.mark.parametrize(
    ("name", "bound", "times", "settles"),
    [
        ("quadratic_gain.curvature", 0.5 / 120, 1.1, True),
        ("quadratic_gain.curvature", 0.5 / 120, 3.0, False),
        ("sensor_lag.tau", 0.05, 1.4, True),
        ("sensor_lag.tau", 0.05, 4.0, False),
        ("creep.ratio", -0.1, 1.4, False),
    ],
)
def test_what_is_a_little_larger_than_the_catalogue_expects_settles_beyond_its_bound_but_not_of_the_wrong_sign(
    name, bound, times, settles
):
    effect = name.split(".")[0]
    case = stage.case(stage.EFFECTS.get(effect, {}) | {name: times * bound})
    now = refit(case, first_fit(case, 0), (effect,), {name: 0.9 * bound})
    assert name in now.on_bounds
    assert settle_beyond(case, now, [name]) == settles
    assert not settle_beyond(case.with_specs({name: Widened((min(bound, 0.0), max(bound, 0.0)))}), now, [name])


@pytest.mark.parametrize(("alone", "suspects"), [(20.0, ["a"]), (5.5, ["b", "a"])])
def test_beside_what_takes_up_most_and_may_be_something_else_another_effect_is_proven(taken_out, alone, suspects):
    """Without the first one, the second takes up a hundredth. alone: the error of the first one."""
    seen = of(ab=5.0, a=alone, b=38.8, none=39.0)
    assert taken_out(seen, first=39.0, shapes={"a": [1.0], "b": [0.5]}, null=0) == suspects


@pytest.mark.parametrize(("place", "suspects"), [(1.0, ["a", "b"]), (0.5, ["a"])])
def test_what_is_on_a_bound_once_another_effect_is_taken_out_is_a_suspect_too(taken_out, place, suspects):
    """As a creep of the wrong sign beside a drift that ended on its bound."""
    seen, shapes = of(ab=5.0, a=20.0, b=25.0, none=300.0), {"a": [1.0], "b": [0.5]}
    assert taken_out(seen, first=300.0, shapes=shapes, alone={"b": [place]}) == suspects


@pytest.mark.parametrize(("left", "alone", "suspects"), [(5.0, 5.2, ["a"]), (5.0, 250.0, ["a", "b"]), (1.1, 250.0, [])])
def test_above_the_noise_what_takes_the_place_of_the_operator_is_out_before_others_are_judged(
    taken_out, left, alone, suspects
):
    """alone: the error of the second effect, beside which that of the first with another operator was judged."""
    seen = of(ab=left, a=40.0, b=alone, none=300.0)
    assert taken_out(seen, first=300.0, instead=["a"]) == suspects


def test_a_shape_that_is_not_felt_is_in_no_limit(taken_out):
    """A Stribeck velocity without stiction."""
    seen = of(ab=5.0, a=20.0, b=25.0, none=300.0)
    assert taken_out(seen, first=300.0, shapes={"a": [1.0], "b": [0.5]}, felt=False) == []


@pytest.mark.parametrize("place", [0.0, 1.0])
def test_an_amount_on_any_bound_may_be_in_a_limit(taken_out, place):
    assert taken_out(of(none=30, a=1.2), shapes={"a": [place]}, null=0.5, limit="the main mode") == ["a"]


@pytest.mark.parametrize(("left", "place", "suspects"), [(1.2, 0.0, ["a"]), (1.2, 1.0, []), (1.2, 0.1, [])])
def test_at_the_noise_too_what_is_in_a_limit_that_is_something_else_is_a_suspect(taken_out, left, place, suspects):
    """Friction whose reach ends on its lower bound is a play, as a backlash is."""
    assert taken_out(of(none=30, a=left), shapes={"a": [place]}, limit="a play") == suspects
    assert taken_out(of(none=30, a=left), shapes={"a": [place]}) == []


@pytest.mark.parametrize(("left", "share"), [(0.125, 1 / 3), (0.15, 0.4), (0.187, 1 / 2)])
def test_of_two_that_leave_more_each_must_remove_more_beside_the_other(taken_out, left, share):
    given = 400.0

    def errors(removed):
        both = given * left**0.5
        alone = both / (1 - removed) ** 0.5
        return of(ab=both, a=alone, b=1.02 * alone, none=given)

    assert taken_out(errors(share + 0.01), first=given) == []
    assert taken_out(errors(share - 0.01), first=given)[:1] == ["b"]


@pytest.mark.parametrize(("left", "suspects"), [(0.187, []), (0.19, ["b", "a"])])
def test_of_two_that_leave_a_fifth_none_is_proven_whatever_each_removes_beside_the_other(taken_out, left, suspects):
    both = 400.0 * left**0.5
    assert taken_out(of(ab=both, a=2.0 * both, b=2.1 * both, none=400.0), first=400.0) == suspects


def test_what_a_model_at_the_noise_has_is_needed_if_the_form_of_the_others_would_not_leave_as_much(taken_out):
    assert taken_out(of(ab=1.0, a=1.9, b=6.0, none=30.0)) == []
    assert taken_out(of(ab=1.1, a=1.75, b=6.0, none=30.0)) == ["b"]
    assert taken_out(of(ab=1.0, a=1.2, b=2.0, none=2.5), first=2.5) == []
    assert taken_out(of(ab=1.0, a=1.05, b=2.0, none=2.5), first=2.5) == ["b"]


def test_the_form_of_the_others_is_held_against_each_kind_of_record(taken_out):
    seen = of(ab=1.0, a=1.9, b=6.0, none=30.0)
    assert taken_out(seen, of(ab=1.0, a=1.9, b=6.0, none=30.0)) == []
    assert taken_out(seen, of(ab=1.6, a=1.9, b=6.0, none=30.0)) == ["b"]
    assert taken_out(seen, of(ab=1.5, a=1.9, b=6.0, none=30.0)) == []  # most of what is left of them
    assert taken_out(seen, of(ab=1.0, a=1.0, b=6.0, none=30.0)) == []  # nor can it be seen there
    assert taken_out(of(ab=1.2, a=6.0, b=6.0, none=30.0), of(ab=1.4, a=1.4, b=6.0, none=30.0)) == []
    assert taken_out(of(ab=1.2, a=6.0, b=6.0, none=30.0), of(ab=1.6, a=1.6, b=6.0, none=30.0)) == ["b"]


def test_what_takes_up_nearly_all_of_a_rest_of_both_kinds_is_no_form_of_the_others(taken_out):
    seen = of(ab=1.0, a=1.6, b=6.0, none=30.0)
    assert taken_out(seen) == []
    assert taken_out(seen, of(ab=1.1, a=1.6, b=6.0, none=30.0)) == ["b"]
    assert taken_out(of(ab=1.0, a=1.3, b=6.0, none=30.0)) == ["b"]


def test_what_brings_unseen_records_to_the_noise_need_not_show_as_much_on_those_it_was_fitted_to(taken_out):
    """A slew limit that one record drives into, which was kept back."""
    unseen = of(ab=1.0, a=7.0, b=6.0, none=30.0)
    assert taken_out(of(ab=1.0, a=1.3, b=6.0, none=30.0), unseen) == []
    assert taken_out(of(ab=1.0, a=1.04, b=6.0, none=30.0), unseen) == ["b"]
    assert taken_out(of(ab=3.0, a=3.1, b=6.0, none=30.0), of(ab=3.0, a=7.0, b=6.0, none=30.0)) == ["b"]


def test_what_an_effect_of_another_kind_would_take_up_as_well_is_a_suspect_above_the_noise(taken_out):
    lag, creep, delay = "amplifier_lag", "creep", "delay"
    high = {frozenset(): 300.0, frozenset([lag]): 8.0, frozenset([creep]): 29.0, frozenset([lag, creep]): 5.0}
    assert taken_out(high, rivals={creep: (creep, "drift"), lag: (lag, delay)}) == []
    assert taken_out(high, rivals={creep: (creep, "friction"), lag: (lag, delay)}) == [creep]
    assert taken_out(high | {frozenset([lag, creep]): 1.0}, rivals={creep: (creep, "friction")}) == []


def test_one_record_without_an_effect_of_which_each_has_its_own_amount_says_nothing_against_it(taken_out):
    """Of the first record a drift takes up four fifths, of the second nothing."""
    for effect, out in (("drift", []), ("creep", ["creep"])):
        both = frozenset(["saturation", effect])
        seen = {frozenset(): 300.0, frozenset([effect]): 40.0, frozenset(["saturation"]): 12.0, both: 5.0}
        unseen = {frozenset(): 300.0, frozenset([effect]): 40.0, frozenset(["saturation"]): 6.0, both: 5.95}
        assert taken_out(seen, unseen) == out


def test_one_after_the_other_is_taken_out_the_least_first(taken_out):
    assert taken_out(of(ab=20.0, a=21.0, b=22.0, none=23.0)) == ["b", "a"]


@pytest.mark.parametrize(("without", "suspect"), [(1.17, "b"), (1.21, "b"), (1.4, "a")])
def test_of_two_without_which_a_model_fits_as_well_the_one_with_more_parameters_is_taken_out(
    taken_out, without, suspect
):
    """b has five parameters, a one; neither takes up more than the form of c may leave."""
    seen = of(abc=0.95, bc=1.17, ac=without, ab=20.0, a=20.0, b=20.0, c=20.0, none=30.0)
    assert taken_out(seen, sizes={"b": 5}) == [suspect]


def test_records_that_were_kept_back_must_show_it_too(taken_out):
    seen, unseen = of(ab=5.0, a=20.0, b=8.0, none=300.0), of(ab=5.0, a=20.0, b=5.5, none=300.0)
    assert taken_out(seen, unseen) == ["a"]


def test_what_is_near_the_noise_is_not_held_against_a_floor_that_may_be_too_low(taken_out):
    assert taken_out(of(ab=1.45, a=2.1, b=5.0, none=30.0)) == []
    assert taken_out(of(ab=1.55, a=1.8, b=5.0, none=30.0)) == ["b"]


@pytest.mark.parametrize(("curvature", "suspects"), [(stage.EFFECTS["quadratic_gain"], []), (8e-5, ["quadratic_gain"])])
def test_what_is_clear_on_one_axis_is_proven_whatever_another_lacks(curvature, suspects):
    """y wanders, on the records kept back above all, as no effect explains; a little of x may be anything."""

    def wander(record):
        steps = np.random.default_rng(5).normal(0, 1, record.drive.shape[1])
        size = {"identify": 5, "validate": 100}[record.use] * stage.NOISE
        return size * np.interp(np.arange(steps.size), np.arange(0, steps.size, 50), steps[::50])

    size = curvature if isinstance(curvature, dict) else {"quadratic_gain.curvature": curvature}
    bent, wandering = stage.case(size), stage.with_response(stage.case(seed=9), wander)
    case = stage.beside(bent, wandering)
    first = first_fit(case, 0)
    now = refit(case, first, ("quadratic_gain",), {"x.quadratic_gain.curvature": 3e-4})
    assert [item.effect for item in taken_out(case, first, now, {}, ())] == ["quadratic_gain"]
    assert [item.effect for item in unproven(case, first, now, {})] == suspects
    alone = refit(case, first, ("drift",), {})
    assert [item.effect for item in unproven(case, first, alone, {})] == ["drift"]


@pytest.mark.parametrize(("rest", "suspects"), [(0.0, []), (2.0, ["quadratic_gain"])])
def test_what_has_many_amounts_is_proven_on_one_axis_only_at_its_noise(monkeypatch, rest, suspects):
    """rest: of x, in noise floors, root mean square, which a bend of many amounts would leave; y wanders."""

    def wander(size, record):
        steps = np.random.default_rng(5).normal(0, 1, record.drive.shape[1])
        return size * stage.NOISE * np.interp(np.arange(steps.size), np.arange(0, steps.size, 50), steps[::50])

    bent = stage.with_response(stage.case({"quadratic_gain.curvature": 1e-3}), lambda record: wander(rest, record))
    case = stage.beside(bent, stage.with_response(stage.case(seed=9), lambda record: wander(30.0, record)))
    first = first_fit(case, 0)
    now = refit(case, first, ("quadratic_gain",), {"x.quadratic_gain.curvature": 1e-3})
    monkeypatch.setattr(proof, "is_of_many", lambda effect: True)
    assert [item.effect for item in unproven(case, first, now, {})] == suspects


def test_a_line_of_the_spectrum_is_proven_beside_any_rest(taken_out):
    errors = of(none=30, a=25, b=27, ab=22)
    assert {*taken_out(errors)} == {"a", "b"}
    assert taken_out(errors, lines=["a"]) == ["b"]


def test_a_harmonic_of_the_drive_is_none_even_where_the_model_is_adequate(taken_out):
    assert taken_out(of(none=30, a=1.0)) == []
    assert taken_out(of(none=30, a=1.0), harmonics=["a"]) == ["a"]


@pytest.mark.parametrize(("left", "suspects"), [(1.0, []), (2.0, ["a"])])
def test_a_line_of_few_periods_in_the_stroke_is_one_only_where_the_model_is_adequate(taken_out, left, suspects):
    assert taken_out(of(none=30, a=left)) == []
    assert taken_out(of(none=30, a=left), curves=["a"], lines=["a"]) == suspects


def test_what_is_something_else_is_taken_out_ahead_of_what_takes_up_less(taken_out):
    """Far from the noise too, where all are judged and the least of them is enough."""
    errors = of(none=30, a=8.0, b=9.0, ab=2.5)
    assert taken_out(errors) == []
    assert taken_out(errors, curves=["a"])[-1:] == ["a"] and taken_out(errors, curves=["b"])[-1:] == ["b"]


@pytest.mark.parametrize(("alone", "suspects"), [(4.0, ["b", "a"]), (20.0, ["a"])])
def test_what_is_little_beside_something_else_may_be_what_its_form_leaves(taken_out, alone, suspects):
    """alone: the error beside a play, of 30 noise floors, without the second effect."""
    seen = of(ab=1.2, a=alone, b=30.0, none=30.0 if alone < 10 else 36.0)
    assert taken_out(seen, shapes={"a": [0.0]}, limit="a play", first=60.0) == suspects
    assert taken_out(seen, shapes={"a": [0.0]}, limit="a play", first=60.0, lines=["b"]) == ["a"]


@pytest.mark.parametrize(("left", "suspects"), [(3.5, ["a"]), (5.0, [])])
def test_what_the_form_of_another_leaves_is_proven_only_as_if_it_were_alone(taken_out, left, suspects):
    """At the noise too: a of a gain by the swing beside b of a memory, which leaves 3.5 or 5 floors alone."""
    errors = of(ab=1.6, a=20.0, b=left, none=30.0)
    assert taken_out(errors) == []
    assert taken_out(errors, traces="a") == suspects


def test_a_memory_leaves_a_gain_by_the_swing_and_a_bend_another():
    assert proof.is_trace("amplitude_gain.span", ("creep", "distributed_memory.fine_plays"))
    assert proof.is_trace("saturation", ("cubic_stiffness.rest",)) and proof.is_trace(
        "cubic_stiffness", ("saturation",)
    )
    assert not proof.is_trace("distributed_memory", ("amplitude_gain",)) and not proof.is_trace("amplitude_gain", ())
