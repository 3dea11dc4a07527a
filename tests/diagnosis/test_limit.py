"""What an effect is that ended in a limit, where another name fits it."""

from dataclasses import dataclass

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis import limit
from pzt_ident.diagnosis.bounds import Widened
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.limit import (
    amounts_of,
    entries_of,
    excess_of,
    is_limited,
    own_bounds,
    small_shapes,
)
from pzt_ident.model.block import Coupling
from pzt_ident.model.parameter import SMALL
from pzt_ident.model.registry import blocks


@dataclass(frozen=True)
class Given:
    """Bounds of a job."""

    bounds: tuple[float, float]
    value: None = None


MODEL = ("bouc_wen", "lumped")


@pytest.mark.parametrize("item", ["friction", "friction.lugre_viscous", "friction.motion", "friction.slip"])
@pytest.mark.parametrize(("share", "limited"), [(0.9 * SMALL, True), (1.5 * SMALL, False)])
def test_friction_that_gives_little_before_it_slides_is_a_play(item, share, limited, monkeypatch):
    """Any reach that is next to nothing beside the friction, wherever its bounds are."""
    monkeypatch.setattr(limit, "is_felt", lambda fit, name: True)
    case = stage.case(model=MODEL)
    problem = case.problem((item,))
    middle = fit_at((item,), problem, np.full(problem.dimensions, 0.5))
    (shape, entry) = next(pair for pair in entries_of(middle).items() if pair[1].parameter.small_to)
    values = middle.values
    values[shape] = share * values[shape.removesuffix(entry.word) + entry.parameter.small_to]
    fit = fit_at((item,), problem, problem.unit_point(values))
    assert small_shapes(fit) == ([shape] if limited else [])
    assert (shape in own_bounds(fit, item)) == is_limited(fit) == limited


@pytest.mark.parametrize("item", [item for word in blocks.effects() for item in blocks.forms(word)])
def test_a_shape_that_no_amount_is_held_against_is_small_to_none(item):
    """At the lower bounds, which may be below zero."""
    axes = 2 if issubclass(blocks[item], Coupling) else 1
    case = stage.case(model=MODEL) if axes == 1 else stage.beside(stage.case(model=MODEL), stage.case(model=MODEL))
    problem = case.problem((item,))
    fit = fit_at((item,), problem, np.zeros(problem.dimensions))
    declared = {name for name, entry in entries_of(fit).items() if entry.parameter.small_to}
    assert {*small_shapes(fit)} <= declared


@pytest.mark.parametrize("item", [item for word in blocks.effects() for item in blocks.forms(word)])
@pytest.mark.parametrize(("bounded", "beyond"), [(False, True), (True, False), (True, True)])
@pytest.mark.parametrize("bounds_of", [Widened, Given])
def test_an_effect_on_a_bound_and_beyond_what_is_expected_is_in_a_limit(item, bounded, beyond, bounds_of, monkeypatch):
    """Neither alone: a lag may be slower than the slowest of the catalogue, and an effect a little larger. Of bounds
    that the job gives no more is expected than that."""
    monkeypatch.setattr(limit, "is_felt", lambda fit, name: True)
    case = stage.beside(stage.case(model=MODEL), stage.case(model=MODEL))
    given = case.problem((item,))
    amounts = amounts_of(fit_at((item,), given, np.full(given.dimensions, 0.5)), item)
    ends = zip(given.names, given.lower.tolist(), given.upper.tolist(), strict=True)
    problem = case.with_specs({n: bounds_of((low, 2 * high)) for n, low, high in ends if n in amounts}).problem((item,))
    shares = [beyond if name in amounts else 1 - 0.5 * (not bounded) for name in problem.names]
    fit = fit_at((item,), problem, np.array(shares, dtype=float))
    shapes = {*own_bounds(fit, item)} - amounts
    assert bool(excess_of(fit, item, own_bounds(fit, item))) == bool(
        shapes and amounts and beyond and bounds_of is Widened
    )
