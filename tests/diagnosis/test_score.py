"""Scores without a refit: sign and size of what is missing, and what the fitted parameters can do as well."""

from dataclasses import replace

import numpy as np
import pytest

import rig
import stage
from pzt_ident.diagnosis import cost
from pzt_ident.diagnosis import score as score_module
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.cost import MOST_SIMULATIONS, simulations
from pzt_ident.diagnosis.possible import applicable, fits, fitting_forms
from pzt_ident.diagnosis.refit import refit, refit_from
from pzt_ident.diagnosis.score import (
    KEPT,
    LEAST_SCORE,
    Scorer,
    scorer_of,
    squared_misfit,
)
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.trials import planned_trials
from pzt_ident.job.sections import Setting
from pzt_ident.model.block import Bank, Operator
from pzt_ident.model.registry import blocks, word_of

OPERATORS = [
    word for word in blocks.words() if issubclass(blocks[word], Operator | Bank) and not blocks.is_effect(word)
]


def scored(case, effect):
    return Scorer(case, first_fit(case, 0)).score(effect)


HIDDEN = [
    ("creep", "creep.ratio", {"creep.ratio": 0.05, "creep.tau": 1.0, "creep.decades": 4.0}, 0.6),
    ("creep", "creep.ratio", {"creep.ratio": -0.03, "creep.tau": 1.0, "creep.decades": 4.0}, 0.6),
    ("quadratic_gain", "quadratic_gain.curvature", {"quadratic_gain.curvature": 1e-4}, 0.1),
    ("quadratic_gain", "quadratic_gain.curvature", {"quadratic_gain.curvature": -1e-4}, 0.1),
    ("amplifier_lag", "amplifier_lag.tau", {"amplifier_lag.tau": 1e-3}, 0.1),
    ("asymmetry", "bouc_wen.asymmetry", {"bouc_wen.asymmetry": 8e-4}, 0.15),
    ("asymmetry", "bouc_wen.asymmetry", {"bouc_wen.asymmetry": -8e-4}, 0.15),
    ("thermal_relaxation", "bouc_wen.relaxation", {"bouc_wen.relaxation": 0.02}, 0.15),
]


@pytest.mark.parametrize(("effect", "name", "hidden", "close"), HIDDEN)
def test_the_expected_value_of_a_small_effect_has_its_sign_and_size(effect, name, hidden, close):
    score = scored(stage.case(hidden), effect)
    assert score.guess[name] == pytest.approx(hidden[name], rel=close)
    assert score.explained == pytest.approx(1, abs=0.1)
    assert 0.05 < score.visibility <= 1 + 1e-9


def test_the_trace_is_what_the_residual_lacks():
    case = stage.case(stage.EFFECTS["quadratic_gain"])
    scorer = Scorer(case, first_fit(case, 0))
    explained = scorer.score("quadratic_gain").explained
    assert np.sqrt(scorer.left**2 - explained * scorer.misfit) == pytest.approx(case.floor, rel=0.1)


STEPS = [np.repeat([0.0, *levels, 0], 300) for levels in ([20, 60, 30, 100, 50], [40, 10, 90])]
KNOWN = {"lumped.mass": 0.15, "lumped.stiffness": 7e7, "lumped.damping": 2000.0}


def test_what_a_fitted_parameter_can_do_as_well_leaves_no_trace():
    def seen(free):
        fixed = {name: value for name, value in KNOWN.items() if name != free}
        case = stage.case(KNOWN, fixed, model=("bouc_wen", "lumped"), drives=STEPS, dt=2e-5)
        return scored(case, "viscous_damping")

    known, fitted = seen(None), seen("lumped.damping")
    assert fitted.visibility < 0.05 < 0.5 < known.visibility
    assert fitted.power < 0.1 * known.power
    assert fitted.explained < 0.05


@pytest.mark.parametrize("load", [0.013, 0.209, 0.77])
def test_a_load_is_expected_within_the_breadth_of_its_resonance(load):
    """Between two resonances that do not overlap there is no slope that leads from one to the other."""
    bare = {name: value for name, value in stage.STAGE.items() if name.startswith("lumped")}
    t = np.arange(4000) * 2e-5
    sweep = 50 + 3 * np.sin(2 * np.pi * (300 * t + 0.5 * (4500 - 300) / t[-1] * t**2))
    case = stage.case({"lumped.load": load}, bare, model=("bouc_wen", "lumped"), drives=[sweep, sweep], dt=2e-5)
    mass, damping, stiffness = bare["lumped.mass"] + load, bare["lumped.damping"], bare["lumped.stiffness"]
    breadth = damping / np.sqrt(stiffness * mass)  # between the points of half power, of the frequency
    guess = scored(case, "load_mass").guess["lumped.load"]
    assert np.sqrt((bare["lumped.mass"] + guess) / mass) == pytest.approx(1, abs=breadth)


def test_an_effect_whose_null_is_on_its_bound_goes_one_way_only():
    case = stage.case(fixed={"amplifier_lag.tau": 2e-3}, effects=["amplifier_lag"])
    assert scored(case, "sensor_lag").explained == pytest.approx(0, abs=1e-12)
    score = scored(stage.case({"amplifier_lag.tau": 2e-3}), "sensor_lag")
    assert score.explained > 0.5


def test_guesses_are_within_the_bounds():
    case = stage.case(stage.EFFECTS["creep"])
    scorer = Scorer(case, first_fit(case, 0))
    for form in (form for effect in applicable(case, ()) for form in fitting_forms(case, (), effect)):
        score = scorer.score(form)
        problem = case.problem((form,))
        bounds = dict(zip(problem.names, zip(problem.lower, problem.upper, strict=True), strict=True))
        for name, value in score.guess.items():
            low, high = bounds[name]
            assert low <= value <= high, name
        assert np.isfinite(score.explained) and score.explained <= 1.1


@pytest.mark.parametrize("mechanics", [(), ("lumped",), ("modal",)], ids=" ".join)
@pytest.mark.parametrize("operator", OPERATORS)
def test_each_form_of_an_effect_is_a_model_of_its_own(operator, mechanics):
    case = stage.case().with_words((operator, *mechanics))

    def model(item):
        built = case.problem((item,)).model
        return tuple(map(built.form_of, built.blocks)), tuple(built.additions), case.problem((item,)).names

    for word in applicable(case, ()):
        forms = fitting_forms(case, (), word)
        everything = {model(item) for item in blocks.forms(word) if fits(case, (), item)}
        assert len(forms) == len(everything) and {model(item) for item in forms} == everything, word


def test_what_the_sensor_reads_is_told_from_what_is_added_where_the_sensor_has_an_error_of_its_own():
    assert "drift.read" not in fitting_forms(stage.case(), ("asymmetry",), "drift")
    assert "drift.read" in fitting_forms(stage.case(), ("encoder_cyclic_error",), "drift")


def test_what_a_record_may_add_of_its_own():
    case = stage.with_response(stage.case(), lambda r: 40e-9 * np.sin(2 * np.pi * 33.3 * r.time + len(r.name)))
    score = scored(case, "periodic_disturbance")
    assert score.explained == pytest.approx(1, abs=0.05)
    assert score.guess["periodic_disturbance.frequency"] == pytest.approx(33.3, rel=0.01)


def test_applicable_is_what_the_model_can_take_and_has_not():
    plain = applicable(stage.case(), ())
    assert "creep" in plain and "asymmetry" in plain
    assert not {"load_mass", "viscous_damping", "cross_coupling", "kinematic_coupling"} & set(plain)
    assert {"load_mass", "viscous_damping"} <= set(applicable(stage.case(model=("bouc_wen", "lumped")), ()))
    assert "creep" not in applicable(stage.case(), ("creep",))


def test_the_misfit_is_never_less_than_what_could_be_told_from_the_noise():
    case = stage.case()
    fit = first_fit(case, 0)
    assert squared_misfit(case, fit) == pytest.approx((0.3 * case.floor) ** 2)
    case = stage.case(stage.EFFECTS["quadratic_gain"])
    fit = first_fit(case, 0)
    assert squared_misfit(case, fit) == pytest.approx(fit.identify**2 - case.floor**2)


def test_power_is_what_the_strongest_plausible_effect_would_leave():
    case = stage.case()
    fit = first_fit(case, 0)
    score = Scorer(case, fit).score("amplifier_lag")
    problem = case.problem(("amplifier_lag",))
    off, full = problem.residuals(
        np.array([problem.unit_point(fit.values | {"amplifier_lag.tau": tau}) for tau in (0, 0.05)])
    )
    projection = Scorer(case, fit).projection
    left = projection.left(projection.split((full - off)[None]))[0] / case.floor
    assert score.power == pytest.approx(left, rel=0.1)


def test_a_drive_that_rests_shows_no_lag():
    still = [np.interp(np.arange(2000), [0, 900, 1000, 2000], [0, 0, level, level]) for level in (50, 80)]
    case = stage.case(drives=still, dt=1.0)
    assert scored(case, "amplifier_lag").power < 0.3


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_an_effect_of_one_axis_is_seen_though_the_other_would_have_it_below_its_null(seed):
    lagging = stage.case({"amplifier_lag.tau": 3e-3}, seed=seed)
    score = scored(stage.beside(lagging, stage.case(seed=seed + 10)), "amplifier_lag")
    assert score.explained > 0.9
    assert score.guess["x.amplifier_lag.tau"] == pytest.approx(3e-3, rel=0.3)
    assert 0 <= score.guess["y.amplifier_lag.tau"] < 1e-4


def test_every_axis_has_its_own_amounts_and_its_own_line():
    def hummed(frequency):
        return stage.with_response(stage.case(), lambda r: 30e-9 * np.sin(2 * np.pi * frequency * r.time))

    case = stage.beside(hummed(33.3), hummed(61.0))
    score = scored(case, "periodic_disturbance")
    assert score.explained == pytest.approx(1, abs=0.05)
    assert list(score.guess.values()) == pytest.approx([33.3, 61.0], rel=0.01)
    case = stage.beside(stage.case(stage.EFFECTS["creep"]), stage.case(stage.EFFECTS["creep"]))
    scorer = Scorer(case, first_fit(case, 0))
    assert scorer.score("creep").explained > 0.9
    assert len(list(planned_trials("creep", case.problem(("creep",)), scorer.fit.values, blocks["creep"].trials))) <= 36


@pytest.mark.parametrize("dt", [1e-6, 1e-3, 1.0])
def test_records_of_any_length_are_scored_and_a_line_that_they_are_too_short_for_is_not_told(dt):
    drives = [rig.path(0, top, 20, 80, 0, 0, points=80) for top in (100, 70)]
    case = stage.case(stage.EFFECTS["quadratic_gain"], drives=drives, dt=dt)
    scorer = Scorer(case, first_fit(case, 0))
    for score in (score for effect in applicable(case, ()) for score in scorer.scores(effect)):
        assert np.isfinite([score.explained, score.visibility]).all(), score.effect
    if dt == 1e-6:
        assert scorer.score("periodic_disturbance").power == 0


def test_other_forms_of_an_effect_with_many_shapes_are_tried_where_the_first_explains_something():
    """What is tried near the shapes of the first form scores as if all were tried."""
    case = stage.with_response(stage.case(), lambda r: 20e-9 * np.sin(1e6 * np.pi * r.response))
    scorer = Scorer(case, first_fit(case, 0))
    first, other, *_ = scorer.scores("encoder_cyclic_error")
    problem, tried = case.problem((other.effect,)), blocks[other.effect].trials
    counts = [
        len(list(planned_trials(other.effect, problem, scorer.fit.values, tried, near))) for near in ((), first.shapes)
    ]
    assert 0 < counts[1] < counts[0] / 4
    assert other.explained == pytest.approx(scorer.score(other.effect).explained, rel=1e-9)


def test_no_mode_is_tried_above_all_sampling_rates():
    """And where none can be below, none is seen."""
    for dt, tried in ((1e-3, True), (0.2, False)):
        case = stage.case(dt=dt)
        scorer = Scorer(case, first_fit(case, 0))
        problem = case.problem(("resonance",))
        column = problem.names.index("resonance.frequency")
        frequencies = [
            trial.start[column]
            for trial in planned_trials("resonance", problem, scorer.fit.values, blocks["resonance"].trials)
        ]
        assert bool(frequencies) == tried
        assert max(frequencies, default=0) <= 1 / dt
        assert (scorer.score("resonance").power > 0) == tried


@pytest.mark.parametrize("frequency", [31.0, 63.0, 140.0])
@pytest.mark.parametrize("damping", [0.004, 0.03, 0.2])
def test_a_mode_scores_as_if_all_its_shapes_were_tried(frequency, damping, monkeypatch):
    """Frequencies are tried with one damping first, and beside the best of them with all."""
    mode = {"resonance.share": 0.1, "resonance.frequency": frequency, "resonance.damping": damping}
    random = np.random.default_rng(4).uniform(0, 60, (2, 1500))
    drives = [np.convolve(np.repeat(steps, 4)[:1500], np.ones(3) / 3, "same") for steps in random]
    records = stage.records(mode, drives, dt=1e-3, effects=("resonance",))
    case = Case(("bouc_wen",), (), records, {})
    fit = first_fit(case, 0)
    found = Scorer(case, fit).score("resonance")
    monkeypatch.setattr(cost, "MANY_TRIALS", 1000)
    assert found.explained > 0.99 * Scorer(case, fit).score("resonance").explained > 0


@pytest.mark.parametrize("pitches", [(2.0, 3.4), (3.4, 1.7)])
def test_every_axis_has_its_own_shape(pitches):
    """Two gratings, which the same trial of both axes does not hold."""

    def read(pitch):
        return stage.with_response(stage.case(), lambda r: 50e-9 * np.sin(2e6 * np.pi * r.response / pitch))

    case = stage.beside(*map(read, pitches))
    score = scored(case, "encoder_cyclic_error")
    assert score.explained > 0.9
    found = [value for name, value in score.guess.items() if name.endswith("pitch")]
    assert found == pytest.approx(pitches, rel=0.05)


def test_what_lies_beyond_the_bounds_is_not_promised():
    """A lag of 0.12 s, where 50 ms are plausible: as if linear it explains nearly all."""
    score = scored(stage.case({"sensor_lag.tau": 0.12}), "sensor_lag")
    assert score.guess["sensor_lag.tau"] == pytest.approx(0.05)
    assert score.explained_in_bounds < 0.9 * score.explained
    within = scored(stage.case({"sensor_lag.tau": 3e-3}), "sensor_lag")
    assert within.explained_in_bounds == within.explained


LATE = {
    "delay": {"delay.time": 2e-3},
    "amplifier_lag": {"amplifier_lag.tau": 1e-3},
    "sensor_lag": {"sensor_lag.tau": 5e-4},
}
SHEET = {
    "lumped.mass": Setting(bounds=(0.1, 0.3)),
    "lumped.damping": Setting(bounds=(300, 1000)),
    "lumped.stiffness": Setting(bounds=(4e7, 6e7)),
}
TIMES = np.arange(4000) * 5e-4
DRIVES = [40 * (1 - np.cos(2 * np.pi * (3 * TIMES + rate * TIMES**2))) for rate in (6, 4)]


@pytest.mark.parametrize("effect", LATE)
def test_an_effect_is_seen_behind_a_parameter_that_ends_on_its_bound(effect):
    """A damping or a stiffness that these drives do not determine imitates a lag as far as its bounds allow, and no
    further. Damped, since a mode that rings at the sampling rate would imitate it better."""
    stiff = {"lumped.mass": 0.2, "lumped.damping": 500.0, "lumped.stiffness": 5e7}
    model = ("bouc_wen", "lumped")
    case = Case(model, (), stage.records(LATE[effect] | stiff, DRIVES, dt=5e-4, model=model, effects=LATE), SHEET)
    fit = first_fit(case, 0)
    assert {"lumped.damping", "lumped.stiffness"} & set(fit.on_bounds)
    assert Scorer(case, fit).score(effect).explained > 0.9


def rippled_case(dt=2e-3, volts=0.5, frequency=23.0):
    """A stage whose amplifier adds a ripple to the drive that is recorded, in another phase each time."""
    clean, wave = stage.loops(), 2 * np.pi * frequency * dt
    waves = [volts * np.sin(wave * np.arange(u.size) + turn) for turn, u in zip((1, 4), clean, strict=True)]
    made = stage.case(drives=[u + wave for u, wave in zip(clean, waves, strict=True)], dt=dt)
    records = [replace(record, drive=u[None]) for record, u in zip(made.records, clean, strict=True)]
    return Case(made.words, made.effects, records, made.specs)


def test_a_ripple_that_the_hysteresis_bends_scores_more_than_a_line_on_the_reading():
    case = rippled_case()
    line, *_, ripple = Scorer(case, first_fit(case, 0)).scores("periodic_disturbance")
    assert ripple.guess["periodic_disturbance.frequency"] == pytest.approx(23, abs=0.05)
    assert ripple.explained > 0.9 > line.explained + 0.1


def test_a_ripple_is_scored_where_a_line_on_the_reading_explains_little(monkeypatch):
    """What shakes the hysteresis may be far too small to be read."""
    case = stage.case(stage.EFFECTS["amplifier_lag"])
    monkeypatch.setattr(score_module, "LEAST_SCORE", 0.1)
    first, *others = Scorer(case, first_fit(case, 0)).scores("periodic_disturbance")
    assert first.explained < 0.1
    assert [score.effect for score in others] == ["periodic_disturbance.ripple"]


def test_mains_that_explain_nearly_as_much_are_all_refitted():
    """What a ripple does to the hysteresis tells little of its frequency."""
    case = rippled_case(frequency=60.0)
    first = first_fit(case, 0)
    score = Scorer(case, first).score("periodic_disturbance.ripple")
    assert 60 in [guess["periodic_disturbance.frequency"] for guess in score.guesses]
    fit = refit_from(case, first, (score.effect,), score.guesses)
    assert fit.values["periodic_disturbance.frequency"] == pytest.approx(60, abs=0.02)


def test_beside_a_ripple_that_is_explained_nothing_is_left_to_score():
    case = rippled_case()
    known = {"periodic_disturbance.frequency": 23.0}
    fit = refit(case, first_fit(case, 0), ("periodic_disturbance.ripple",), known)
    assert fit.validate < 1.1 * case.floor
    scorer = Scorer(case, fit)
    scores = [score for word in applicable(case, fit.effects) for score in scorer.scores(word)]
    assert all(score.explained * scorer.misfit < case.floor**2 for score in scores)


def test_the_scales_of_a_guess_are_swept_only_where_an_effect_may_be_refitted(monkeypatch):
    """What scores less has a guess nevertheless: a look-alike may be refitted from it."""
    case, swept = stage.case(stage.EFFECTS["creep"]), set[str]()
    scorer = Scorer(case, first_fit(case, 0))
    for effect in [word for word in applicable(case, ()) if not blocks[word].amounts()]:
        with monkeypatch.context() as patched:
            patched.setattr(
                score_module, "scales_of", lambda amounts, effect=effect: swept.add(effect) or amounts[None]
            )
            scorer.scores(effect, in_every_form=False)
    scores = {word: score for word, score in scorer._scores.items() if score.explained > 0}
    assert swept == {word_of(item) for item, score in scores.items() if score.explained > LEAST_SCORE}
    assert "creep" in swept and len(scores) > len(swept)
    assert all(score.guess for score in scores.values())


def test_no_effect_is_scored_twice_beside_one_fit(monkeypatch):
    case = stage.case({})
    fit = first_fit(case, 0)
    scores = scorer_of(case, fit).scores("creep")
    monkeypatch.setattr(Scorer, "_best_score", None)
    assert all(new is old for new, old in zip(scorer_of(case, fit).scores("creep"), scores, strict=True))
    assert scorer_of(case, fit).scores("creep", in_every_form=False) == scores[:1]
    assert scorer_of(case, replace(fit)) is not scorer_of(case, fit)


def test_the_scorers_of_the_last_fits_are_kept():
    case = stage.case({})
    fits = [first_fit(case, 0), *(replace(first_fit(case, 0)) for _ in range(KEPT))]
    first, *others = (scorer_of(case, fit) for fit in fits)
    assert all(scorer_of(case, fit) is kept for fit, kept in zip(fits[1:], others, strict=True))
    assert scorer_of(case, fits[0]) is not first


@pytest.mark.parametrize("slowness", [5e-5, 1e-4, 2e-4])
@pytest.mark.parametrize("over", [1.1, 1.3])
def test_a_limit_that_is_just_exceeded_is_guessed_where_it_is(over, slowness):
    """In proportion to the trace of a larger one it would be far below the rates of the drive."""
    pace, t = over / (50 * slowness), 1e-4 * np.arange(3000)
    drives = [50 - 50 * np.cos(rate * t) * np.linspace(1, 0.5, t.size) for rate in (pace, 0.9 * pace)]
    hidden = {"slew_limit.slowness": slowness}
    case = Case(("bouc_wen",), (), stage.records(hidden, drives=drives, dt=1e-4, effects=["slew_limit"]), {})
    score = scored(case, "slew_limit")
    assert score.guess["slew_limit.slowness"] == pytest.approx(slowness, rel=0.03)


@pytest.mark.parametrize("axes", [2, 3])
def test_a_form_that_takes_too_many_simulations_is_not_scored_beside_the_first(axes):
    """A resonance for each pair of three measured axes: six pairs at 480 shapes."""
    pair, one = stage.beside(stage.case(), stage.case(seed=2)), stage.case(seed=3)
    records = [
        replace(
            record,
            axes=("x", "y", "z"),
            drive=np.vstack([record.drive, alone.drive]),
            response=np.vstack([record.response, alone.response]),
            drive_units=("V",) * 3,
            response_units=("um",) * 3,
        )
        for record, alone in zip(pair.records, one.records, strict=True)
    ]
    case = pair if axes == 2 else Case(pair.words, (), records, pair.specs)
    most = max(simulations(case, item) for item in blocks.forms("cross_coupling"))
    assert (most < MOST_SIMULATIONS) == (axes == 2)
    assert all(simulations(case, word) < MOST_SIMULATIONS for word in ("resonance", "encoder_cyclic_error"))
