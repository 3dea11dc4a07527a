"""Model and records as a function on the unit cube."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.data.record import Record, drive_correlation
from pzt_ident.engine.amounts import Held
from pzt_ident.engine.gather import Triangle, rotated, stretches
from pzt_ident.engine.gather import squares as exact_squares
from pzt_ident.engine.simulator import Simulator
from pzt_ident.errors import InputError
from pzt_ident.model.chain import Chain
from pzt_ident.search.cube import Cube, ParameterSpec
from pzt_ident.search.feasibility import check_feasible
from pzt_ident.search.linear import Linear, Tangent, differences
from pzt_ident.search.scales import size_of
from pzt_ident.search.stencil import DIFFERENCE, forward, half_widths, stencil

Array = NDArray[np.float64]
ALIKE = 1e-8  # of the loss, where it has half of its digits
SMALL = 1e-3  # of the typical size of what is solved for: a change that a response which is bent follows as its tangent
FEW = 2  # points beside another one, for which amounts of the records are settled
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
        judging = {"identify": identify, "validate": [r for r in records if r.use == "validate" and r.judges]}
        simulator = Simulator(model, identify[0])
        self.simulators = {use: [simulator.on(record) for record in some] for use, some in judging.items()}
        self._not_judging = [simulator.on(record) for record in records if not record.judges]
        super().__init__(model, identify, specs or {})
        self._set_linear(self.linear_columns, identify)
        check_feasible(self, identify)

    def _set_linear(self, linear: list[int], identify: list[Record]) -> None:
        """Columns of theta that are solved for, with the sign of the slope of response over drive."""
        entries = [self.model.entries[column] for column in linear]
        signs = [np.sign(drive_correlation(identify, entry.axis)) or 1.0 for entry in entries]
        units = np.array(
            [sign * SMALL * size_of(self.model, entry, identify) for sign, entry in zip(signs, entries, strict=True)]
        )
        self.linear = Linear(self.model, linear, units, self._changes)
        self._tangent: Tangent | None = None

    @property
    def scored(self) -> int:
        """Number of scored samples of the identification records, over all measured axes."""
        return sum(simulator.scored for simulator in self.simulators["identify"]) * len(self.model.measured)

    @cached_property
    def swing(self) -> float:
        """The loss of a response that does not move."""
        measured, simulators = list(self.model.measured), self.simulators["identify"]
        squares = [s.scored * np.var(s.record.response[measured, s.record.settle :], axis=1) for s in simulators]
        rmse = np.sqrt(np.sum(squares, axis=0) / sum(s.scored for s in simulators))
        return float(self.loss_of(rmse[None])[0])

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
        return self.loss_of(self.by_axis(points, use, squares))

    def loss_of(self, rmse: Array) -> Array:
        """The loss, of the RMSE of each measured axis in SI units, (candidates, axes)."""
        rmse = rmse / self.sizes
        return rmse[:, 0] if rmse.shape[1] == 1 else np.sqrt(np.mean(rmse**2, axis=1))

    def best(self, points: Array, near: Array, squares: Squares = exact_squares) -> tuple[Array, float]:
        """The point of least loss of those beside another one, and its loss, to the last digits unless `squares` has
        fewer, and then the first of those that are alike; where parameters are solved for, they follow to first order
        until few points are left."""
        tangent = self.tangent(near)
        if tangent:
            followed = self.along(tangent, self.held(near)).rotated_residuals(points)
            points = points[[np.argmin(np.linalg.norm(followed, axis=1))]]
            losses = self.loss(points)
        else:
            if self.model.amounts and len(points) > FEW:
                points = points[np.argsort(self.rough_loss(points, near), kind="stable")[:FEW]]
            losses = self.loss(points, squares=squares)
        alike = 0.0 if squares is exact_squares else ALIKE
        best = int(np.argmax(losses <= (1 + alike) * losses.min()))
        return points[best], float(losses[best])

    def rough_loss(self, points: Array, near: Array) -> Array:
        """The loss by which points are told from each other: (candidates,)."""
        return self.loss_of(self.rough_by_axis(points, near))

    def rough_by_axis(self, points: Array, near: Array) -> Array:
        """The RMSE of each measured axis by which points are told from each other: (candidates, axes). Amounts of the
        records follow those of another point to first order, which costs a simulation each."""
        if not self.model.amounts:
            return self.rough().by_axis(points)
        return self.along(None, self.held(near)).by_axis(points, squares=exact_squares)

    def residuals(self, points: Array) -> Array:
        """(candidates, scored samples of all records and axes), scaled so that the norm is the loss; inf if failed."""
        residuals = self._scaled(self.parameters(points))
        with np.errstate(all="ignore"):
            failed = ~np.isfinite(np.einsum("cs,cs->c", residuals, residuals))
        self.failed += int(failed.sum())
        residuals[failed] = np.inf
        return residuals

    def _scaled(self, theta: Array) -> Array:
        scaled, end = np.empty((len(theta), self.scored)), 0
        with np.errstate(all="ignore"):
            for simulator in self.simulators["identify"]:
                begin, end = end, end + simulator.scored * len(self.sizes)
                simulator.put_residuals(theta, self.sizes * np.sqrt(self.scored), scaled[:, begin:end])
            return self._tangent.follow(scaled) if self._tangent else scaled

    def _changes(self, theta: Array) -> Array:
        """Residual of the first candidate, and how that of each other differs from it, rotated: (rows, candidates).
        Amounts of the records follow those of the first to first order. NaN if one failed."""
        near = self._holding(self._amounts(theta[0]))
        rows, failed = near._rotated(theta, differences(len(theta)))
        return np.full_like(rows, np.nan) if failed.any() else rows

    def tangent(self, point: Array, sampled: bool = False) -> Tangent | None:
        """How the parameters that are solved for follow beside a point; None where there are none. sampled: whether
        `residuals` are to follow as well, which holds a column of samples for each of them."""
        if not self.linear.columns.size:
            return None
        row = self.parameters(point)[0]
        tangent = Tangent.of(self.model, self.linear, row)
        return tangent.of_samples(self._scaled(tangent.beside(self.model, row[None])[:-1])) if sampled else tangent

    def near(self, point: Array, sampled: bool = False) -> Problem:
        """The problem whose residuals have what is solved for follow to first order beside a point. sampled: as of
        `tangent`."""
        return self.along(self.tangent(point, sampled), self.held(point))

    def held(self, point: Array) -> tuple[Held, ...]:
        """The amounts of each identification record beside a point, if the model has any."""
        return self._amounts(self.parameters(point)[0]) if self.model.amounts else ()

    def _amounts(self, theta: Array) -> tuple[Held, ...]:
        return tuple(filter(None, (simulator.held(theta) for simulator in self.simulators["identify"])))

    def _holding(self, held: tuple[Held, ...]) -> Problem:
        """The problem whose amounts of the records follow to first order; itself without any."""
        return self._with_amounts(Simulator.near, held)

    def begun_at(self, point: Array) -> Problem:
        """The problem whose amounts of the records, and what is solved for, are sought from those of a point, which
        takes fewer steps beside it; itself without any."""
        begun = self._with_amounts(Simulator.begun_at, self.held(point))
        if self.linear.columns.size:
            begun = copy(begun)
            begun.linear = self.linear.begun_at(self.parameters(point)[0], begun._changes)
        return begun

    def _with_amounts(self, changed: Callable[[Simulator, Held], Simulator], held: tuple[Held, ...]) -> Problem:
        if not held:
            return self
        near = copy(self)
        identify = zip(self.simulators["identify"], held, strict=True)
        near.simulators = self.simulators | {"identify": [changed(simulator, each) for simulator, each in identify]}
        return near

    def along(self, tangent: Tangent | None, held: tuple[Held, ...] = ()) -> Problem:
        """The problem whose residuals have what is solved for follow to first order, for a fraction of the cost; the
        model may have more blocks than that of the tangent and the amounts, if they are at their null in it."""
        if tangent is None and not held:
            return self
        near, columns = self._holding(held), self.linear.columns
        if tangent is None:
            return near
        near = copy(near)
        names = self.model.names
        followed = np.array([names[column] in tangent.values for column in columns])
        near.theta = self.theta.copy()
        near.theta[columns[followed]] = [tangent.values[names[column]] for column in columns[followed]]
        near._tangent = tangent
        near.linear = Linear(self.model, columns[~followed], self.linear.units[~followed], near._changes)
        return near

    def rough(self) -> Problem:
        """The problem in which what is solved for ends as soon as it tells points from each other."""
        rough = copy(self)
        rough.linear = self.linear.rough()
        identify = [simulator.rough() for simulator in self.simulators["identify"]]
        rough.simulators = self.simulators | {"identify": identify}
        return rough

    def narrowed(self, point: Array) -> Problem:
        """The problem with differences that do not reach beyond a narrow minimum, see `half_widths`; itself where the
        usual ones do not."""
        widths = half_widths(point, self.near(point).rotated_residuals)
        if np.all(widths == self.half_width):
            return self
        narrow = copy(self)
        narrow.half_width = widths
        return narrow

    def jacobian(self, point: Array) -> Array:
        """Jacobian of the residuals over the cube, (samples, free), see `stencil`. What is solved for follows to first
        order (Kaufman 1975, BIT 15, 49)."""
        near = self.near(point, sampled=True)
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
        near = self.near(point)
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
        near = self.near(point)
        points, weights = stencil(point, self.half_width)
        losses = near.loss(points)
        if np.isinf(losses).any():
            points, weights = stencil(point, self.half_width, np.isinf(losses))
        theta, tangent = near.parameters(points), near._tangent
        amounts = np.zeros((0, len(weights)))
        if tangent:
            theta, following = tangent.beside(self.model, theta), weights
            weights = tangent.beside_weights(weights)
            amounts = tangent.amounts(near._gathered(theta, weights)[0], following)
        for number, rows in near._stretches(theta, weights):
            own = len(rows) - amounts.shape[1]
            yield number, rows[own:] - amounts.T @ rows[1:own]

    def samples_of_linear(self, point: Array) -> Iterator[tuple[int, Array]]:
        """As `samples`, residual and derivatives by multiples of the parameters that are solved for and are not zero:
        (1 + active, samples); at the end what the prior asks for."""
        tangent, number = self.tangent(point), 0
        assert tangent
        theta = tangent.beside(self.model, np.zeros((0, len(self.model.names))))
        for number, rows in self._stretches(theta, differences(len(theta))):
            yield number, rows
        solution = self.linear.solved(self.parameters(point)[0])
        yield number, np.vstack([solution.prior @ (solution.values / solution.units), tangent.prior.T])

    def _stretches(self, theta: Array, weights: Array) -> Iterator[tuple[int, Array]]:
        """Combinations of the residuals of candidates, stretch after stretch as of `samples`."""
        for number, simulator in enumerate(self.simulators["identify"]):
            for i, error in stretches(simulator, theta):
                yield number * len(self.sizes) + i, weights @ error / (self.sizes[i] * np.sqrt(self.scored))

    def rotated_residuals(self, points: Array) -> Array:
        """Residuals as of `residuals`, of all points rotated together so that a few are left: (candidates, rows). Norms
        and inner products are those of the samples."""
        points = np.atleast_2d(points)
        rows, failed = self.rotated(points, differences(len(points)))  # of near ones, which keep their digits
        if failed[0]:
            rows, failed = self.rotated(points, np.eye(len(points)))
        else:
            rows[:, 1:] += rows[:, :1]
        rows[:, failed] = np.inf
        return rows.T

    def rotated(self, points: Array, weights: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Combinations `weights`, (combinations, candidates), of the residuals, rotated so that a few rows are left:
        (rows, combinations). And which candidates failed, whose residuals are taken as zero: (candidates,)."""
        rows, failed = self._rotated(self.parameters(points), weights)
        self.failed += int(failed.sum())
        return rows, failed

    def _rotated(self, theta: Array, weights: Array) -> tuple[Array, NDArray[np.bool_]]:
        """As `rotated`, of candidates (candidates, parameters)."""
        tangent = self._tangent
        if tangent is None:
            return self._gathered(theta, weights)
        rows, failed = self._gathered(tangent.beside(self.model, theta), tangent.beside_weights(weights))
        return tangent.followed(rows, weights), failed[len(failed) - len(theta) :]

    def _gathered(self, theta: Array, weights: Array) -> tuple[Array, NDArray[np.bool_]]:
        """As `_rotated`, where nothing follows."""
        triangle, failed = Triangle(len(weights)), np.zeros(len(theta), dtype=bool)
        for simulator in self.simulators["identify"]:
            parts, broken = rotated(simulator, theta, weights)
            failed |= broken
            for part, size in zip(parts, self.sizes, strict=True):
                triangle.add(part.T / (size * np.sqrt(self.scored)))
        return triangle.r, failed

    @property
    def every_simulator(self) -> list[Simulator]:
        """The simulators of the identification records, then of the validation records, those that judge first."""
        return [simulator for simulators in self.simulators.values() for simulator in simulators] + self._not_judging

    def simulator_of(self, record: Record) -> Simulator:
        return next(simulator for simulator in self.every_simulator if simulator.record is record)

    def errors(self, point: Array) -> Iterator[tuple[Record, Array]]:
        """Each record with model minus measurement over all its samples: (measured axes, samples), SI units."""
        theta = self.parameters(point)
        return ((simulator.record, simulator.errors(theta)[0]) for simulator in self.every_simulator)
