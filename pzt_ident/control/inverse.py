"""The drive under which an identified stage follows a reference: its inverse, part by part, from the displacement back
to the drive."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

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
PASSES = 12
SLOW = 0.7  # share of the error that a pass may at most leave for another one
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
        self.limits = limits or self.bounds

    def __call__(self, reference: Array) -> Feedforward:
        """The drive for a reference (axes, samples), SI units, at the stage's sample time, from rest at its first
        sample. An axis that is not measured is kept at zero drive."""
        measured = list(self.stage.model.measured)
        best = self.once(reference, reference)
        target, left = reference, np.abs(best.error[measured]).max()
        for _ in range(PASSES if self.decoupled and not best.limited.any() else 0):
            target = target - self.stage.respond(self.mechanics(best.error), MECHANICS)
            found = self.once(target, reference)
            before, left = left, np.abs(found.error[measured]).max()
            if not left < before:
                break
            best = found
            if left > SLOW * before or left <= CLOSE * np.abs(reference).max():
                break
        return best

    def once(self, target: Array, reference: Array) -> Feedforward:
        """The inverse of every part for a target, and what the model does under the drive that it gives."""
        force = self.mechanics(target) + bending(self.stage, target)
        found = self.material(force, self.bounds)
        asked = self.actuation(found.inputs)
        drive = self.limits.clip(asked, self.stage.dt)
        if not np.array_equal(drive, asked):
            drive = self.limits.clip(self.actuation(self.material(force, self.limits).inputs), self.stage.dt)
        return Feedforward(reference, drive, asked, self.stage.respond(drive), found.wrong, found.missed)

    def material(self, force: Array, limits: Limits) -> Solution:
        """Inputs of the material under which it puts out a force."""
        part = self.stage.part(MATERIAL, self.without)
        return part.solve(force, limits.drive, limits.slew * self.stage.dt, self.slopes)

    @cached_property
    def mechanics(self) -> Preview:
        """The inverse of mechanics and modes."""
        small = SMALL * self.size * np.abs(np.diag(self.slopes))
        return preview(self.stage, MECHANICS, self.gain, small, self.without)

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
            outputs = self.stage.part(MATERIAL, self.without).respond(move)
            columns.append((outputs[:, 1] - outputs[:, 0]) / self.size)
        slopes = np.array(columns).T
        return np.where(np.eye(axes, dtype=bool) & (slopes == 0), 1.0, slopes)
