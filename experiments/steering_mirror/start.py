"""Where the search for the modes of the steering mirror starts: modes.yaml, from its frequency responses.

python -m experiments.steering_mirror.start

Frequencies, dampings and one delay by least squares in 5 to 2950 Hz, the residues of every mode in closed form
(variable projection), then the nearest residue of rank one: a shape and a push. The job lets them move by some percent.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from experiments.tables import table
from pzt_ident.model.first_order_hold import oscillator

Array = NDArray[np.float64]
HERE = Path(__file__).parent
DATA = Path(os.environ.get("PZT_IDENT_DATA", ".")) / "fsm_piezo_mimo"
RATE, STEPS = 6400.0, 4  # Hz, and steps of the simulation in a sample
PEAKS = np.array([641, 814, 921, 1003, 1324, 1444, 1692, 2133, 2277, 2320, 2552, 2783, 4700.0])
"""Hz, read off the singular values; the last stands for what is above 3 kHz."""
HEADER = """\
# Written by start.py from the frequency responses at 100 mV. Three axes, 13 modes, linear: Bouc-Wen at alpha = 0 is a gain.
name: steering-mirror
records:
  - {file: "${PZT_IDENT_DATA}/fsm_piezo_mimo/u_100mV_train.npy", use: identify, name: first, sample_rate: 6400 Hz, run_in: 1, smooth_drive: true, steps: 4, index: [":", ":", 0, 0], channels: {response: {file: "${PZT_IDENT_DATA}/fsm_piezo_mimo/y_100mV_train.npy"}}}
  - {file: "${PZT_IDENT_DATA}/fsm_piezo_mimo/u_100mV_train.npy", use: identify, name: second, sample_rate: 6400 Hz, run_in: 1, smooth_drive: true, steps: 4, index: [":", ":", 1, 0], channels: {response: {file: "${PZT_IDENT_DATA}/fsm_piezo_mimo/y_100mV_train.npy"}}}
  - {file: "${PZT_IDENT_DATA}/fsm_piezo_mimo/u_100mV_train.npy", use: identify, name: third, sample_rate: 6400 Hz, run_in: 1, smooth_drive: true, steps: 4, index: [":", ":", 2, 0], channels: {response: {file: "${PZT_IDENT_DATA}/fsm_piezo_mimo/y_100mV_train.npy"}}}
  - {file: "${PZT_IDENT_DATA}/fsm_piezo_mimo/u_100mV_test.npy", use: validate, name: test, sample_rate: 6400 Hz, run_in: 1, smooth_drive: true, steps: 4, index: [":", ":", 0, 0], channels: {response: {file: "${PZT_IDENT_DATA}/fsm_piezo_mimo/y_100mV_test.npy"}}}
channels:
  axes:
    x: {drive: {column: 1, unit: V}, response: {column: 1, unit: m}}
    y: {drive: {column: 2, unit: V}, response: {column: 2, unit: m}}
    z: {drive: {column: 3, unit: V}, response: {column: 3, unit: m}}
model: [bouc_wen, {name: modal, modes: 13}]
effects: [delay]
optimizers:
  - least_squares
stop: {evaluations: 6000}
seed: 1213
parameters:
  bouc_wen.gain: {value: 1.0e-6}   # m/V: the shapes are in um/V
  bouc_wen.alpha: {value: 0}
  bouc_wen.beta: {value: 1}
  bouc_wen.gamma: {value: 0}
"""  # noqa: E501


def responses() -> tuple[Array, NDArray[np.complex128]]:
    """Hz and (lines, outputs x inputs) in um/V, over realisations and periods."""
    u, y = (np.load(DATA / f"{which}_100mV_train.npy").mean(axis=-1) for which in "uy")
    drives, moves = np.fft.rfft(u, axis=0), np.fft.rfft(y, axis=0)
    hertz = np.arange(len(drives)) * RATE / len(u)
    chosen = np.flatnonzero((hertz > 5) & (hertz < 2950))
    found = [moves[i] @ np.linalg.pinv(drives[i]) for i in chosen]
    return hertz[chosen], 1e6 * np.array(found).reshape(chosen.size, -1)


def modes(hertz: Array, frequencies: Array, dampings: Array) -> NDArray[np.complex128]:
    """Response of every mode as the package steps it, its force linear between the steps: (lines, modes)."""
    z, columns = np.exp(2j * np.pi * hertz / (RATE * STEPS)), []
    for omega, zeta in zip(2 * np.pi * frequencies, dampings, strict=True):
        r11, r12, r21, r22, b1, b2 = oscillator(omega, zeta, 1 / (RATE * STEPS))
        columns.append(1 + (z - 1) * ((z - r22) * b1 + r12 * b2) / ((z - r11) * (z - r22) - r12 * r21))
    return np.array(columns).T


def delayed(hertz: Array, late: float) -> NDArray[np.complex128]:
    """Response of a delay of so many samples, again linear between the steps: (lines,)."""
    whole, part = divmod(late * STEPS, 1.0)
    step = np.exp(-2j * np.pi * hertz / (RATE * STEPS))
    return step**whole * (1 - part + part * step)


def fitted(hertz: Array, measured: NDArray[np.complex128]) -> tuple[Array, Array]:
    """Log frequencies, log dampings and the delay in samples; the residues (modes, outputs x inputs)."""
    target = np.vstack([measured.real, measured.imag])

    def residues(own: Array) -> tuple[Array, Array]:
        basis = modes(hertz, *np.exp(np.split(own[:-1], 2))) * delayed(hertz, own[-1])[:, None]
        stacked = np.vstack([basis.real, basis.imag])
        found = np.linalg.lstsq(stacked, target, rcond=None)[0]
        return found, (stacked @ found - target).ravel()

    damping = np.where(PEAKS > 3000, 0.15, 0.015)
    start = np.concatenate([np.log(PEAKS), np.log(damping), [0.8]])
    near = np.concatenate([np.full(PEAKS.size, 0.06), np.full(PEAKS.size, 3.0), [0.19]])
    found = least_squares(lambda own: residues(own)[1], start, bounds=(start - near, start + near), x_scale=near / 5)
    return found.x, residues(found.x)[0]


def ranks(own: Array, residues: Array) -> str:
    """How far the residues are from those of modes: the second singular value over the first."""
    sizes = np.linalg.svd(residues.reshape(-1, 3, 3), compute_uv=False)
    kinds = zip(np.exp(own[: PEAKS.size]), np.exp(own[PEAKS.size : -1]), sizes[:, 1] / sizes[:, 0], strict=True)
    rows = [[f"{hertz:.4g}", f"{damping:.2g}", f"{share:.1%}"] for hertz, damping, share in kinds]
    return table(["frequency [Hz]", "damping", "second over first singular value"], rows)


def job(own: Array, residues: Array) -> str:
    lines = [f"  delay.time: {{bounds: [0, {2 * own[-1] / RATE:.4g}]}} # s"]
    count = PEAKS.size
    for i in range(count):
        hertz, damping = np.exp(own[i]), np.exp(own[count + i])
        lines.append(f"  modal.frequency_{i + 1}: {{bounds: [{hertz * 0.985:.5g}, {hertz * 1.015:.5g}]}}")
        lines.append(f"  modal.damping_{i + 1}: {{bounds: [{damping * 0.7:.3g}, {damping * 1.4:.3g}]}}")
        left, sizes, right = np.linalg.svd(residues[i].reshape(3, 3))
        shape, push = left[:, 0] * sizes[0] * right[0, 0], right[0] / right[0, 0]
        lines += [around(f"{axis}.modal.shape_{i + 1}", shape[a], np.abs(shape).max()) for a, axis in enumerate("xyz")]
        lines += [around(f"{axis}.modal.push_{i + 1}", push[a], np.abs(push).max()) for a, axis in ((1, "y"), (2, "z"))]
    return HEADER + "\n".join(lines) + "\n"


def around(name: str, value: float, size: float) -> str:
    reach = 0.25 * abs(value) + 0.1 * size
    return f"  {name}: {{bounds: [{value - reach:.4g}, {value + reach:.4g}]}}"


if __name__ == "__main__":
    found = fitted(*responses())
    (HERE / "modes.yaml").write_text(job(*found), encoding="utf-8")
    print(ranks(*found))
