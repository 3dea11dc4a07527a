"""Fits from random points, and of one block anew."""

from dataclasses import replace

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis import starts
from pzt_ident.diagnosis.bounds import Widened
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import removed_rms
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.possible import fits
from pzt_ident.diagnosis.refit import FINEST, STEP_TOLERANCE, step_errors
from pzt_ident.diagnosis.starts import (
    STARTS_SOLVED,
    at_a_glance,
    best_exchange,
    best_of,
    first_fit,
    places_of_nulls,
    random_points,
    ranked_points,
    restart,
    restarts,
)
from pzt_ident.job.sections import Choice
from pzt_ident.model.registry import blocks
from pzt_ident.search.descent import descend
from pzt_ident.search.problem import Problem


def test_the_first_fit_finds_the_stage(plain):
    fit = first_fit(plain, 0)
    assert fit.converged
    assert fit.identify == pytest.approx(stage.NOISE, rel=0.1)
    assert fit.validate == pytest.approx(stage.NOISE, rel=0.1)
    assert fit.values["bouc_wen.gain"] == pytest.approx(0.082, rel=0.01)
    assert fit.values["bouc_wen.alpha"] == pytest.approx(0.55, rel=0.05)


PLAIN = stage.case()


@pytest.mark.parametrize("item", [item for item in blocks.effects() if fits(PLAIN, (), item)])
def test_effects_of_the_job_begin_near_their_nulls_or_anywhere(item):
    """A delay of a tenth of the drive's period is found by its slope, one of several periods is not."""
    problem = PLAIN.problem((item,))
    places, points = places_of_nulls(problem), ranked_points(problem, 1, 400)
    nulls = [problem.model.entries[column].parameter.null for column in problem.free]
    values = problem.physical(np.nan_to_num(places, nan=0.5))[0]
    assert points.min() >= 0 and points.max() <= 1
    for null, value, place, column in zip(nulls, values, places, points.T, strict=True):
        if not np.isnan(place):
            assert value == pytest.approx(null, abs=1e-12)
        near = np.mean(np.abs(column - (0.5 if np.isnan(place) else place)) < 0.02)
        assert (near < 0.1) if np.isnan(place) else (0.12 < near < 0.3)


def test_a_glance_leads_lower_than_random_points_and_no_lower_than_a_fit(creeping):
    problem = creeping.problem(("creep",))
    glanced = at_a_glance(creeping, ("creep",))
    assert (
        first_fit(creeping, 0, effects=("creep",)).identify
        < glanced
        < problem.loss(ranked_points(problem, 0, 60)).min()
    )


def test_the_first_fit_is_a_function_of_its_seed(creeping):
    assert np.array_equal(first_fit(creeping, 3).point, first_fit(creeping, 3).point)


def test_a_fit_whose_starts_end_apart_has_not_converged(plain, monkeypatch):
    monkeypatch.setattr(Case, "descend", lambda case, problem, point, *_, **__: point)
    assert first_fit(plain, 0).converged  # no restart leads lower
    monkeypatch.setattr(starts, "restart", lambda case, fit: replace(fit, identify=0.9 * fit.identify))
    assert not first_fit(plain, 0).converged


def test_more_starts_are_refined_until_two_agree(plain, monkeypatch):
    """Of each four of the first twenty all but the first get nowhere."""
    points = []

    def lame(case, problem, point, rival=np.inf, rough=False):
        points.append(point)
        return descend(problem, point, rival=rival, rough=rough) if len(points) in (1, 21) else point

    monkeypatch.setattr(Case, "descend", lame)
    assert first_fit(plain, 0).converged
    assert len(points) == 24 + 1  # the best one is refined


def test_what_is_found_elsewhere_has_fine_steps_or_is_not_taken():
    """A mode that rings at the rate of the samples, without damping, may look as good in steps that are too coarse."""
    drifting = stage.with_response(
        stage.case(model=("bouc_wen", "lumped")), lambda record: 2e-7 * (1 - np.exp(-record.time / 3))
    )
    problem, rate = drifting.problem(()), 1 / drifting.records[0].dt
    stiff = stage.STAGE | {"bouc_wen.gain": 0.082}
    alias = {"lumped.mass": 0.15, "lumped.stiffness": 0.15 * (2 * np.pi * rate) ** 2, "lumped.damping": 0.0}
    fit = fit_at((), problem, problem.unit_point(stiff))
    for found in (best_of(drifting, fit, [problem.unit_point(stiff | alias)]), restart(drifting, fit)):
        errors = step_errors(drifting, found)
        coarse = errors > STEP_TOLERANCE * max(drifting.floor, 2 * removed_rms(found.identify, drifting.floor))
        assert found is fit or all(count == FINEST for count, each in zip(found.steps, coarse, strict=True) if each)


def test_a_block_is_found_elsewhere_and_a_fit_at_the_noise_stays(plain):
    soft = {"lumped.mass": 1.0, "lumped.stiffness": 1e5, "lumped.damping": 100.0}  # 50 Hz, 16 %
    ringing = stage.case(soft, model=("bouc_wen", "lumped"), noise=1e-9)
    problem = ringing.problem(())
    stiff = stage.STAGE | {"bouc_wen.gain": 0.082, "lumped.mass": 0.01, "lumped.stiffness": 9e8, "lumped.damping": 50.0}
    stuck = fit_at((), problem, problem.unit_point(stiff))
    assert stuck.identify > 3e-9
    assert restart(ringing, stuck).identify == pytest.approx(1e-9, rel=0.1)
    fit = first_fit(plain, 0)
    assert restart(plain, fit).identify == pytest.approx(fit.identify, rel=1e-3)


def test_where_half_of_all_starts_agree_the_search_ends(plain, monkeypatch):
    """By their number, whatever they took."""
    fitted, astray = [], np.full(plain.problem(()).dimensions, 0.6)
    monkeypatch.setattr(Case, "descend", lambda case, problem, point, *_, **__: astray)
    monkeypatch.setattr(plain, "on_event", lambda event: fitted.append(event["done"]) if "done" in event else None)
    first_fit(plain, 0)
    assert fitted == list(range(1, 13))


def test_two_starts_that_agree_far_from_the_noise_do_not_end_the_search(plain, monkeypatch):
    """Of the first eight points all end in one side minimum."""
    points = []
    astray = descend(plain.problem(()), np.full(plain.problem(()).dimensions, 0.9), most=1)

    def lame(case, problem, point, rival=np.inf, rough=False):
        points.append(point)
        return descend(problem, point, rival=rival, rough=rough) if len(points) > 8 else astray

    monkeypatch.setattr(Case, "descend", lame)
    fit = first_fit(plain, 0)
    assert fit.converged and fit.identify < 1.1 * plain.floor
    assert len(points) == 12 + 1


def test_modes_the_wrong_way_round_are_exchanged():
    """Their bounds overlap, and the first ends short of its place in that of the second."""
    t = np.arange(2000) * 1e-3
    chirps = [50 + 20 * np.sin(2 * np.pi * (10 + rate * t) * t) for rate in (80, 60)]
    true = {"frequency_1": 88.0, "frequency_2": 143.0, "damping_1": 0.02, "damping_2": 0.01, "shape_1": 0.8}
    modes = {f"modal.{word}": value for word, value in (true | {"shape_2": 0.2}).items()}
    made = stage.records(modes, chirps, dt=1e-3, model=("bouc_wen", "modal"))
    overlapping = {"modal.frequency_1": Widened((50.0, 140.0)), "modal.frequency_2": Widened((80.0, 230.0))}
    known = {name: value for name, value in stage.STAGE.items() if name.startswith("bouc_wen")}
    known["bouc_wen.gain"] *= 1e6
    case = Case(("bouc_wen", "modal"), (), made, stage.specs(known) | overlapping)
    problem = case.problem(())
    swapped = modes | {"modal.frequency_1": 140.0, "modal.frequency_2": 88.0, "modal.damping_1": 0.01}
    swapped |= {"modal.damping_2": 0.02, "modal.shape_1": 0.2, "modal.shape_2": 0.8}
    wrong = fit_at((), problem, case.descend(problem, problem.unit_point(swapped)))
    assert wrong.identify > 2 * stage.NOISE and "modal.frequency_1" in wrong.on_bounds
    found = best_exchange(case, wrong)
    assert found.identify == pytest.approx(stage.NOISE, rel=0.05)
    assert found.values["modal.frequency_1"] == pytest.approx(88.0, rel=1e-3)


def test_each_axis_is_restarted_from_its_own_best_of_the_random_points():
    problem, rng = stage.beside(stage.case(), stage.case({"bouc_wen.alpha": 0.2})).problem(()), np.random.default_rng(0)
    point, points = np.full(problem.dimensions, 0.5), rng.random((40, problem.dimensions))
    every = np.ones(problem.dimensions, dtype=bool)
    starts = restarts(problem, point, every, points)
    np.testing.assert_allclose(problem.by_axis(starts), np.sort(problem.by_axis(points), axis=0))
    only_x = np.array([name.startswith("x.") for name in problem.names])
    assert (restarts(problem, point, only_x, points)[:, ~only_x] == 0.5).all()


@pytest.mark.parametrize(("seconds", "share"), [(0.0, 1.0), (None, 0.0)])
def test_where_nothing_is_left_of_the_budget_no_start_is_ranked(plain, monkeypatch, seconds, share):
    fit = first_fit(plain, 0)
    monkeypatch.setattr(Problem, "rough_by_axis", lambda *arguments: pytest.fail("ranked"))
    monkeypatch.setattr(plain, "budget", Budget(seconds))
    assert restart(plain, fit, share=share).identify <= fit.identify


def test_few_points_are_ranked_where_each_costs_a_solution():
    density = Choice("homogenized_energy", {"density": "free"})
    dense = Case((density,), (), stage.case().records, {})
    assert len(random_points(dense.problem(()), np.random.default_rng(0))) == STARTS_SOLVED
