"""The drive under which an identified stage follows a reference: its inverse, part by part, from the displacement back
to the drive."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pzt_ident.control.limits import Limits
from pzt_ident.control.preview import Preview, preview
from pzt_ident.control.stage import ACTUATION, MATERIAL, MECHANICS, Solution, Stage
from pzt_ident.control.statics import bending
from pzt_ident.errors import InputError
from pzt_ident.model.block import Coupling

Array = NDArray[np.float64]

GAIN = 10.0  # noise gain of a preview
RANGE = 10.0  # over the largest drive of the identification, within which the material is solved
PASSES = 16
MEMORY = 4  # passes that the next one learns from
WIDEST = 0.1  # of the reference: a step that must be smoother than that to do no harm is none
CLOSE = 1e-12  # of the largest value, below which a difference is rounding
SMALL = 1e-4  # of the largest drive, the size of a pulse


@dataclass(frozen=True)
class Feedforward:
    """What a stage is driven with to follow a reference; all (axes, samples), SI units.

    asked: the drive without limits. displacement: that of the model under the drive. wrong: where the model, on the way
    to the reference, first moves away from it. missed: what the material cannot reach at any drive.
    """

    reference: Array
    drive: Array
    asked: Array
    displacement: Array
    wrong: NDArray[np.bool_]
    missed: Array

    @property
    def error(self) -> Array:
        """Displacement minus reference."""
        return self.displacement - self.reference

    @property
    def limited(self) -> NDArray[np.bool_]:
        """Where the drive is less than the reference asks for."""
        size = np.abs(self.asked).max(axis=1, keepdims=True)
        return np.abs(self.drive - self.asked) > CLOSE * size


class Inverse:
    """The inverse of a stage, part by part.

    size: the largest drive at which the stage was identified. gain: the most by which a preview may amplify a
    frequency, over its static gain. decoupled: with what acts from axis to axis; without it each axis is inverted by
    itself, as Lin & Lin (2012), eq. 23, do.

    Mechanics, lags and delays are inverted by previews, linear about rest; to that comes the force that bends a spring
    which is not linear. What is between, the material, is solved for its input sample by sample, in the state that it
    is in: hysteresis, static effects, creep, coupling and friction. What is left, also by blocks that are not
    `solvable`, is made up for by passes over the model: the reference is moved by the error.
    """

    def __init__(
        self, stage: Stage, size: float, limits: Limits | None = None, gain: float = GAIN, decoupled: bool = True
    ) -> None:
        finer = [block.name for block in stage.model.blocks if block.oversample > 1]
        if finer:
            remedy = "identify a model of blocks with closed forms, such as bouc_wen and lumped"
            raise InputError(
                "has no inverse, since it is stepped finer than its samples", where=finer[0], remedy=remedy
            )
        axes = len(stage.model.axes)
        self.stage, self.size, self.gain, self.decoupled = stage, size, gain, decoupled
        blocks = stage.model.blocks
        across = tuple(block for block in blocks if issubclass(block, Coupling) and not decoupled)
        self.without = (*across, *(block for block in blocks if not block.solvable))
        self.bounds = Limits(np.tile([-RANGE * size, RANGE * size], (axes, 1)), np.full(axes, np.inf))
        self.limits = self.bounds if limits is None else limits.within(self.bounds)

    def __call__(self, reference: Array) -> Feedforward:
        """The drive for a reference (axes, samples), SI units, at the stage's sample time, from rest at its first
        sample. In the place of the reference of an axis that is not measured is its drive."""
        best = self.once(reference, reference)
        targets, steps, width = [reference], [self.step(best, 0.0)], 0.0
        for _ in range(PASSES if self.decoupled and not best.limited.any() else 0):
            if self.left(best) <= CLOSE * np.abs(reference).max():
                break
            targets.append(accelerated(targets[-MEMORY:], steps[-MEMORY:]))
            trial = self.once(targets[-1], reference)
            if self.left(trial) > self.left(best):
                width = 2 * width or 1.0
                if width > WIDEST * reference.shape[1]:
                    break
                targets, steps = [targets[-2]], [self.step(best, width)]
                continue
            best = trial
            steps.append(self.step(best, width))
        return best

    def left(self, feedforward: Feedforward) -> float:
        """The largest error of a measured axis."""
        return float(np.abs(feedforward.error[self._measured]).max())

    def step(self, feedforward: Feedforward, width: float) -> Array:
        """What the target is to be moved by, were the stage linear: its error, as far as the mechanics can follow.
        width: samples over which it is smoothed; near a resonance that friction or a bent spring shift, a step does
        harm."""
        from scipy.ndimage import gaussian_filter1d

        step = -self.stage.solvable.respond(self.mechanics(feedforward.error), MECHANICS)
        return gaussian_filter1d(step, width, mode="nearest") if width else step

    def once(self, target: Array, reference: Array) -> Feedforward:
        """The inverse of every part for a target, and what the model does under the drive that it gives."""
        force = self.mechanics(target) + bending(self.stage.solvable, target)
        solution = self.material(force, reference, self.bounds)
        command = self.command(solution.inputs, reference)
        drive = self.limits.clip(command, self.stage.dt)
        if not np.array_equal(drive, command):
            least = self.material(force, reference, self.limits)
            drive = self.limits.clip(self.command(least.inputs, reference), self.stage.dt)
        return Feedforward(reference, drive, command, self.stage.respond(drive), solution.wrong, solution.missed)

    def material(self, force: Array, reference: Array, limits: Limits) -> Solution:
        """Inputs of the material under which it puts out a force; those of an axis that is not measured follow from
        its drive."""
        part = self.stage.solvable.part(MATERIAL, self.without)
        held = self.stage.respond(self._given(reference), ACTUATION)
        return part.solve(force, held, limits.drive, limits.slew * self.stage.dt, self.slopes)

    def command(self, inputs: Array, reference: Array) -> Array:
        """The drive that gives the material its inputs."""
        drive = self.actuation(inputs)
        given = self._given(reference)
        return np.where(self._measured[:, None], drive, given)

    def _given(self, reference: Array) -> Array:
        """The drive of the axes that are not measured, zero for the others."""
        return np.where(self._measured[:, None], 0.0, reference)

    @property
    def _measured(self) -> NDArray[np.bool_]:
        axes = range(len(self.stage.model.axes))
        return np.array([axis in self.stage.model.measured for axis in axes])

    @cached_property
    def mechanics(self) -> Preview:
        """The inverse of mechanics and modes."""
        small = SMALL * self.size * np.abs(np.diag(self.slopes))
        return preview(self.stage.solvable, MECHANICS, self.gain, small, self.without)

    @cached_property
    def actuation(self) -> Preview:
        """The inverse of delay and amplifier."""
        return preview(self.stage, ACTUATION, self.gain, np.full(len(self.slopes), SMALL * self.size))

    @cached_property
    def slopes(self) -> Array:
        """Mean slopes of the material's outputs over the inputs, from rest: (axes, axes)."""
        axes = len(self.stage.model.axes)
        columns = []
        for axis in range(axes):
            move = np.zeros((axes, 2))
            move[axis, 1] = self.size
            outputs = self.stage.solvable.part(MATERIAL, self.without).respond(move)
            columns.append((outputs[:, 1] - outputs[:, 0]) / self.size)
        slopes = np.array(columns).T
        return np.where(np.eye(axes, dtype=bool) & (slopes == 0), 1.0, slopes)


def accelerated(targets: Sequence[Array], steps: Sequence[Array]) -> Array:
    """The next target of a fixed-point iteration from the last ones and their steps.

    Anderson (1965), J. ACM 12, 547.
    """
    if len(targets) == 1:
        return targets[0] + steps[0]
    moves = np.array([(b - a).ravel() for a, b in pairwise(targets)]).T
    changes = np.array([(b - a).ravel() for a, b in pairwise(steps)]).T
    shares = np.linalg.lstsq(changes, steps[-1].ravel(), rcond=1e-10)[0]
    return targets[-1] + steps[-1] - ((moves + changes) @ shares).reshape(targets[-1].shape)
