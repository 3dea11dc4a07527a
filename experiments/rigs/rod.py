"""Virtual piezo rod with a payload: the wave equation with internal damping behind Bouc-Wen, integrated by scipy.

It makes measured-like records and shares no code with pzt_ident. The displacement is a polynomial in x (Galerkin),
where the package has elements; a voltage that is linear between samples, as a waveform generator's filter leaves it,
drives Bouc-Wen, whose free displacement drives the rod (Smith et al., Model Development for AFM Stage Mechanisms, eq.
17 to 20). `python experiments/rigs/rod.py --out .` in the repository's root writes the committed files (a minute).
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.polynomial import Legendre, Polynomial
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rod:
    """In SI units: a stack of 10 x 10 x 60 mm with 50 g at its end; first modes at 6.6 and 27 kHz."""

    density: float = 7600.0
    area: float = 1e-4
    length: float = 0.06
    modulus: float = 7e10
    viscosity: float = 1e5
    end_mass: float = 0.05

    def matrices(self, degree: int = 9) -> tuple[Array, Array, Array]:
        """Mass, stiffness (the damping is viscosity / modulus of it) and shapes at the end: x P_k(2 x / l - 1) / l."""
        line = Polynomial([0, 1 / self.length])
        shapes = [line * Legendre.basis(k, domain=[0, self.length]).convert(kind=Polynomial) for k in range(degree)]
        end = np.array([shape(self.length) for shape in shapes])

        def integrals(parts: list[Polynomial]) -> Array:
            return np.array([[(a * b).integ()(self.length) for b in parts] for a in parts])

        mass = self.density * self.area * integrals(shapes) + self.end_mass * np.outer(end, end)
        return mass, self.modulus * self.area * integrals([shape.deriv() for shape in shapes]), end

    def frequencies(self) -> Array:
        """Hz, slowest first."""
        mass, stiffness, _ = self.matrices()
        return np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real)) / (2 * np.pi)


GAIN, ALPHA, BETA, GAMMA = 6e-7, 0.5, 0.02, 0.01  # m/V, 1, 1/V, 1/V


def simulate(rod: Rod, time: Array, voltage: Array) -> Array:
    """Displacement of the end in m, from rest at 0 V."""
    mass, stiffness, end = rod.matrices()
    size = end.size
    inverse = np.linalg.inv(mass)
    spring, damper = inverse @ stiffness, rod.viscosity / rod.modulus * (inverse @ stiffness)
    push = inverse @ end * rod.modulus * rod.area / rod.length
    state, found = np.zeros(2 * size + 1), [0.0]
    for (start, stop), (low, high) in zip(pairwise(time), pairwise(voltage), strict=True):
        rate = (high - low) / (stop - start)

        def slope(t: float, z: Array, start: float = start, low: float = low, rate: float = rate) -> Array:
            q, v, h = z[:size], z[size:-1], z[-1]
            free = GAIN * (low + rate * (t - start)) - h
            fading = ALPHA * GAIN * rate - BETA * abs(rate) * h - GAMMA * rate * abs(h)
            return np.concatenate([v, push * free - spring @ q - damper @ v, [fading]])

        state = solve_ivp(slope, (start, stop), state, method="DOP853", rtol=1e-8, atol=1e-16).y[:, -1]
        found.append(float(end @ state[:size]))
    return np.array(found)


def waves(seed: int, time: Array, cycles: int, high: float, amplitude: float) -> Array:
    """Slow cycles of 100 V from 0 V, and up to `amplitude` V of 40 tones up to `high` Hz of random phase on them."""
    rng = np.random.default_rng(seed)
    slow = 50 * (1 - np.cos(2 * np.pi * cycles * time / time[-1]))
    tones = np.linspace(500, high, 40)
    fast = np.sin(2 * np.pi * np.outer(time, tones) + rng.uniform(0, 2 * np.pi, 40)).sum(axis=1)
    return slow + amplitude * np.minimum(time / 1e-3, 1) ** 2 * fast / np.abs(fast).max()


def records() -> dict[str, tuple[Array, Array]]:
    """Time in s and voltage in V of every committed file."""
    time = np.arange(4000) / 400e3
    return {"rod": (time, waves(1, time, 1, 40e3, 8)), "rod_validate": (time, waves(2, time, 2, 36e3, 6))}


def write(folder: Path, noise: float = 10e-9) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for number, (name, (time, voltage)) in enumerate(records().items()):
        voltage = np.round(voltage, 4)
        x = simulate(Rod(), time, voltage) + noise * np.random.default_rng(number).standard_normal(time.size)
        rows = np.column_stack([time, voltage, np.round(1e6 * x, 4)])
        lines = ["time [s],u_x [V],x [um]", *(",".join(f"{value:.9g}" for value in row) for row in rows)]
        (folder / f"{name}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description="Write the records of the virtual rod.")
    parser.add_argument("--out", type=Path, required=True, help="folder that the repository's paths are laid out in")
    write(parser.parse_args().out / "experiments/rod/data")


if __name__ == "__main__":
    main()
