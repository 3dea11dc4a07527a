"""Virtual piezo tube with a payload: a thin shell behind relays of the homogenized energy model, by numpy and scipy.

It makes measured-like records and shares no code with pzt_ident. Along the tube the displacements are polynomials
(Ritz), where the package has splines; the response of the material is that of 80,000 relays, where the package has
plays; in time the slowest modes are stepped by a matrix exponential for a force that is linear between samples, the
others are at rest (Smith et al., Model Development for AFM Stage Mechanisms, eq. 7, 12 and 24 to 29).
`python experiments/rigs/shell.py --out .` in the repository's root writes the committed files.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.linalg import eigh, expm
from scipy.stats import norm

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Tube:
    """In SI units: the actuator of Smith et al., 20 g at its end; first mode at 9.8 kHz."""

    density: float = 7600.0
    modulus: float = 7.1e10
    viscosity: float = 1e5
    length: float = 0.0396
    radius: float = 0.0056
    thickness: float = 0.0015
    poisson: float = 0.3
    end_mass: float = 0.02

    def matrices(self, degree: int = 24) -> tuple[Array, Array, Array, Array]:
        """Mass, stiffness (the damping is viscosity / modulus of it), load of a field that is the same everywhere, and
        shapes at the end: x P_k(2 x / l - 1) / l of u and x^2 P_k / l^2 of w, per radian around the tube."""
        points, weights = legendre.leggauss(3 * degree)
        s, weights = (points + 1) / 2, weights * self.length / 2
        kept = np.eye(degree)

        def shapes(power: int, at: Array, order: int) -> Array:
            whole = [
                legendre.Legendre(row, domain=[0, 1]) * legendre.Legendre.fromroots([0] * power, domain=[0, 1])
                for row in kept
            ]
            return np.array([shape.deriv(order)(at) if order else shape(at) for shape in whole]) / self.length**order

        u, du, w, ddw = shapes(1, s, 0), shapes(1, s, 1), shapes(2, s, 0), shapes(2, s, 2)
        wall = self.modulus * self.thickness / (1 - self.poisson**2) * self.radius

        def form(a: Array, b: Array) -> Array:
            return (a * weights) @ b.T

        hoop = self.poisson / self.radius * form(du, w)
        ring = form(w, w) / self.radius**2 + self.thickness**2 / 12 * form(ddw, ddw)
        stiffness = wall * np.block([[form(du, du), hoop], [hoop.T, ring]])
        end = np.concatenate([shapes(1, np.ones(1), 0)[:, 0], np.zeros(degree)])
        mass = np.zeros_like(stiffness)
        mass[:degree, :degree], mass[degree:, degree:] = form(u, u), form(w, w)
        mass = self.density * self.thickness * self.radius * mass
        mass += self.end_mass / (2 * np.pi) * np.outer(end, end)
        load = np.concatenate([du @ weights, w @ weights / self.radius])
        return mass, stiffness, load, end

    def modes(self, count: int = 6) -> tuple[Array, Array, float]:
        """Natural frequencies in rad/s, what each adds at rest to an end that moves by one, and what the rest adds."""
        mass, stiffness, load, end = self.matrices()
        squares, shapes = eigh(stiffness, mass)
        at_rest = end @ np.linalg.solve(stiffness, load)
        shares = (end @ shapes) * (load @ shapes) / squares / at_rest
        return np.sqrt(squares[:count]), shares[:count], float(1 - shares[:count].sum())


GAIN, REMANENCE, COERCIVE, SPREAD, INTERACTION = 4e-9, 90.0, 30.0, 0.8, 60.0  # m/V, V, V, 1, V


def relays(voltage: Array, kinds: int = 200, fields: int = 400) -> Array:
    """Displacement at rest in m, from the virgin state: up at E + EI >= Ec, down at E + EI <= -Ec."""
    coercive = COERCIVE * np.exp(SPREAD * norm.ppf((np.arange(kinds) + 0.5) / kinds))[:, None]
    interaction = INTERACTION * norm.ppf((np.arange(fields) + 0.5) / fields)
    up = np.tile(interaction > 0, (kinds, 1))
    found = []
    for volt in voltage:
        up = (up | (volt + interaction >= coercive)) & ~(volt + interaction <= -coercive)
        found.append(GAIN * (volt + REMANENCE * (2 * up.mean() - 2)))
    return np.array(found)


def simulate(tube: Tube, time: Array, voltage: Array) -> Array:
    """Displacement of the end in m, at rest under the first sample."""
    free, step = relays(voltage), time[1] - time[0]
    omegas, shares, rest = tube.modes()
    found = rest * free
    for omega, share in zip(omegas, shares, strict=True):
        fade = tube.viscosity / tube.modulus * omega**2
        turn = np.array([[0, 1, 0, 0], [-(omega**2), -fade, omega**2, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
        keep = expm(turn * step)
        state = np.array([free[0], 0.0])
        each = [state[0]]
        for low, high in pairwise(free):
            state = (keep @ np.array([*state, low, (high - low) / step]))[:2]
            each.append(state[0])
        found = found + share * np.array(each)
    return found


def waves(seed: int, time: Array, levels: list[float], high: float, amplitude: float) -> Array:
    """Slow legs between levels in V, rounded, and up to `amplitude` V of 40 tones up to `high` Hz of random phase."""
    rng = np.random.default_rng(seed)
    place = np.linspace(0, len(levels) - 1, time.size)
    leg = np.minimum(place.astype(int), len(levels) - 2)
    begun, ends = np.array(levels)[leg], np.array(levels)[leg + 1]
    slow = begun + (ends - begun) * (1 - np.cos(np.pi * (place - leg))) / 2
    tones = np.linspace(500, high, 40)
    fast = np.sin(2 * np.pi * np.outer(time, tones) + rng.uniform(0, 2 * np.pi, 40)).sum(axis=1)
    return slow + amplitude * np.minimum(time / 1e-3, 1) ** 2 * fast / np.abs(fast).max()


def records() -> dict[str, tuple[Array, Array]]:
    """Time in s and voltage in V of every committed file."""
    time = np.arange(4000) / 200e3
    return {
        "shell": (time, waves(1, time, [0, 100, 20, 80, 0, 60, 0], 30e3, 6)),
        "shell_validate": (time, waves(2, time, [0, 90, 10, 50, 30, 70, 0], 26e3, 5)),
    }


def write(folder: Path, noise: float = 0.5e-9) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for number, (name, (time, voltage)) in enumerate(records().items()):
        voltage = np.round(voltage, 4)
        x = simulate(Tube(), time, voltage) + noise * np.random.default_rng(number).standard_normal(time.size)
        rows = np.column_stack([time, voltage, np.round(1e6 * (x - x[0]), 5)])
        lines = ["time [s],u_x [V],x [um]", *(",".join(f"{value:.9g}" for value in row) for row in rows)]
        (folder / f"{name}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description="Write the records of the virtual tube.")
    parser.add_argument("--out", type=Path, required=True, help="folder that the repository's paths are laid out in")
    write(parser.parse_args().out / "experiments/shell/data")


if __name__ == "__main__":
    main()
