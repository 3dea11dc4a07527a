"""Model and records as a function on the unit cube."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.data.record import Record, drive_correlation
from pzt_ident.engine.gather import Triangle, rotated, stretches
from pzt_ident.engine.gather import squares as exact_squares
from pzt_ident.engine.simulator import Simulator
from pzt_ident.errors import InputError
from pzt_ident.model.chain import Chain
from pzt_ident.search.cube import Cube, ParameterSpec
from pzt_ident.search.feasibility import check_feasible
from pzt_ident.search.linear import Linear, Tangent
from pzt_ident.search.scales import size_of
from pzt_ident.search.stencil import DIFFERENCE, forward, half_widths, stencil

Array = NDArray[np.float64]
Squares = Callable[[Simulator, Array], Array]


class Problem(Cube):
    """Find the free parameters with the least RMSE on the identification records.

    The loss is sqrt(mean over measured axes of (RMSE / size)^2), pooled over records, without the free offset of each
    record and axis (Lin & Lin 2012, eq. 8 and 19), in SI units. sizes: (measured axes,), 1 by default, to weigh
    responses of different kinds. A simulation that fails has an infinite loss, and is counted in `failed`.
    names, units, lower, upper: of the free parameters, in the user's units. Points are (candidates, free) in [0, 1].
    Raises InputError for a record shorter than the model needs or bounds that the model refuses.
    """

    def __init__(
        self,
        model: Chain,
        records: Sequence[Record],
        specs: Mapping[str, ParameterSpec] | None = None,
        sizes: ArrayLike | None = None,
    ) -> None:
        self.records = tuple(records)
        self.sizes: Array = np.ones(len(model.measured)) if sizes is None else np.asarray(sizes, dtype=np.float64)
        self.failed = 0
        self.half_width: Array | float = DIFFERENCE
        identify = [record for record in records if record.use == "identify"]
        if not identify:
            raise InputError("no record to identify from", where="records", remedy="give one of them `use: identify`")
        self.simulators = {
            use: [Simulator(model, r) for r in records if r.use == use] for use in ("identify", "validate")
        }
        super().__init__(model, identify, specs or {})
        self._set_linear(self.linear_columns, identify)
        check_feasible(self, identify)

    def _set_linear(self, linear: list[int], identify: list[Record]) -> None:
        """Columns of theta that are solved for, with the sign of the slope of response over drive."""
        entries = [self.model.entries[column] for column in linear]
        signs = [np.sign(drive_correlation(identify, entry.axis)) or 1.0 for entry in entries]
        units = np.array(
            [sign * size_of(self.model, entry, identify) for sign, entry in zip(signs, entries, strict=True)]
        )
        self.linear = Linear(self.model, linear, units, self._scaled)
        self._tangent: Tangent | None = None

    @property
    def scored(self) -> int:
        """Number of scored samples of the identification records, over all measured axes."""
        return sum(simulator.scored for simulator in self.simulators["identify"]) * len(self.model.measured)

    def parameters(self, points: Array) -> Array:
        """All parameters of the model in SI units: (candidates, parameters)."""
        values = self.physical(points)
        theta = np.empty((len(values), len(self.theta)))
        theta[:] = self.theta
        theta[:, self.free] = values * self.factors[self.free]
        self.linear.fill(theta)
        return theta

    def by_axis(self, points: Array, use: str = "identify", squares: Squares = Simulator.squares) -> Array:
        """RMSE of each measured axis over all records of a use, in SI units: (candidates, axes)."""
        theta = self.parameters(points)
        simulators = self.simulators[use]
        total = squares(simulators[0], theta)
        for simulator in simulators[1:]:
            total = total + squares(simulator, theta)
        rmse = np.sqrt(total / sum(simulator.scored for simulator in simulators))
        failed = ~(rmse < np.inf)
        if failed.any():
            self.failed += int(failed.any(axis=1).sum())
            rmse[failed] = np.inf
        return rmse

    def loss(self, points: Array, use: str = "identify", squares: Squares = Simulator.squares) -> Array:
        """(candidates,); infinite if the simulation failed, NaN if there is no record of this use."""
        if not self.simulators[use]:
            return np.full(np.atleast_2d(points).shape[0], np.nan)
        rmse = self.by_axis(points, use, squares) / self.sizes
        return rmse[:, 0] if rmse.shape[1] == 1 else np.sqrt(np.mean(rmse**2, axis=1))

    def best(self, points: Array, near: Array) -> tuple[Array, float]:
        """The point of least loss of those beside another one, and its loss, to the last digits; where parameters are
        solved for, they follow to first order until a point is chosen."""
        tangent = self.tangent(near)
        if tangent is None:
            losses = self.loss(points, squares=exact_squares)
            best = int(np.argmin(losses))
            return points[best], float(losses[best])
        point = points[np.argmin(np.linalg.norm(self.along(tangent).residuals(points), axis=1))]
        return point, float(self.loss(point)[0])

    def residuals(self, points: Array) -> Array:
        """(candidates, scored samples of all records and axes), scaled so that the norm is the loss; inf if failed."""
        residuals = self._scaled(self.parameters(points))
        with np.errstate(all="ignore"):
            failed = ~np.isfinite(np.square(residuals).sum(axis=1))
        self.failed += int(failed.sum())
        residuals[failed] = np.inf
        return residuals

    def _scaled(self, theta: Array) -> Array:
        with np.errstate(all="ignore"):
            parts = [simulator.residuals(theta) / self.sizes[:, None] for simulator in self.simulators["identify"]]
            scaled = np.hstack([part.reshape(len(theta), -1) for part in parts]) / np.sqrt(self.scored)
            return self._tangent.follow(scaled) if self._tangent else scaled

    def tangent(self, point: Array) -> Tangent | None:
        """How the parameters that are solved for follow beside a point; None where there are none."""
        if not self.linear.columns.size:
            return None
        names = [self.model.names[column] for column in self.linear.columns]
        return Tangent.of(names, self.linear.solved(self.parameters(point)[0]))

    def along(self, tangent: Tangent | None) -> Problem:
        """The problem whose residuals have what is solved for follow to first order, for a fraction of the cost; the
        model may have more blocks than that of the tangent, if they are at their null in it."""
        if tangent is None:
            return self
        near, columns = copy(self), self.linear.columns
        followed = np.array([self.model.names[column] in tangent.values for column in columns])
        near.theta = self.theta.copy()
        near.theta[columns[followed]] = [tangent.values[self.model.names[column]] for column in columns[followed]]
        near._tangent = tangent
        near.linear = Linear(self.model, columns[~followed], self.linear.units[~followed], near._scaled)
        return near

    def narrowed(self, point: Array) -> Problem:
        """The problem with differences that do not reach beyond a narrow minimum, see `half_widths`; itself where the
        usual ones do not."""
        widths = half_widths(point, self.along(self.tangent(point)).rotated_residuals)
        if np.all(widths == self.half_width):
            return self
        narrow = copy(self)
        narrow.half_width = widths
        return narrow

    def jacobian(self, point: Array) -> Array:
        """Jacobian of the residuals over the cube, (samples, free), see `stencil`. What is solved for follows to first
        order (Kaufman 1975, BIT 15, 49)."""
        near = self.along(self.tangent(point))
        points, weights = stencil(point, self.half_width)
        residuals = near.residuals(points)
        failed = np.isinf(residuals[:, 0])
        if failed.any():
            residuals[failed] = residuals[0]
            weights = stencil(point, self.half_width, failed)[1]
        return (weights[1:] @ residuals).T

    def equations(self, point: Array, central: bool = True) -> tuple[Array, Array]:
        """Jacobian (rows, free) and residual (rows,) as of `jacobian` and `residuals`, rotated together so that a few
        rows are left: J' J, J' r and r' r are those of the samples. central: both sides of the point, for twice the
        simulations."""
        near = self.along(self.tangent(point))
        points, weights = stencil(point, self.half_width) if central else forward(point)
        rotated, failed = near.rotated(points, weights)
        if failed[1:].any():
            if not central:
                return self.equations(point)
            rotated, failed = near.rotated(*stencil(point, self.half_width, failed))
        return rotated[:, 1:], np.full(len(rotated), np.inf) if failed[0] else rotated[:, 0]

    def samples(self, point: Array) -> Iterator[tuple[int, Array]]:
        """Residual and Jacobian as of `equations`, but sample by sample, stretch after stretch: the number of a series
        of samples, of a record and axis, and (1 + free, samples)."""
        near = self.along(self.tangent(point))
        points, weights = stencil(point, self.half_width)
        losses = near.loss(points)
        if np.isinf(losses).any():
            points, weights = stencil(point, self.half_width, np.isinf(losses))
        if near._tangent:
            yield 0, weights @ near.residuals(points)
            return
        theta, axes = near.parameters(points), len(self.model.measured)
        for number, simulator in enumerate(near.simulators["identify"]):
            for i, error in stretches(simulator, theta):
                yield number * axes + i, weights @ error / (self.sizes[i] * np.sqrt(self.scored))

    def rotated_residuals(self, points: Array) -> Array:
        """Residuals as of `residuals`, of all points rotated together so that a few are left: (candidates, rows). Norms
        and inner products are those of the samples."""
        points = np.atleast_2d(points)
        changes = np.eye(len(points))
        changes[1:, 0] = -1  # of the first, so that differences of near ones keep their digits
        rows, failed = self.rotated(points, changes)
        if failed[0]:
            rows, failed = self.rotated(points, np.eye(len(points)))
        else:
            rows[:, 1:] += rows[:, :1]
        rows[:, failed] = np.inf
        return rows.T

    def rotated(self, points: Array, weights: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Combinations `weights`, (combinations, candidates), of the residuals, rotated so that a few rows are left:
        (rows, combinations). And which candidates failed, whose residuals are taken as zero: (candidates,)."""
        triangle = Triangle(len(weights))
        if self._tangent:
            residuals = self.residuals(points)
            failed = np.isinf(residuals[:, 0])
            residuals[failed] = 0
            triangle.add(weights @ residuals)
            return triangle.r, failed
        theta, failed = self.parameters(points), np.zeros(len(points), dtype=bool)
        for simulator in self.simulators["identify"]:
            parts, broken = rotated(simulator, theta, weights)
            failed |= broken
            for part, size in zip(parts, self.sizes, strict=True):
                triangle.add(part.T / (size * np.sqrt(self.scored)))
        self.failed += int(failed.sum())
        return triangle.r, failed

    @property
    def every_simulator(self) -> list[Simulator]:
        """The simulators of the identification records, then of the validation records."""
        return [simulator for simulators in self.simulators.values() for simulator in simulators]

    def simulator_of(self, record: Record) -> Simulator:
        return next(simulator for simulator in self.every_simulator if simulator.record is record)

    def errors(self, point: Array) -> Iterator[tuple[Record, Array]]:
        """Each record with model minus measurement over all its samples: (measured axes, samples), SI units."""
        theta = self.parameters(point)
        return ((simulator.record, simulator.errors(theta)[0]) for simulator in self.every_simulator)
