"""What an effect leaves on the standard drives when a model without it has been fitted: the residual a user sees."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from pzt_ident.atlas.shown import Shown, shown
from pzt_ident.atlas.stage import MECHANICS, OPERATOR, STROKE, VALUES, Array, Drive, Stage, drives
from pzt_ident.model.registry import blocks

STEP = 1e-3  # of a parameter, in a difference
UNSEEN = ("polar",)  # no part of a refit: the drive that a user has not run yet

Traces = dict[str, Array]
"""By the name of a drive: (samples,), m."""


@dataclass(frozen=True)
class Traced:
    """The response with an item, without it, and what of their difference a refit leaves; drives on which the item
    cannot be simulated are left out."""

    with_it: Traces
    bare: Traces
    left: Traces

    def size(self, drive: str) -> float:
        """Root mean square of what is left on a drive, over the stroke; 0 where there is none."""
        return self._sizes.get(drive, 0.0)

    @cached_property
    def largest(self) -> float:
        """On the drives that were fitted."""
        return max(self.size(name) for name in self.left if name not in UNSEEN)

    @cached_property
    def _sizes(self) -> dict[str, float]:
        return {name: float(np.sqrt(np.mean(trace**2)) / STROKE) for name, trace in self.left.items()}


@cache
def traced(item: str) -> Traced:
    """Each is made once."""
    subject: Shown = shown(item)
    with_it = {
        name: response for name, drive in drives().items() if np.isfinite(response := subject.respond(drive)).all()
    }
    bare = {name: subject.bare(drives()[name]) for name in with_it}
    change = {name: with_it[name] - bare[name] for name in with_it}
    return Traced(with_it, bare, refitted(change) if subject.effect else change)


def refitted(change: Traces) -> Traces:
    """The change less what the parameters of the standard stage and an offset in each record take up, to first order,
    over all drives that were seen together; each of them counts alike."""
    names = [name for name in change if name not in UNSEEN]
    weights = {name: np.full(change[name].size, change[name].size ** -0.5) for name in names}
    columns = np.hstack([slopes(name) for name in names]) * np.concatenate([weights[name] for name in names])
    target = np.concatenate([weights[name] * (change[name] - change[name].mean()) for name in names])
    absorbed = np.linalg.lstsq(columns.T, target, rcond=1e-9)[0]
    left = {name: change[name] - change[name].mean() - absorbed @ slopes(name) for name in change}
    return {name: trace - trace.mean() for name, trace in left.items()}


@cache
def slopes(name: str) -> Array:
    """What each parameter of the standard stage does to a response, about its mean: (parameters, samples)."""
    drive: Drive = drives()[name]
    stage = Stage([blocks[OPERATOR], blocks[MECHANICS]], VALUES)
    theta = stage.problem.theta
    up, down = (stage.respond(drive, theta * (1 + sign * STEP * np.eye(theta.size))) for sign in (1, -1))
    derivatives = (up - down) / (2 * STEP)
    return derivatives - derivatives.mean(axis=1, keepdims=True)
