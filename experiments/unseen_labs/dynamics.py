"""Linear systems exact for drives that are straight between samples, and integrated oscillators and amplifiers."""

import math

import numpy as np
from numba import njit
from scipy import signal


def linear(numerator, denominator, u, dt):
    """Transfer function at rest under its first input."""
    b, a, _ = signal.cont2discrete((numerator, denominator), dt, "foh")
    return signal.lfilter(b.ravel(), a, u - u[0]) + numerator[-1] / denominator[-1] * u[0]


def lag(u, dt, tau):
    """tau dy/dt + y = u."""
    decay = math.exp(-dt / tau)
    share = (1 - decay) * tau / dt
    return signal.lfilter([1 - share, share - decay], [1, -decay], u - u[0]) + u[0]


def second_order(u, dt, frequency, damping):
    """A mode or a filter with a static gain of one; damping: twice its ratio."""
    omega = 2 * np.pi * frequency
    return linear([1], [1 / omega**2, damping / omega, 1], u, dt)


def lumped(force, dt, mass, damping, stiffness):
    """m x'' + b x' + k x = k f."""
    return linear([stiffness], [mass, damping, stiffness], force, dt)


def creep(force, dt, times, shares):
    """Kelvin-Voigt elements in a row with the force (Croft et al. 2001)."""
    out, raised = force.copy(), force - force[0]
    for time, share in zip(times, shares, strict=True):
        out = out + share * lag(raised, dt, time)
    return out


@njit(cache=True)
def _states(a, b, c, d, inputs):
    x, y = np.zeros(a.shape[0]), np.zeros((inputs.shape[0], c.shape[0]))
    for i in range(inputs.shape[0]):
        y[i] = c @ x + d @ inputs[i]
        x = a @ x + b @ inputs[i]
    return y


def state_space(a, b, c, d, inputs, dt):
    """Outputs by column for inputs by column, at rest under the first."""
    *discrete, _ = signal.cont2discrete((a, b, c, d), dt, "foh")
    static = d - c @ np.linalg.solve(a, b)
    varying = np.ascontiguousarray(inputs - inputs[0])
    return _states(*map(np.ascontiguousarray, discrete), varying) + (static @ inputs[0])[None, :]


def chain(force, dt, mass, damping, stiffness, *, second, frequency, ratio):
    """The first of two masses; the second stands on it with its own frequency and damping ratio."""
    omega = 2 * np.pi * frequency
    k, b = second * omega * omega, 2 * ratio * second * omega
    platform = [-(stiffness + k) / mass, -(damping + b) / mass, k / mass, b / mass]
    a = np.array([[0, 1, 0, 0], platform, [0, 0, 0, 1], [k / second, b / second, -k / second, -b / second]])
    drive = np.array([[0], [stiffness / mass], [0], [0.0]])
    output, through = np.array([[1.0, 0, 0, 0]]), np.zeros((1, 1))
    return state_space(a, drive, output, through, force[:, None].copy(), dt)[:, 0].copy()


def coupled(forces, dt, x, y, *, of_y, of_x):
    """Two masses that pull at each other: m x'' + b x' + k x = k f + of_y y, and likewise for y."""
    a, b, c = np.zeros((4, 4)), np.zeros((4, 2)), np.zeros((2, 4))
    a[0, 1] = a[2, 3] = c[0, 0] = c[1, 2] = 1
    a[1] = [-x["stiffness"] / x["mass"], -x["damping"] / x["mass"], of_y / x["mass"], 0]
    a[3] = [of_x / y["mass"], 0, -y["stiffness"] / y["mass"], -y["damping"] / y["mass"]]
    b[1, 0], b[3, 1] = x["stiffness"] / x["mass"], y["stiffness"] / y["mass"]
    inputs = np.column_stack([forces["x"], forces["y"]])
    moved = state_space(a, b, c, np.zeros((2, 2)), inputs, dt)
    return {"x": moved[:, 0].copy(), "y": moved[:, 1].copy()}


@njit(cache=True)
def _acceleration(x, v, held, f, m, b, k, cubic, bristle, slip, gap, film):
    """Acceleration, and change of the friction."""
    narrow = (1.0 - x / gap) ** 3 if gap > 0 else 1.0
    a = (k * f - (b + film / narrow) * v - k * x - k * cubic * x * x * x - k * held) / m
    change = bristle * (v - abs(v) * held / slip) if bristle > 0 else 0.0
    return a, change


@njit(cache=True)
def _integrated(f, dt, m, b, k, cubic, bristle, slip, gap, film):
    y = np.zeros(f.size)
    x, v, held = f[0], 0.0, 0.0
    for _ in range(40):
        x -= (x + cubic * x * x * x - f[0]) / (1 + 3 * cubic * x * x)
    y[0] = x
    more = (m, b, k, cubic, bristle, slip, gap, film)
    half = 0.5 * dt
    for i in range(1, f.size):
        middle = 0.5 * (f[i - 1] + f[i])
        a1, d1 = _acceleration(x, v, held, f[i - 1], *more)
        a2, d2 = _acceleration(x + half * v, v + half * a1, held + half * d1, middle, *more)
        a3, d3 = _acceleration(x + half * (v + half * a1), v + half * a2, held + half * d2, middle, *more)
        a4, d4 = _acceleration(x + dt * (v + half * a2), v + dt * a3, held + dt * d3, f[i], *more)
        x += dt * v + dt * dt * (a1 + a2 + a3) / 6
        v += dt * (a1 + 2 * a2 + 2 * a3 + a4) / 6
        held += dt * (d1 + 2 * d2 + 2 * d3 + d4) / 6
        y[i] = x
    return y


def oscillator(force, dt, mass, damping, stiffness, cubic=0.0, bristle=0.0, slip=1.0, gap=0.0, film=0.0):
    """m x'' + (b + film / (1 - x / gap)^3) x' + k (x + cubic x^3 + F) = k f, fourth order.

    F: friction after Dahl (1976), dF/dt = bristle (v - |v| F / slip), in um of stroke. film: a plate at a gap that
    squeezes air (Bao and Yang 2007).
    """
    return _integrated(force, dt, mass, damping, stiffness, cubic, bristle, slip, gap, film)


@njit(cache=True)
def slew(u, dt, up, down, growth):
    """|dy/dt| is at most up or down over 1 + growth y: a current into a capacitance that grows with the voltage."""
    y = np.zeros(u.size)
    y[0] = x = u[0]
    for i in range(1, u.size):
        size, step = 1 + growth * x, u[i] - x
        if step > up / size * dt:
            step = up / size * dt
        if step < -down / size * dt:
            step = -down / size * dt
        x += step
        y[i] = x
    return y


@njit(cache=True)
def charged(u, dt, tau, growth):
    """tau (1 + growth y) dy/dt + y = u: a resistance before that capacitance."""
    y = np.zeros(u.size)
    y[0] = x = u[0]
    for i in range(1, u.size):
        first = (u[i - 1] - x) / (tau * (1 + growth * x))
        between = x + 0.5 * dt * first
        x = x + dt * (0.5 * (u[i] + u[i - 1]) - between) / (tau * (1 + growth * between))
        y[i] = x
    return y


def late(u, dt, delay):
    """u(t - delay)."""
    t = np.arange(u.size) * dt
    return np.interp(t - delay, t, u)
