"""Lags, delays, modes, creep, limits of an amplifier, and mechanics with a spring or friction that is not linear."""

import math

import numpy as np
from scipy.linalg import expm
from scipy.signal import cont2discrete, lfilter


def lag(signal, dt, tau):
    """First-order lag, exact for a signal that is linear between its samples, at rest at the first one."""
    decay = math.exp(-dt / tau)
    mean = (1 - decay) * tau / dt
    return signal[0] + lfilter([1 - mean, mean - decay], [1, -decay], signal - signal[0])


def linear(numerator, denominator, signal, dt):
    """Transfer function in s, exact for a signal that is linear between its samples, at rest at the first one."""
    top, bottom, _ = cont2discrete((numerator, denominator), dt, method="foh")
    gain = numerator[-1] / denominator[-1]
    return gain * signal[0] + lfilter(np.ravel(top), np.ravel(bottom), signal - signal[0])


def mode(signal, dt, frequency, damping):
    """A mode of gain one."""
    w = 2 * math.pi * frequency
    return linear([1.0], [1 / w**2, 2 * damping / w, 1.0], signal, dt)


def lumped(force, dt, mass, damping, stiffness):
    """One mass on a spring; the force is given as the displacement at rest."""
    return linear([stiffness], [mass, damping, stiffness], force, dt)


def late(times, signal, delay):
    return np.interp(times - delay, times, signal, left=signal[0])


def creep(stroke, dt, shares, times):
    """The stroke and Kelvin-Voigt elements behind it, each with a share and a time."""
    return stroke + sum(share * lag(stroke - stroke[0], dt, time) for share, time in zip(shares, times, strict=True))


def slew(signal, dt, fastest):
    """The signal followed at `fastest` or slower."""
    out, limit = np.empty_like(signal), fastest * dt
    value = out[0] = signal[0]
    for i, target in enumerate(signal.tolist()):
        error = target - value
        value += limit if error > limit else -limit if error < -limit else error
        out[i] = value
    return out


def slow_lag(signal, dt, tau, fastest):
    """First-order lag whose rate is limited: an amplifier with a limited current."""
    out, rate = np.empty_like(signal), -math.expm1(-dt / tau) / dt
    value = out[0] = signal[0]
    for i, target in enumerate(signal.tolist()):
        speed = (target - value) * rate
        value += max(-fastest, min(fastest, speed)) * dt
        out[i] = value
    return out


def _start(spring, force):
    """Where a spring balances a force, by Newton steps."""
    x = force
    for _ in range(60):
        x -= (spring(x) - force) / ((spring(x + 1e-6) - spring(x)) / 1e-6)
    return x


def oscillator(force, dt, mass, damping, stiffness, spring):
    """x'' = w^2 (f - spring(x)) - b / m x' by Runge-Kutta steps of fourth order."""
    w = math.sqrt(stiffness / mass)
    square, loss = w * w, 2 * (damping / (2 * w * mass)) * w
    samples, v = force.tolist(), 0.0
    x = _start(spring, force[0])
    out = np.empty(len(force))
    out[0] = x

    def acceleration(f, x, v):
        return square * (f - spring(x)) - loss * v

    for i in range(1, len(samples)):
        first, last = samples[i - 1], samples[i]
        middle = 0.5 * (first + last)
        k1 = acceleration(first, x, v)
        x2, v2 = x + 0.5 * dt * v, v + 0.5 * dt * k1
        k2 = acceleration(middle, x2, v2)
        x3, v3 = x + 0.5 * dt * v2, v + 0.5 * dt * k2
        k3 = acceleration(middle, x3, v3)
        x4, v4 = x + dt * v3, v + dt * k3
        k4 = acceleration(last, x4, v4)
        x += dt / 6 * (v + 2 * v2 + 2 * v3 + v4)
        v += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        out[i] = x
    return out


def bristles(force, dt, mass, damping, stiffness, bristle, friction):
    """x'' = w^2 (f - x - friction(z)) - b / m x' with z' = bristle(z, x'), by Runge-Kutta steps of fourth order."""
    w = math.sqrt(stiffness / mass)
    square, loss = w * w, 2 * (damping / (2 * w * mass)) * w
    samples, x, v, z = force.tolist(), force[0], 0.0, 0.0
    out = np.empty(len(force))
    out[0] = x

    def rates(f, x, v, z):
        return square * (f - x - friction(z)) - loss * v, bristle(z, v)

    for i in range(1, len(samples)):
        first, last = samples[i - 1], samples[i]
        middle = 0.5 * (first + last)
        k1, b1 = rates(first, x, v, z)
        x2, v2 = x + 0.5 * dt * v, v + 0.5 * dt * k1
        k2, b2 = rates(middle, x2, v2, z + 0.5 * dt * b1)
        x3, v3 = x + 0.5 * dt * v2, v + 0.5 * dt * k2
        k3, b3 = rates(middle, x3, v3, z + 0.5 * dt * b2)
        x4, v4 = x + dt * v3, v + dt * k3
        k4, b4 = rates(last, x4, v4, z + dt * b3)
        x += dt / 6 * (v + 2 * v2 + 2 * v3 + v4)
        v += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        z += dt / 6 * (b1 + 2 * b2 + 2 * b3 + b4)
        out[i] = x
    return out


def maxwell_slip(force, dt, mass, damping, stiffness, stiffnesses, limits):
    """Slip elements on a moving mass, of stiffness and largest force over the stage's stiffness.

    The mass is exact for a force that is linear in a step; friction at the end of a step is found by two passes.
    """
    w = math.sqrt(stiffness / mass)
    system = np.zeros((4, 4))
    system[:2, :2] = [[0, 1.0], [-w * w, -2 * (damping / (2 * w * mass)) * w]]
    system[:2, 2] = [0, w * w]
    system[2, 3] = 1 / dt
    step = expm(system * dt)
    (xx, xv), (vx, vv) = step[:2, :2].tolist()
    last = step[:2, 3]
    first, last = (step[:2, 2] - last).tolist(), last.tolist()
    x, v, friction, elements = force[0], 0.0, 0.0, [0.0] * len(stiffnesses)
    samples = force.tolist()
    out = np.empty(len(force))
    out[0] = x
    for i in range(1, len(samples)):
        before, guess = samples[i - 1] - friction, friction
        for _ in range(2):
            after = samples[i] - guess
            end = xx * x + xv * v + first[0] * before + last[0] * after
            moved = [
                max(-limit, min(limit, element + k * (end - x)))
                for element, k, limit in zip(elements, stiffnesses, limits, strict=True)
            ]
            guess = sum(moved)
        after = samples[i] - guess
        end = xx * x + xv * v + first[0] * before + last[0] * after
        v = vx * x + vv * v + first[1] * before + last[1] * after
        x, friction, elements = end, guess, moved
        out[i] = x
    return out
