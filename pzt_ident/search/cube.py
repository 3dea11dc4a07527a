"""The free parameters of a model as the unit cube."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.data.units import factor
from pzt_ident.model.chain import Chain
from pzt_ident.search.feasibility import check_units
from pzt_ident.search.scales import bounds_of, size_of, unit_of

Array = NDArray[np.float64]


class ParameterSpec(Protocol):
    """What a job may give for a parameter, in the user's units: bounds make it free, a value alone fixes it."""

    @property
    def bounds(self) -> tuple[float, float] | None: ...
    @property
    def value(self) -> float | None: ...


@dataclass(frozen=True)
class FixedValue:
    """A specification that fixes a parameter at a value."""

    value: float
    bounds: None = None


class Cube:
    """Which parameters of a model are free, fixed, or linear: to be solved for. specs: what is given of some of them.

    theta: (parameters,) in SI units, NaN where not fixed; free, linear_columns: columns of it. names, units, lower,
    upper, log: of the free parameters, in the user's units. Points are (candidates, free) in [0, 1].
    """

    def __init__(self, model: Chain, identify: Sequence[Record], specs: Mapping[str, ParameterSpec]) -> None:
        self.model, self._identify, self.specs = model, tuple(identify), specs
        check_units(model, identify[0])
        self.all_units = [unit_of(model, entry, identify[0]) for entry in model.entries]
        self.factors = np.array([factor(unit) for unit in self.all_units])
        self.theta = np.full(len(model.entries), np.nan)
        self.linear_columns: list[int] = []
        free, lower, upper = [], [], []
        for column, entry in enumerate(model.entries):
            spec = next((specs[name] for name in model.spellings(entry) if name in specs), None)
            parameter = entry.parameter
            if spec and spec.bounds is None and spec.value is not None:
                self.theta[column] = spec.value * self.factors[column]
            elif parameter.value is not None and not spec:
                self.theta[column] = parameter.value * size_of(model, entry, identify)
            elif parameter.linear and not spec:
                self.linear_columns.append(column)
            else:
                low, high = (spec.bounds if spec else None) or self.declared_bounds(column)
                free.append(column)
                lower.append(low)
                upper.append(high)
        self.lower, self.upper = np.array(lower), np.array(upper)
        self._describe_free(free)

    def _describe_free(self, free: list[int]) -> None:
        """Names, units and scales of the free columns of theta."""
        self.free = np.array(free, dtype=int)
        names = self.model.names
        self.names = tuple(names[column] for column in free)
        self.units = tuple(self.all_units[column] for column in free)
        scales = np.array([self.model.entries[column].parameter.scale == "log" for column in free], dtype=bool)
        self.log = scales & (self.lower > 0)
        self._has_log_scale = bool(self.log.any())

    def declared_bounds(self, column: int) -> tuple[float, float]:
        """Bounds of a parameter where the job gives none, in the user's units."""
        low, high = bounds_of(self.model, self.model.entries[column], self._identify) / self.factors[column]
        return float(low), float(high)

    def range_of(self, column: int) -> tuple[float, float]:
        """Bounds of a parameter in the user's units; (value, value) if it is fixed."""
        place = np.flatnonzero(self.free == column)
        if place.size:
            return float(self.lower[place[0]]), float(self.upper[place[0]])
        return (float(self.theta[column] / self.factors[column]),) * 2

    @property
    def dimensions(self) -> int:
        return len(self.free)

    def parameters_at(self, values: Array) -> Array:
        """All parameters in SI units, the free ones at `values` (free,) in the user's units: (parameters,)."""
        theta = self.theta.copy()
        theta[self.free] = values * self.factors[self.free]
        return theta

    def physical(self, points: Array) -> Array:
        """Free parameters in the user's units: (candidates, free)."""
        points = np.atleast_2d(points)
        linear = self.lower + points * (self.upper - self.lower)
        if not self._has_log_scale:
            return linear
        base = np.where(self.log, self.lower, 1.0)
        return np.where(self.log, base * (np.where(self.log, self.upper, 1.0) / base) ** points, linear)

    def unit_point(self, values: Mapping[str, float]) -> Array:
        """The point of the cube for values by name in the user's units, clipped to the bounds."""
        given = np.array([values[name] for name in self.names])
        with np.errstate(divide="ignore", invalid="ignore"):
            logarithmic = np.log(given / self.lower) / np.log(self.upper / self.lower)
        linear = (given - self.lower) / (self.upper - self.lower)
        return np.clip(np.where(self.log, logarithmic, linear), 0, 1)
