"""Hysteresis of a piezo actuator, V in and um of free displacement out, and creep; from a rest at zero."""

import math

import numpy as np
from numba import njit
from scipy.stats import norm

FIELDS = 64


@njit(cache=True)
def _turn(h, step, dt, alpha, beta, gamma, relaxation, scale):
    """What a step of voltage and of time does to h."""
    change = alpha * step - beta * abs(step) * h - gamma * step * abs(h)
    if relaxation > 0.0:
        change -= dt * relaxation * (scale * math.sinh(h / scale) if scale > 0 else h)
    return change


@njit(cache=True)
def bouc_wen(u, dt, gain, alpha, beta, gamma, branch, skew, rate, speed, relaxation, scale):
    """gain (u - h),  dh = alpha du - beta |du| h - gamma du |h|, by Runge-Kutta on each step; all h in V.

    Wen (1976), J. Eng. Mech. Div. ASCE 102, 249; Low & Guo (1995), J. Microelectromech. Syst. 4, 230.

    branch: beta (1 + branch sgn du), the fifth term of Song & Der Kiureghian (2006), J. Eng. Mech. 132, 610.
    skew: alpha (1 + skew u sgn du), after Zhu & Wang (2012), Sens. Actuators A 181, 51.
    rate: beta and gamma over 1 + rate log10(1 + |du/dt| / speed).
    relaxation: dh/dt = -relaxation h, or by thermal activation -relaxation scale sinh(h / scale): Eyring (1936),
    J. Chem. Phys. 4, 283.
    """
    y, h = np.empty_like(u), 0.0
    y[0] = gain * u[0]
    for i in range(1, u.size):
        step = u[i] - u[i - 1]
        a, b, g = alpha, beta, gamma
        if rate != 0.0:
            slowing = 1.0 + rate * math.log10(1.0 + abs(step) / dt / speed)
            b /= slowing
            g /= slowing
        sign = 1.0 if step > 0 else -1.0
        b = b * (1.0 + branch * sign)
        a = a * (1.0 + skew * sign * (0.5 * (u[i] + u[i - 1])))
        k1 = _turn(h, step, dt, a, b, g, relaxation, scale)
        k2 = _turn(h + 0.5 * k1, step, dt, a, b, g, relaxation, scale)
        k3 = _turn(h + 0.5 * k2, step, dt, a, b, g, relaxation, scale)
        k4 = _turn(h + k3, step, dt, a, b, g, relaxation, scale)
        h += (k1 + 2 * k2 + 2 * k3 + k4) / 6
        y[i] = gain * (u[i] - h)
    return y


@njit(cache=True)
def plays(u, dt, gain, weights, widths, rate, speed):
    """gain u + sum_i w_i p_i, plays p_i <- min(max(p_i, u - r_i), u + r_i).

    Krasnosel'skii & Pokrovskii (1989), Systems with Hysteresis; Kuhnen (2003), Eur. J. Control 9, 407.

    rate: half-widths r (1 + rate ln(1 + |du/dt| / speed)): Al Janaideh, Su & Rakheja (2008), Smart Mater. Struct. 17,
    035026.
    """
    memory, y = np.zeros(widths.size), np.empty_like(u)
    for i in range(u.size):
        wider = 1.0
        if i and rate != 0.0:
            wider = 1.0 + rate * math.log(1.0 + abs(u[i] - u[i - 1]) / dt / speed)
        total = gain * u[i]
        for j in range(widths.size):
            low, high = u[i] - widths[j] * wider, u[i] + widths[j] * wider
            if memory[j] < low:
                memory[j] = low
            elif memory[j] > high:
                memory[j] = high
            total += weights[j] * memory[j]
        y[i] = total
    return y


@njit(cache=True)
def _free_energy(u, gain, remanence, fields, interaction):
    front, y, narrow = np.zeros(fields.size), np.empty_like(u), 1.0 / (interaction * math.sqrt(2.0))
    for i in range(u.size):
        turned = 0.0
        for j in range(fields.size):
            if front[j] < u[i] - fields[j]:
                front[j] = u[i] - fields[j]
            elif front[j] > u[i] + fields[j]:
                front[j] = u[i] + fields[j]
            turned += math.erf(front[j] * narrow)
        y[i] = gain * (u[i] + remanence * turned / fields.size)
    return y


def free_energy(u, gain, remanence, coercive, spread, interaction):
    """gain (u + P_R mean erf(p / (2^0.5 s_I))), p a play of half-width E_c, lognormal about `coercive`.

    Smith, Hatch, Mukherjee & Liu (2005), J. Intell. Mater. Syst. Struct. 16, 65, without thermal activation: kernels
    turn where the field with a normal interaction field passes the coercive one.
    """
    fields = coercive * np.exp(spread * norm.ppf((np.arange(FIELDS) + 0.5) / FIELDS))
    return _free_energy(u, gain, remanence, fields, interaction)


@njit(cache=True)
def creep(f, dt, shares, times):
    """f + sum_i x_i, times_i x_i' + x_i = shares_i (f - f(0)), exactly for f a line on each step.

    Kelvin-Voigt elements: Croft, Shed & Devasia (2001), J. Dyn. Syst. Meas. Contr. 123, 35. Equal shares at equal
    steps of the logarithm make a creep by the logarithm of time, Vieira (1986), IBM J. Res. Dev. 30, 553; shares
    ~ times^p one by a power of it, Findley, Lai & Onaran (1976), Creep and Relaxation of Nonlinear Viscoelastic
    Materials.
    """
    y, start = f.copy(), f[0]
    for j in range(shares.size):
        fade, ratio = math.exp(-dt / times[j]), dt / times[j]
        mean = (1 - fade) / ratio if ratio > 1e-9 else 1.0
        x = 0.0
        for i in range(1, f.size):
            x = fade * x + (f[i - 1] - start) * (mean - fade) + (f[i] - start) * (1 - mean)
            y[i] += shares[j] * x
    return y
