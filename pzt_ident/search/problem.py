"""Model and records as a function on the unit cube."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.data.record import Record, drive_correlation
from pzt_ident.data.units import factor
from pzt_ident.engine.simulator import Simulator
from pzt_ident.errors import InputError
from pzt_ident.model.chain import Chain, Entry
from pzt_ident.search.feasibility import check_feasible, check_units
from pzt_ident.search.linear import Linear

Array = NDArray[np.float64]


CLEAR = 0.5  # correlation above which a response rises with its drive


class ParameterSpec(Protocol):
    """What a job may say of a parameter, in the user's units: bounds free it, a value alone fixes it."""

    @property
    def bounds(self) -> tuple[float, float] | None: ...
    @property
    def value(self) -> float | None: ...


@dataclass(frozen=True)
class FixedValue:
    """The wish for a value."""

    value: float
    bounds: None = None


class Problem:
    """Find the free parameters that leave the least RMSE on the records to identify.

    The loss is sqrt(mean over measured axes of (RMSE / size)^2), pooled over records, each record's and axis' free
    offset removed (Lin & Lin 2012, eq. 8 and 19), in SI units; sizes are 1 unless given, one a measured axis, to weigh
    responses of different kinds. A simulation that fails is infinite here, and counted.
    names, units, lower, upper: of the free parameters, in the user's units. Points are (candidates, free) in [0, 1].
    Raises InputError for a record shorter than the model needs or bounds that the model cannot take.
    """

    def __init__(
        self,
        model: Chain,
        records: Sequence[Record],
        specs: Mapping[str, ParameterSpec] | None = None,
        sizes: ArrayLike | None = None,
    ) -> None:
        self.model, self.records = model, tuple(records)
        self.sizes: Array = np.ones(len(model.measured)) if sizes is None else np.asarray(sizes, dtype=np.float64)
        self.failed = 0
        identify = [record for record in records if record.use == "identify"]
        if not identify:
            raise InputError("no record to identify from", where="records", remedy="give one of them `use: identify`")
        self.simulators = {
            use: [Simulator(model, r) for r in records if r.use == use] for use in ("identify", "validate")
        }
        self._assign(identify, specs or {})
        check_feasible(self, identify)

    def _assign(self, identify: list[Record], specs: Mapping[str, ParameterSpec]) -> None:
        """Which parameters are free, within which bounds, and what the others are fixed to."""
        count = len(self.model.entries)
        check_units(self.model, identify[0], self._unit)
        self.all_units = [self._unit(entry, identify[0]) for entry in self.model.entries]
        self._factor = np.array([factor(unit) for unit in self.all_units])
        self.theta = np.full(count, np.nan)
        free, lower, upper, linear = [], [], [], []
        for column, entry in enumerate(self.model.entries):
            spec = next((specs[name] for name in self.model.spellings(entry) if name in specs), None)
            parameter = entry.parameter
            if spec and spec.bounds is None and spec.value is not None:
                self.theta[column] = spec.value * self._factor[column]
            elif parameter.value is not None and not spec:
                self.theta[column] = parameter.value * self._size(entry, identify)
            elif parameter.linear and not spec:
                linear.append(column)
            else:
                own = spec.bounds if spec else None
                low, high = own or self._bounds(entry, identify) / self._factor[column]
                free.append(column)
                lower.append(low)
                upper.append(high)
        self.free = np.array(free, dtype=int)
        entries = [self.model.entries[column] for column in linear]
        turn = [np.sign(drive_correlation(identify, entry.axis)) or 1.0 for entry in entries]
        units = np.array([sign * self._size(entry, identify) for sign, entry in zip(turn, entries, strict=True)])
        self.linear = Linear(self.model, linear, units, self._scaled)
        self.names = tuple(self.model.names[column] for column in free)
        self.units = tuple(self.all_units[column] for column in free)
        self.lower, self.upper = np.array(lower), np.array(upper)
        scales = np.array([self.model.entries[column].parameter.scale == "log" for column in free], dtype=bool)
        self.log = scales & (self.lower > 0)
        self._any_log = bool(self.log.any())

    def _unit(self, entry: Entry, record: Record) -> str:
        first = record.response_units[self.model.measured[0]]
        response = record.response_units[entry.axis] or first
        own = {"drive": str(record.drive_units[entry.axis]), "response": str(response), "first": str(first)}
        divisor = {f"/{word}": f"/({unit})" if re.search(r"[/* ]", unit) else f"/{unit}" for word, unit in own.items()}
        return re.sub(r"/?(drive|response|first)", lambda word: (own | divisor)[word[0]], entry.parameter.unit)

    def _bounds(self, entry: Entry, records: list[Record]) -> Array:
        """Declared bounds in SI units; those of a gain also with the other sign, unless the response rises with the
        drive: an inverting amplifier turns it round, and so does a drive above the resonance."""
        low, high = entry.parameter.bounds
        if entry.parameter.unit == "response/drive" and drive_correlation(records, entry.axis) <= CLEAR:
            low, high = min(low, -high), max(high, -low)
        return np.array([low, high]) * self._size(entry, records)

    def _size(self, entry: Entry, records: list[Record]) -> float:
        """What declared bounds are multiples of, in SI units: the data's own spans where the unit names them."""
        spans = {
            "drive": max(float(np.ptp(record.drive[entry.axis])) for record in records),
            "response": max(float(np.ptp(record.response[entry.axis])) for record in records),
            "first": max(float(np.ptp(record.response[self.model.measured[0]])) for record in records),
        }
        named = re.findall(r"drive|response|first", entry.parameter.unit)
        if not named:
            return factor(entry.parameter.unit)
        if "drive" in named and spans["drive"] == 0:
            problem = f"the drive of axis {self.model.axes[entry.axis]} is constant: nothing to scale {entry.name} by"
            remedy = "is it the right column? Else give the parameter `bounds` or a `value`"
            raise InputError(problem, where=records[0].file or records[0].name, remedy=remedy)
        size = 1.0
        for joint, token, power in re.findall(r"([*/]?)([\w.]+)(?:\^(\d+))?", entry.parameter.unit):
            one = spans[token] if token in spans else factor(token)
            size *= one ** ((-1 if joint == "/" else 1) * int(power or 1))
        return size

    def parameters_at(self, values: Array) -> Array:
        """All parameters in SI units, the free ones at `values` (free,) in the user's units: (parameters,)."""
        theta = self.theta.copy()
        theta[self.free] = values * self._factor[self.free]
        return theta

    def range_of(self, column: int) -> tuple[float, float]:
        """Bounds of a parameter in the user's units; twice its value where it is fixed."""
        place = np.flatnonzero(self.free == column)
        if place.size:
            return float(self.lower[place[0]]), float(self.upper[place[0]])
        return (float(self.theta[column] / self._factor[column]),) * 2

    @property
    def scored(self) -> int:
        """Scored samples of the records to identify, over all measured axes."""
        return sum(simulator.scored for simulator in self.simulators["identify"]) * len(self.model.measured)

    @property
    def dimensions(self) -> int:
        return len(self.free)

    def physical(self, points: Array) -> Array:
        """Free parameters in the user's units: (candidates, free)."""
        points = np.atleast_2d(points)
        linear = self.lower + points * (self.upper - self.lower)
        if not self._any_log:
            return linear
        base = np.where(self.log, self.lower, 1.0)
        return np.where(self.log, base * (np.where(self.log, self.upper, 1.0) / base) ** points, linear)

    def unit_point(self, values: Mapping[str, float]) -> Array:
        """The point of the cube for values by name in the user's units, moved into the bounds."""
        given = np.array([values[name] for name in self.names])
        with np.errstate(divide="ignore", invalid="ignore"):
            logarithmic = np.log(given / self.lower) / np.log(self.upper / self.lower)
        linear = (given - self.lower) / (self.upper - self.lower)
        return np.clip(np.where(self.log, logarithmic, linear), 0, 1)

    def parameters(self, points: Array) -> Array:
        """All parameters of the model in SI units: (candidates, parameters)."""
        values = self.physical(points)
        theta = np.empty((len(values), len(self.theta)))
        theta[:] = self.theta
        theta[:, self.free] = values * self._factor[self.free]
        self.linear.fill(theta)
        return theta

    def by_axis(self, points: Array, use: str = "identify") -> Array:
        """RMSE of each measured axis over all records of that use, in SI units: (candidates, axes)."""
        theta = self.parameters(points)
        simulators = self.simulators[use]
        squares = simulators[0].squares(theta)
        for simulator in simulators[1:]:
            squares = squares + simulator.squares(theta)
        rmse = np.sqrt(squares / sum(simulator.scored for simulator in simulators))
        failed = ~(rmse < np.inf)
        if failed.any():
            self.failed += int(failed.any(axis=1).sum())
            rmse[failed] = np.inf
        return rmse

    def loss(self, points: Array, use: str = "identify") -> Array:
        """(candidates,); infinite where the simulation failed, NaN where there is no record of that use."""
        if not self.simulators[use]:
            return np.full(np.atleast_2d(points).shape[0], np.nan)
        rmse = self.by_axis(points, use) / self.sizes
        return rmse[:, 0] if rmse.shape[1] == 1 else np.sqrt(np.mean(rmse**2, axis=1))

    def residuals(self, points: Array) -> Array:
        """(candidates, scored samples of all records and axes), scaled so that the norm is the loss; inf if failed."""
        found = self._scaled(self.parameters(points))
        with np.errstate(all="ignore"):
            wrong = ~np.isfinite(np.square(found).sum(axis=1))
        self.failed += int(wrong.sum())
        found[wrong] = np.inf
        return found

    def _scaled(self, theta: Array) -> Array:
        with np.errstate(all="ignore"):
            each = [simulator.residuals(theta) / self.sizes[:, None] for simulator in self.simulators["identify"]]
            return np.hstack([part.reshape(len(theta), -1) for part in each]) / np.sqrt(self.scored)

    def jacobian(self, point: Array, step: float = 1e-5) -> Array:
        """Central differences of the residuals over the cube, one-sided on its faces and beside points that fail, zero
        between two of them: (samples, free)."""
        point = np.asarray(point, dtype=float)
        ends = np.concatenate([np.minimum(point + step, 1), np.maximum(point - step, 0)])
        count = self.dimensions
        tries = np.where(np.tile(np.eye(count, dtype=bool), (2, 1)), ends[:, None], point)
        found = self.residuals(tries)
        failed = np.isinf(found[:, 0])
        if failed.any():
            found[failed], ends[failed] = self.residuals(point), np.tile(point, 2)[failed]
        apart = ends[:count] - ends[count:]
        return ((found[:count] - found[count:]) / np.where(apart > 0, apart, 1)[:, None]).T

    @property
    def every_simulator(self) -> list[Simulator]:
        """Those of the records to identify, then of those to validate."""
        return [simulator for simulators in self.simulators.values() for simulator in simulators]

    def simulator_of(self, record: Record) -> Simulator:
        return next(simulator for simulator in self.every_simulator if simulator.record is record)

    def errors(self, point: Array) -> Iterator[tuple[Record, Array]]:
        """Each record with model minus measurement over all its samples, (measured axes, samples), SI units."""
        theta = self.parameters(point)
        return ((simulator.record, simulator.errors(theta)[0]) for simulator in self.every_simulator)

    def polish(self, point: Array, evaluations: int = 2000) -> tuple[Array, int]:
        """Least squares from a point, with the batched Jacobian: the point reached and the simulations it took."""
        from scipy.optimize import least_squares

        start = np.clip(point, 1e-9, 1 - 1e-9)
        size = self.loss(start)[0] or 1.0
        if not np.isfinite(size):
            return np.asarray(point), 1
        each = 2 * self.dimensions
        found = least_squares(
            lambda x: self.residuals(x)[0] / size,
            start,
            lambda x: self.jacobian(x) / size,
            bounds=(np.zeros(self.dimensions), np.ones(self.dimensions)),
            x_scale="jac",
            ftol=1e-10,
            xtol=1e-10,
            gtol=1e-12,
            max_nfev=max(2, evaluations // (each + 1)),
        )
        better = self.loss(found.x)[0] < self.loss(point)[0]
        return (found.x if better else np.asarray(point)), int(found.nfev + each * found.njev)
