"""What one candidate costs elsewhere: an ODE solver, NumPy over a population, and a plain compiled loop."""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp


def lsoda(time, drive, response, theta, rtol=1e-6):
    """One candidate, RMSE: Bouc-Wen and mechanics as differential equations, one call a sample, as corners need."""
    gain, alpha, beta, gamma, mass, damping, stiffness = theta
    state, out = np.array([0.0, gain * drive[0], 0.0]), [gain * drive[0]]
    for i in range(1, drive.size):
        rate = (drive[i] - drive[i - 1]) / (time[i] - time[i - 1])

        def slope(t, s, rate=rate, i=i):
            h, x, v = s
            u = drive[i - 1] + rate * (t - time[i - 1])
            dh = alpha * gain * rate - beta * abs(rate) * h - gamma * rate * abs(h)
            return [dh, v, (stiffness * (gain * u - h - x) - damping * v) / mass]

        state = solve_ivp(slope, time[i - 1 : i + 1], state, method="LSODA", rtol=rtol, atol=1e-12).y[:, -1]
        out.append(state[1])
    return np.std(np.array(out) - response)


def numpy_population(time, drive, response, theta):
    """All candidates at once, one exact step a sample: (candidates, 7) -> RMSE of each."""
    gain, alpha, beta, gamma, mass, damping, stiffness = theta.T
    turn, push = first_order_hold(mass, damping, stiffness, time[1] - time[0])
    h, w, v, before = np.zeros(len(theta)), 0.0, 0.0, gain * drive[0]
    total = square = 0.0
    for i in range(drive.size):
        move = drive[i] - drive[i - 1] if i else 0.0
        q, s = np.sign(move) * h / (alpha * gain), abs(move)
        along, against = beta + gamma, beta - gamma
        with np.errstate(invalid="ignore", divide="ignore"):
            to_zero = np.where(q < 0, np.log1p(-q * against) / against, 0.0)
        crosses = (q < 0) & (s > to_zero)
        q, s = np.where(crosses, 0.0, q), np.where(crosses, s - to_zero, s)
        rate = np.where(q < 0, against, along)
        q = q + np.expm1(-rate * s) * (q - 1 / rate)
        h = np.sign(move) * q * alpha * gain if move else h
        force = gain * drive[i] - h
        w, v = (
            turn[0] * w + turn[1] * v + push[0] * (force - before),
            turn[2] * w + turn[3] * v + push[1] * (force - before),
        )
        before = force
        error = force + w - response[i]
        total, square = total + error, square + error**2
    return np.sqrt(square / drive.size - (total / drive.size) ** 2)


def first_order_hold(mass, damping, stiffness, dt):
    """exp(A T) of the underdamped oscillator in (x, x' / omega), and what a change of force adds."""
    omega, zeta = np.sqrt(stiffness / mass), damping / (2 * np.sqrt(stiffness * mass))
    root = np.sqrt(1 - zeta**2)
    decay, angle = np.exp(-zeta * omega * dt), root * omega * dt
    c, s = decay * np.cos(angle), decay * np.sin(angle) / root
    turn = c + zeta * s, s, -s, c - zeta * s
    lag, speed = 2 * zeta / (omega * dt), 1 / (omega * dt)
    return turn, (turn[0] * lag - turn[1] * speed - lag, turn[2] * lag - turn[3] * speed + speed)


@njit(cache=True)
def plain_loop(drive, response, gain, alpha, beta, gamma, turn, push):
    """One candidate, RMSE: the exact step in a compiled loop over samples, math library and branches."""
    h, w, v, before = 0.0, 0.0, 0.0, gain * drive[0]
    total = square = 0.0
    for i in range(drive.size):
        move = drive[i] - drive[i - 1] if i else 0.0
        sign, s = (1.0 if move >= 0 else -1.0), abs(move)
        q = sign * h / (alpha * gain)
        if q < 0:
            against = beta - gamma
            to_zero = np.log1p(-q * against) / against if -q * against > -1 else np.inf
            if s > to_zero:
                q, s = 0.0, s - to_zero
        rate = beta - gamma if q < 0 else beta + gamma
        q = q + np.expm1(-rate * s) * (q - 1 / rate)
        h = sign * q * alpha * gain
        force = gain * drive[i] - h
        change = force - before
        w, v = turn[0] * w + turn[1] * v + push[0] * change, turn[2] * w + turn[3] * v + push[1] * change
        before = force
        error = force + w - response[i]
        total += error
        square += error * error
    return np.sqrt(square / drive.size - (total / drive.size) ** 2)
