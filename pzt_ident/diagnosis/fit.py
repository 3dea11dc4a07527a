"""A model with its effects at its best point: errors, values, and what the data determine of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from pzt_ident.diagnosis.budget import PROVING, Budget
from pzt_ident.search.problem import Problem
from pzt_ident.search.sandwich import Sandwich
from pzt_ident.search.uncertainty import Estimate, estimates

Array = NDArray[np.float64]

EDGE = 1e-4  # of a parameter's range: nearer to a bound it is on it, if the model is no worse there
NO_WORSE = 1e-3  # of the loss


@dataclass(frozen=True)
class Fit:
    """A model with its effects at its best point; `identify` and `validate` are RMSE in units of the loss, `validate`
    None without validation records. `measured_only`: the added effects act on the measured axes only. `coarse`: the
    first of them before the steps of the simulation were refined; None where they were not."""

    effects: tuple[str, ...]
    problem: Problem
    point: Array
    identify: float
    validate: float | None
    converged: bool = True
    measured_only: bool = False
    coarse: float | None = None

    @property
    def freedom(self) -> int:
        """Number of free parameters, with those of which each record has its own."""
        model = self.problem.model
        added = len(model.measured) * sum(block.amounts() for block in model.additions)
        return self.problem.dimensions + len(model.amounts) + added

    @property
    def total(self) -> float:
        """RMSE of both uses together: the criterion by which fits are ranked."""
        errors = [error for error in (self.identify, self.validate) if error is not None]
        return float(np.sqrt(np.mean(np.square(errors))))

    @cached_property
    def by_use(self) -> Array:
        """RMSE of each use, that of the identification records first, and measured axis, in units of the loss: (uses,
        measured axes)."""
        uses = [use for use, error in (("identify", self.identify), ("validate", self.validate)) if error is not None]
        return np.array([self.problem.by_axis(self.point[None], use)[0] / self.problem.sizes for use in uses])

    @property
    def by_axis(self) -> Array:
        """RMSE of both uses together of each measured axis, in units of the loss: (measured axes,)."""
        return np.asarray(np.sqrt(np.mean(np.square(self.by_use), axis=0)))

    @cached_property
    def on_bounds(self) -> tuple[str, ...]:
        """Names of the parameters that ended on a bound, but for those whose range ends there of itself."""
        problem, values = self.problem, self.problem.physical(self.point)[0]
        parameters = [problem.model.entries[column].parameter for column in problem.free]
        bounds = np.where(self.point < 0.5, "lower", "upper").tolist()
        rows = zip(problem.names, self.at_edges, values, bounds, parameters, strict=True)
        return tuple(
            name for name, edge, value, bound, parameter in rows if edge and not parameter.ends_at(value, bound)
        )

    @property
    def at_edges(self) -> NDArray[np.bool_]:
        """Which parameters are on a bound or so near that the model is no worse there: (free,)."""
        bounds = np.round(self.point)
        edges = np.abs(self.point - bounds) <= EDGE
        if (near := np.flatnonzero(edges & (self.point != bounds))).size:
            there = np.tile(self.point, (near.size, 1))
            there[range(near.size), near] = bounds[near]
            edges[near] = self.problem.loss(there) <= (1 + NO_WORSE) * self.identify
        return edges

    @cached_property
    def covariance(self) -> Array:
        """Of the free parameters in the unit cube, (free, free), see `Sandwich`."""
        return Sandwich(lambda: self.problem.samples(self.point)).covariance

    @property
    def steps(self) -> tuple[int, ...]:
        """Simulation steps per sample of each record."""
        return tuple(record.steps for record in self.problem.records)

    @property
    def values(self) -> dict[str, float]:
        """The free parameters by name, in the user's units."""
        return dict(zip(self.problem.names, self.problem.physical(self.point)[0].tolist(), strict=True))

    def estimates(self, budget: Budget | None = None) -> list[Estimate]:
        """What the data determine of the parameters: by the curvature of the loss, and with a budget by as many
        profiles of it as that suffices for."""
        word = "profiled" if budget else "curved"
        if word not in self.__dict__:
            going = partial(budget.allows, "intervals by profiles", PROVING) if budget else lambda: False
            self.__dict__[word] = estimates(self.problem, self.point, going)[0]
        return list(self.__dict__[word])


def fit_at(
    effects: tuple[str, ...], problem: Problem, point: Array, converged: bool = True, measured_only: bool = False
) -> Fit:
    """The fit that a point is, with its errors."""
    loss = float(problem.loss(point, "validate")[0])
    validate = None if np.isnan(loss) else loss
    return Fit(effects, problem, point, float(problem.loss(point)[0]), validate, converged, measured_only)
