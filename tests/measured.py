"""Measurements made up without the package, as tables."""

import numpy as np


def lagging(u, rng):
    """A response in um to a drive in V, 30 % of which is a mean over the last 40 samples."""
    return 0.08 * (0.7 * u + 0.3 * np.convolve(u, np.ones(40) / 40)[: u.size]) + rng.normal(0, 0.01, u.size)


def creeping(u, dt, ratio, tau, width, height):
    """A response in um to a drive in V, behind by `height` for steps beyond `width`, with a creep of `ratio`."""
    creep = np.zeros(u.size)
    for i in range(1, u.size):
        creep[i] = creep[i - 1] + dt / tau * (0.1 * ratio * u[i] - creep[i - 1])
    return 0.1 * u - height * np.tanh(np.gradient(u) / width) + creep


def write(path, t, u, x):
    header = "time [s],u_x [V],x [um]"
    np.savetxt(path, np.column_stack([t, u, x]), delimiter=",", header=header, comments="", fmt="%.9g")


def write_raised(path, samples):
    """Three raised cosines of 100 V in a second through a lag."""
    t = np.arange(samples) / samples
    u = 50 * (1 - np.cos(6 * np.pi * t))
    write(path, t, u, lagging(u, np.random.default_rng(0)))
