"""Virtual piezo stage with any of many physical effects: continuous equations, integrated finely by numba.

It shares no code with pzt_ident. Units: V, um, s; kg, N s/m and N/m for the mechanics. The base is Lin & Lin (2012),
Mechatronics 22, 614: h' = alpha d U' - beta |U'| h - gamma U' |h|, f = d U - h, m x'' + b x' + k x = k f. The drive is
linear between its samples; it starts at rest. Every effect is exactly absent at the default of its quantity.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
NONE = np.zeros(0)
compiled = njit(cache=True, error_model="numpy")
RATE = 130.0  # V/s, of a 0.5 Hz triangle over 130 V: alpha is meant at this rate
LEAST_RATE = 0.1  # V/s, below which the rate counts as this


class Axis(NamedTuple):
    """One axis: kg, N s/m, N/m, um/V, 1, 1/V, 1/V."""

    mass: float
    damping: float
    stiffness: float
    gain: float
    alpha: float
    beta: float
    gamma: float


class Stage(NamedTuple):
    """Two axes, of which x is measured, and the effects of x with their nulls."""

    x: Axis
    y: Axis
    delay: float = 0.0  # s, of the command
    clip: float = math.inf  # V, the most that the driver gives
    resolution: float = 0.0  # V, of the driver's converter
    slew: float = math.inf  # V/s
    amplifier_lag: float = 0.0  # s
    rate: float = 0.0  # alpha <- alpha (1 + rate log10(|U'| / RATE)), per decade
    asymmetry: float = 0.0  # h' <- h' + asymmetry U |U'|, um/V^2
    relaxation: float = 0.0  # h' <- h' - relaxation h, 1/s
    quadratic: float = 0.0  # f <- f + quadratic U^2, um/V^2
    saturation: float = 0.0  # d U <- d tanh(saturation U) / saturation, 1/V
    weights: Array = NONE  # h <- h + sum of weights times plays of U, um/V
    thresholds: Array = NONE  # V
    amplitude_gain: float = 0.0  # d <- d + amplitude_gain times the peak-to-peak drive of the record, um/V^2
    aging: float = 0.0  # d <- d (1 - aging times hours in the laboratory)
    depoling: float = 0.0  # d <- d (1 - depoling) after a negative voltage, until a high one
    snag: float = 0.0  # um, a bump in f while U rises
    snag_at: float = 5.0  # um
    snag_width: float = 0.3  # um
    creep: Array = NONE  # f <- f + sum of creep times f low-passed
    creep_times: Array = NONE  # s
    force_coupling: float = 0.0  # f <- f + force_coupling f_y
    kinematic_coupling: float = 0.0  # x <- x + kinematic_coupling y
    product_coupling: float = 0.0  # f <- f + product_coupling U_x U_y, um/V^2
    mode_share: float = 0.0  # x <- (1 - mode_share) x + mode_share times a second mode
    mode_frequency: float = 1000.0  # Hz
    mode_damping: float = 0.01
    load: float = 0.0  # m <- m + load, kg
    more_damping: float = 0.0  # b <- b + more_damping, N s/m
    cubic: float = 0.0  # k x <- k (x + cubic x^3), 1/um^2
    friction: float = 0.0  # um, LuGre: Coulomb force over k
    presliding: float = 1.0  # um
    stiction: float = 1.0  # static force over Coulomb's
    stribeck: float = 100.0  # um/s
    sensor_lag: float = 0.0  # s
    step: float = 5e-6  # s, of the integration


def simulate(stage: Stage, time: Array, u_x: Array, u_y: Array, hours: float = 0.0) -> Array:
    """Position of x in um at each of the uniform times, from rest under the first sample, `hours` after the first."""
    interval = (time[-1] - time[0]) / (len(time) - 1)
    count = math.ceil(interval / stage.step - 1e-9)
    step = interval / count
    aged = (1 - stage.aging * hours) * stage.x.gain + stage.amplitude_gain * np.ptp(u_x)
    stage = stage._replace(x=stage.x._replace(gain=aged))
    f = _free_stroke(stage, u_x, u_y, count, step)
    if len(stage.creep):
        _add_creep(stage, f, count, interval)
    share, y = stage.mode_share, 0.0
    if stage.force_coupling != 0 or stage.kinematic_coupling != 0:
        y = _free_stroke(Stage(stage.y, stage.y), u_y, u_y, count, step)
        f += stage.force_coupling * y
    if stage.friction != 0:
        _add_friction(stage, f, step)
    x = _mechanics(stage, f, step)
    if share != 0:
        omega = 2 * math.pi * stage.mode_frequency
        mode = Axis(1.0, 2 * stage.mode_damping * omega, omega**2, 0.0, 0.0, 0.0, 0.0)
        x = (1 - share) * x + share * _mechanics(Stage(mode, mode), f, step)
    if stage.kinematic_coupling != 0:
        x += stage.kinematic_coupling * _mechanics(Stage(stage.y, stage.y), y, step)
    return _sense(x, stage.sensor_lag, step)[::count].copy()


@compiled
def _at(samples: Array, place: float) -> float:
    place = min(max(place, 0.0), len(samples) - 1.0)
    left = min(int(place), len(samples) - 2)
    return samples[left] + (place - left) * (samples[left + 1] - samples[left])


@compiled
def _low_pass(y: float, u0: float, u1: float, time: float, step: float) -> float:
    """time y' + y = u over a step on which u is a straight line, exactly."""
    lag = (u1 - u0) * time / step
    return u1 - lag + (y - u0 + lag) * math.exp(-step / time)


@compiled
def _driver(stage: Stage, command: float) -> float:
    if stage.resolution > 0:
        command = stage.resolution * round(command / stage.resolution)
    return min(command, stage.clip)


@compiled
def _slope(axis: Axis, stage: Stage, h: float, u: float, rate: float) -> float:
    """dh/dt with the effects inside the hysteresis."""
    alpha = axis.alpha
    if stage.rate != 0:
        alpha *= 1 + stage.rate * math.log10((abs(rate) + LEAST_RATE) / RATE)
    plain = alpha * axis.gain * rate - axis.beta * abs(rate) * h - axis.gamma * rate * abs(h)
    return plain + stage.asymmetry * u * abs(rate) - stage.relaxation * h


@compiled
def _hysteresis(axis: Axis, stage: Stage, h: float, u0: float, u1: float, step: float) -> float:
    rate, middle = (u1 - u0) / step, (u0 + u1) / 2
    k1 = _slope(axis, stage, h, u0, rate)
    k2 = _slope(axis, stage, h + step / 2 * k1, middle, rate)
    k3 = _slope(axis, stage, h + step / 2 * k2, middle, rate)
    k4 = _slope(axis, stage, h + step * k3, u1, rate)
    return h + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


@compiled
def _plays(weights: Array, thresholds: Array, plays: Array, u: float) -> float:
    total = 0.0
    for i in range(len(weights)):
        plays[i] = min(max(plays[i], u - thresholds[i]), u + thresholds[i])
        total += weights[i] * plays[i]
    return total


@compiled
def _force(stage: Stage, u: float, u_y: float, h: float, poled: float, rising: bool) -> float:
    """Free stroke f in um."""
    stroke = u if stage.saturation == 0 else math.tanh(stage.saturation * u) / stage.saturation
    f = stage.x.gain * (1 - stage.depoling * (1 - poled)) * stroke - h
    f += stage.quadratic * u * u + stage.product_coupling * u * u_y
    if stage.snag != 0 and rising:
        f -= stage.snag * math.exp(-(((f - stage.snag_at) / stage.snag_width) ** 2))
    return f


@compiled
def _pole(poled: float, u: float) -> float:
    """Share of domains in line: lost below 0 V, won back from 40 V to 120 V."""
    return min(max(poled, (u - 40) / 80), 1.0) if u > 0 else min(poled, max(1 + u / 20, 0.0))


@compiled
def _pull(stage: Stage, f: float, x: float, v: float) -> float:
    """Acceleration of x."""
    axis = stage.x
    pull = axis.stiffness * (f - x - stage.cubic * x * x * x) - (axis.damping + stage.more_damping) * v
    return pull / (axis.mass + stage.load)


@compiled
def _move(stage: Stage, x: float, v: float, f0: float, f1: float, step: float) -> tuple[float, float]:
    """One step of RK4."""
    half, middle = step / 2, (f0 + f1) / 2
    a1 = _pull(stage, f0, x, v)
    v2 = v + half * a1
    a2 = _pull(stage, middle, x + half * v, v2)
    v3 = v + half * a2
    a3 = _pull(stage, middle, x + half * v2, v3)
    v4 = v + step * a3
    a4 = _pull(stage, f1, x + step * v3, v4)
    return x + step / 6 * (v + 2 * v2 + 2 * v3 + v4), v + step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)


@compiled
def _free_stroke(stage: Stage, u_x: Array, u_y: Array, count: int, step: float) -> Array:
    """f at every step: driver, hysteresis and static nonlinearity."""
    f = np.empty((len(u_x) - 1) * count + 1)
    plays = np.zeros(len(stage.weights))
    slewed = u = _driver(stage, u_x[0])
    h, poled, rising = 0.0, _pole(1.0, u), True
    f[0] = _force(stage, u, u_y[0], _plays(stage.weights, stage.thresholds, plays, u), poled, rising)
    for i in range(1, len(f)):
        command = _driver(stage, _at(u_x, (i - stage.delay / step) / count))
        last, past = slewed, u
        slewed += min(max(command - slewed, -stage.slew * step), stage.slew * step)
        u = slewed if stage.amplifier_lag == 0 else _low_pass(past, last, slewed, stage.amplifier_lag, step)
        h = _hysteresis(stage.x, stage, h, past, u, step)
        if u != past:
            poled, rising = _pole(poled, u), u > past
        other = _at(u_y, i / count) if stage.product_coupling != 0 else 0.0
        f[i] = _force(stage, u, other, h + _plays(stage.weights, stage.thresholds, plays, u), poled, rising)
    return f


@compiled
def _add_creep(stage: Stage, f: Array, count: int, interval: float) -> None:
    """A ladder of Kelvin-Voigt elements, exact for f linear between the samples."""
    ladder, before, start = np.zeros(len(stage.creep)), 0.0, f[0]
    last = start
    for first in range(0, len(f) - 1, count):
        now, after = f[first + count], 0.0
        for i in range(len(ladder)):
            ladder[i] = _low_pass(ladder[i], last - start, now - start, stage.creep_times[i], interval)
            after += stage.creep[i] * ladder[i]
        for j in range(1, count + 1):
            f[first + j] += before + (after - before) * j / count
        last, before = now, after


@compiled
def _add_friction(stage: Stage, f: Array, step: float) -> None:
    """LuGre with bristles that follow the stage but not its ringing, which would shake them loose."""
    z, before = 0.0, f[0]
    for i in range(1, len(f)):
        push, before = f[i] - before, f[i]
        sign = 1.0 if push > 0 else -1.0
        speed = abs(push) / step
        limit = sign * (1 + (stage.stiction - 1) * math.exp(-((speed / stage.stribeck) ** 2)))
        moved = abs(push) / (1 + stage.friction / stage.presliding * (1 - z / limit))
        z = limit + (z - limit) * math.exp(-moved / (stage.presliding * abs(limit)))
        f[i] -= stage.friction * z


@compiled
def _mechanics(stage: Stage, f: Array, step: float) -> Array:
    x = np.empty(len(f))
    x[0], v = f[0], 0.0
    for i in range(1, len(f)):
        x[i], v = _move(stage, x[i - 1], v, f[i - 1], f[i], step)
    return x


@compiled
def _sense(x: Array, lag: float, step: float) -> Array:
    if lag == 0:
        return x
    y = x.copy()
    for i in range(1, len(x)):
        y[i] = _low_pass(y[i - 1], x[i - 1], x[i], lag, step)
    return y
