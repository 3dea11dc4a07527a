"""PI gains for an identified stage."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from pzt_ident.api.arguments import rate_or_stamps
from pzt_ident.api.printed import html, table_text
from pzt_ident.control.continuous import routh_damping
from pzt_ident.control.identified import Identified
from pzt_ident.control.plant import plant_of
from pzt_ident.control.stage import MECHANICS
from pzt_ident.control.tuning import Loop
from pzt_ident.control.tuning import tune as tuned
from pzt_ident.data.notation import number, quantity
from pzt_ident.data.units import factor
from pzt_ident.errors import InputError

STEPS = 256, 2**15  # of the stage in a sample of the controller, least and most
FINE = 4e-6  # s, of a step, by which resonances of a stage are followed
MOST = 50  # samples of computing delay


@dataclass(frozen=True)
class Gains:
    """PI gains of one axis, kp in `kp_unit` and ki in `ki_unit`, and what its loop is worth.

    gain_margin: factor; phase_margin: degrees. sensitivity: the largest amplification of a disturbance. radius: of the
    largest closed-loop pole, below one. bandwidth: Hz. slope: the largest of the material, response over drive.
    damping, damping_needed: of a lumped model, N s/m, and what the same gains need in continuous time.
    """

    kp: float
    ki: float
    kp_unit: str
    ki_unit: str
    gain_margin: float
    phase_margin: float
    sensitivity: float
    radius: float
    bandwidth: float
    slope: float
    slope_unit: str
    damping: float | None = None
    damping_needed: float | None = None


@dataclass(frozen=True)
class Tuning:
    """PI gains by axis, at a sample rate, Hz, and a computing delay in samples."""

    rate: float
    delay: int
    gains: Mapping[str, Gains]

    def __getitem__(self, axis: str) -> Gains:
        return self.gains[axis]

    @property
    def facts(self) -> dict[str, Any]:
        """Plain values; None for a margin without end."""
        rows = {axis: asdict(gains) for axis, gains in self.gains.items()}
        finite = {
            axis: {k: None if isinstance(v, float) and not np.isfinite(v) else v for k, v in row.items()}
            for axis, row in rows.items()
        }
        return {"rate": self.rate, "delay": self.delay, "gains": finite}

    def __str__(self) -> str:
        return f"{self._headline()}\n\n{table_text(*self._table())}{self._foot()}"

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return html(self._headline(), *self._table(), self._foot())

    def _headline(self) -> str:
        samples = "1 sample" if self.delay == 1 else f"{self.delay} samples"
        return f"PI at {quantity(self.rate, 'Hz')} with {samples} of computing delay, each axis by itself"

    def _table(self) -> tuple[list[str], list[list[str]]]:
        header = ["axis", "Kp", "Ki", "gain margin", "phase margin", "sensitivity", "largest pole", "bandwidth"]
        rows = [
            [
                axis,
                quantity(gains.kp, gains.kp_unit),
                quantity(gains.ki, gains.ki_unit),
                number(gains.gain_margin, 3),
                f"{number(gains.phase_margin, 3)}°",
                number(gains.sensitivity, 3),
                number(gains.radius),
                quantity(gains.bandwidth, "Hz", 3),
            ]
            for axis, gains in self.gains.items()
        ]
        return header, rows

    def _foot(self) -> str:
        lines = [
            f"{axis}: the loop gain is the largest slope of the material, {quantity(gains.slope, gains.slope_unit)}"
            for axis, gains in self.gains.items()
        ]
        lines += [
            f"{axis}: in continuous time these gains would need a damping of {number(gains.damping_needed, 3)} N s/m"
            f" (Routh); the model has {number(gains.damping, 3)}"
            for axis, gains in self.gains.items()
            if gains.damping_needed is not None
        ]
        return "\n" + "\n".join(lines)


def tune(
    identified: Identified,
    rate: float | str = 1000.0,
    delay: int = 1,
    gain_margin: float = 2.0,
    phase_margin: float = 60.0,
    axis: str | None = None,
) -> Tuning:
    """The PI gains of greatest integral gain that keep both margins, of an axis or of every measured one.

    rate: of the controller, Hz, or text such as '1 kHz'. delay: samples from a reading to the drive that answers it.
    Friction is left out: it takes from the gain of the loop, until the stage slides.

    Raises InputError for an axis that is not in the result, and where no gains keep the margins.
    """
    remedy = "give a rate in Hz, or text such as '1 kHz'"
    per_second, _ = rate_or_stamps(rate, "rate")
    if per_second is None:
        raise InputError("is no single number", where="rate", remedy=remedy)
    if isinstance(delay, bool) or not isinstance(delay, int) or not 0 <= delay <= MOST:
        raise InputError(f"{delay!r} is no delay", where="delay", remedy="give whole samples, such as 1")
    if not 1 <= gain_margin < np.inf:
        raise InputError(f"{gain_margin:g} is no margin", where="gain_margin", remedy="give 1 or more, such as 2")
    if not 0 <= phase_margin < 90:
        remedy = "give degrees from 0 to below 90, such as 60"
        raise InputError(f"{phase_margin:g} is no margin", where="phase_margin", remedy=remedy)
    if axis is not None and axis not in identified.axes:
        remedy = f"give {', '.join(identified.axes)}"
        raise InputError(f"axis {axis!r} is not in the result", where="axis", remedy=remedy)
    stated = per_second, delay, gain_margin, phase_margin
    chosen = identified.axes if axis is None else (axis,)
    return Tuning(per_second, delay, {name: _of(identified, name, *stated) for name in chosen})


def _of(identified: Identified, axis: str, rate: float, delay: int, gain: float, phase: float) -> Gains:
    place = identified.chain.axes.index(axis)
    low, high = identified.range[place].tolist()
    steps = substeps(rate)
    plant = plant_of(sliding(identified).stage(1 / (rate * steps)), place, (low, high), steps)
    try:
        loop = tuned(plant, delay, gain, phase)
    except InputError as error:
        raise InputError(error.message, where=f"axis {axis}", remedy=error.remedy) from None
    drive, response = identified.drive_units[place], identified.inputs[axis]
    over = factor(response) / factor(drive)
    return Gains(
        loop.kp * over,
        loop.ki * over,
        f"{drive}/{response}",
        f"{drive}/({response} s)",
        *loop.margins,
        loop.radius,
        loop.bandwidth,
        plant.gain / over,
        f"{response}/{drive}",
        *_damping(identified, axis, loop),
    )


def substeps(rate: float) -> int:
    """Steps of the stage in a sample of the controller."""
    return int(np.clip(round(1 / (rate * FINE)), *STEPS))


def sliding(identified: Identified) -> Identified:
    """Without friction in its equation of motion, which for small motions is a spring."""
    theta = identified.theta.copy()
    for column, entry in enumerate(identified.chain.entries):
        if entry.parameter.effect_word == "friction" and entry.parameter.null is not None:
            theta[column] = entry.parameter.null
    return replace(identified, theta=theta)


def _damping(identified: Identified, axis: str, loop: Loop) -> tuple[float | None, float | None]:
    """Of a model whose one block of mechanics is one mass on a spring."""
    model = identified.chain
    mechanics = [block for block in model.blocks if block.place in MECHANICS]
    values = dict(zip(model.names, identified.theta, strict=True))
    if [block.name for block in mechanics] != ["lumped"] or model.terms(mechanics[0]):
        return None, None
    mass, damping = (values.get(f"{axis}.lumped.{word}", values.get(f"lumped.{word}")) for word in ("mass", "damping"))
    if mass is None or damping is None:
        return None, None
    return float(damping), float(routh_damping(mass, loop.plant.gain, loop.kp, loop.ki))
