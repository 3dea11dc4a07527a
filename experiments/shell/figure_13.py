"""What a shell adds to a scalar gain: loops, the clamped end, frequencies; Smith et al., Fig. 13.

python -m experiments.shell.figure_13
"""

from __future__ import annotations

from types import SimpleNamespace

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from scipy.interpolate import BSpline

from experiments.simulate import Array, keep, named, simulate
from experiments.tables import number, table
from pzt_ident.mechanics._linear import forms, modes, sections
from pzt_ident.mechanics._shell import matrices
from pzt_ident.model.registry import blocks

TUBE = {"density": 7600.0, "modulus": 7.1e10, "viscosity": 1e5, "length": 0.0396, "radius": 0.0056}
TUBE |= {"thickness": 0.0015, "poisson": 0.3, "end_mass": 0.0}
LOOP = {"bouc_wen.gain": 2.75e-10, "bouc_wen.alpha": 0.4, "bouc_wen.beta": 1.2e-3, "bouc_wen.gamma": 4e-4}
"""m per V/m, 1, m/V, m/V: 6e-7 m over -2500 to 0 V/m, as in Fig. 13."""
ELEMENTS = 24


def own(harmonic: int = 0, elements: int = ELEMENTS, **other: float) -> SimpleNamespace:
    return SimpleNamespace(**(TUBE | other), load=0.0, elements=elements, harmonic=harmonic)


def at_rest(shell: SimpleNamespace) -> Array:
    """Coefficients of u and w under a1 (P - P_R) = Y."""
    _, _, stiffness, load, _ = matrices(shell)
    return shell.modulus * np.linalg.solve(stiffness, load)


def profile(shell: SimpleNamespace) -> tuple[Array, Array, Array]:
    """x in m, u over that of a membrane at its end, w over R."""
    found, n = at_rest(shell), shell.elements
    knots = np.concatenate([np.zeros(3), np.linspace(0, 1, n + 1), np.ones(3)])
    x = np.linspace(0, 1, 400)
    u = BSpline(knots, np.append(0, found[: n + 2]), 3)(x) / shell.length
    w = BSpline(knots, np.append([0, 0], found[n + 2 :]), 3)(x) / shell.radius
    return x * shell.length, u, w


def frequencies(shell: SimpleNamespace) -> Array:
    mass, _, stiffness, *_ = matrices(shell)
    return modes(mass, stiffness)[0] / (2 * np.pi)


def lengthening() -> str:
    rows = []
    for elements in (4, 8, 12, 24, 48):
        shell = own(elements=elements)
        _, _, _, _, output = matrices(shell)
        rows.append([elements, f"{output @ at_rest(shell) / shell.length:.5f}", number(frequencies(shell)[0], 6)])
    return table(["elements", "end at rest over that of a membrane", "first mode, m = 0 [Hz]"], rows)


def shapes() -> str:
    rows = []
    for harmonic in range(5):
        found = frequencies(own(harmonic))[:3]
        _, damping, stiffness, *_ = matrices(own(harmonic))
        constants = forms(damping, stiffness, stiffness)
        rows.append([harmonic, *(number(each, 4) for each in found), f"{constants.c4:.4e}", f"{constants.c3:.4e}"])
    return table(["m", "1st mode [Hz]", "2nd [Hz]", "3rd [Hz]", "c4 [s]", "c3 [s]"], rows)


def beam() -> float:
    """First bending frequency by Euler and Bernoulli, above that with shear, in Hz."""
    speed = np.sqrt(TUBE["modulus"] / TUBE["density"] / 2) * TUBE["radius"]
    return float(1.8751040687**2 * speed / TUBE["length"] ** 2 / (2 * np.pi))


def scalar() -> str:
    """The end behind Bouc-Wen by the shell less that by a gain of one, over the peak-to-peak displacement."""
    rows = []
    for hertz in (1.0, 10.0, 100.0, 1e3, 5e3):
        field, dt = drive(hertz)
        gain, shell = (end(chain, field, dt) for chain in ("gain", "shell"))
        heavy = end("shell", field, dt, end_mass=0.1)
        rows.append([f"{hertz:g}", *(f"{np.abs(each - gain).max() / np.ptp(gain):.1e}" for each in (shell, heavy))])
    return table(["Hz", "shell less gain", "with 100 g at its end"], rows)


def drive(hertz: float) -> tuple[Array, float]:
    """Two periods of a field from 0 to -2500 V/m in V/m, and the sample time."""
    return -1250 * (1 - np.cos(2 * np.pi * np.arange(2001) / 1000)), 1e-3 / hertz


def end(chain: str, field: Array, dt: float, **other: float) -> Array:
    if chain == "gain":
        return simulate(["bouc_wen"], LOOP, field, dt)
    shell = blocks["shell"].make(elements=ELEMENTS, modes=6)
    return simulate(["bouc_wen", shell], LOOP | named("shell", TUBE | other), field, dt)


def response(hertz: Array, **other: float) -> Array:
    """|end| over its value at rest, at each frequency."""
    omega, zeta, share, _ = (each[:, None] for each in sections(*matrices(own(**other))))
    s = 2j * np.pi * hertz / omega
    return np.abs((share / (1 + 2 * zeta * s + s**2)).sum(axis=0))


def draw() -> plt.Figure:
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(12, 3.5), layout="constrained")
    for hertz, other, style in ((1.0, {}, "-"), (1e3, {"end_mass": 0.1}, "--")):
        field, dt = drive(hertz)
        loop = end("shell", field, dt, **other)
        name = f"{hertz:g} Hz" + (", 100 g at the end" if other else "")
        left.plot(field, 1e7 * (loop + 2e-7), style, linewidth=1, label=name)
    left.set(xlabel="field, voltage over length [V/m]", ylabel="displacement of the end [1e-7 m]", xlim=(-2600, 100))
    x, u, w = profile(own())
    middle.plot(1e3 * x, w, label="w / R")
    middle.plot(1e3 * x, u, label="u / l")
    middle.plot(1e3 * x, x / TUBE["length"], "k:", linewidth=0.8, label="membrane")
    middle.axhline(1, color="k", linestyle=":", linewidth=0.8)
    middle.set(xlabel="from the clamped end [mm]", ylabel="over the free strain")
    hertz = np.logspace(2, 5.2, 3000)
    for mass, name in ((0.0, "free end"), (0.1, "100 g at the end")):
        right.loglog(hertz, response(hertz, end_mass=mass), linewidth=0.9, label=name)
    right.axhline(1, color="k", linestyle=":", linewidth=0.8)
    right.set(xlabel="frequency [Hz]", ylabel="|end / end at rest|")
    for axes in (left, middle, right):
        axes.legend(frameon=False, fontsize=8)
    return figure


def text() -> str:
    parts = ["**At rest and first mode**", lengthening(), "**Modes around the shell**", shapes()]
    parts += [f"A beam of the same section bends at {beam():.0f} Hz at most.", "**Shell and scalar gain**", scalar()]
    return "\n\n".join(parts)


if __name__ == "__main__":
    keep("shell", "figure_13", draw(), text())
