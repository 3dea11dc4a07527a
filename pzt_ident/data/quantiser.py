"""The quantiser of a sensor: its step, and the error of its readings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PART = 128  # samples
FEW = 8  # steps
MOST_OF_TWO = 0.51  # of a step: what is read at two values scatters by half a step at most


def quantiser_step(response: Array) -> float:
    """Step of the quantiser, 0 where none shows: the values lie on a grid of at most a third as many points."""
    values = np.unique(response)
    if values.size < 2 or values.size > response.size / 3:
        return 0.0
    gaps = np.diff(values)
    step = float(gaps[gaps > 1e-6 * gaps.max()].min())
    return step if is_on_grid(response, step) else 0.0


def common_step(responses: list[Array]) -> float:
    """Step of the quantiser of all responses: the finest that one of them shows, or a part of it that hardly moves, 0
    where others have values between."""
    parts = [
        part for response in responses for part in (response, *np.split(response, range(PART, response.size, PART)))
    ]
    steps = [step for step in map(quantiser_step, parts) if step]
    step = refined(min(steps), responses) if steps else 0.0
    return step if step and all(is_on_grid(response, step) for response in responses) else 0.0


def refined(step: float, responses: list[Array]) -> float:
    """A step by all gaps of a few: readings that were written in so many digits tell a single one only so well."""
    gaps = np.concatenate([np.diff(np.unique(response)) for response in responses])
    counts = np.round(gaps / step)
    few = counts <= FEW
    return float(gaps[few].sum() / counts[few].sum()) if counts[few].any() else step


def is_on_grid(response: Array, step: float) -> bool:
    """Whether all values are whole numbers of steps apart."""
    steps = np.diff(np.unique(response)) / step
    return bool(np.allclose(steps, np.round(steps), atol=0.05))


def with_quantiser(scatter: float, step: float) -> float:
    """Standard deviation of the errors of a quantised reading of something whose readings scatter so much.

    Noise of variance s^2 errs by s^2 + q^2/12 in the mean over all places between two steps q. What stays in place
    scatters less: by q s / sqrt(pi) in the mean where s is small against q, by all of it from q^2/(2 pi) on.
    """
    if 2 * np.pi * scatter**2 >= step**2:
        return scatter
    return float(np.hypot(np.sqrt(np.pi) * scatter**2 / step, step / np.sqrt(12)))


def errors_of_readings(scatters: Array, seconds: Array, step: float) -> Array:
    """The same for several estimates of one scatter, each of so many seconds: what scatters by half a step or less is
    at one place between two steps, and only their mean square over many places tells the noise."""
    near = scatters <= MOST_OF_TWO * step
    errors = np.array([with_quantiser(float(scatter), step) for scatter in scatters])
    if near.any():
        mean = np.sqrt(np.average(scatters[near] ** 2, weights=seconds[near]))
        errors[near] = with_quantiser(float(mean), step)
    return errors
