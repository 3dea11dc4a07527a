"""An identified model with all that control and export need: no records."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.control.stage import EVERYTHING, Stage
from pzt_ident.data.units import factor
from pzt_ident.model.chain import Chain, Entry

Array = NDArray[np.float64]
SAMPLES = 400  # of the test vector


@dataclass(frozen=True)
class Identified:
    """theta: (parameters,), SI units; units, errors: of each parameter, in the user's units, None where no standard
    error is known. dt: s. range: (axes, 2), the drives that it was identified with, SI units. response_units: None for
    an axis that is not measured. frequencies: (axes,), the highest root-mean-square frequency of their drives, Hz.
    limits: lowest and highest drive and its largest change in a second, as the job states them, None where it does not.
    origin: what it was identified from, in a sentence. words: what a job calls its blocks, `model`, `effects`, `shared`
    and `given`."""

    name: str
    chain: Chain
    theta: Array
    units: tuple[str, ...]
    errors: tuple[float | None, ...]
    dt: float
    range: Array
    drive_units: tuple[str, ...]
    response_units: tuple[str | None, ...]
    frequencies: tuple[float, ...]
    limits: tuple[tuple[float, float] | None, float | None] = (None, None)
    origin: str = ""
    words: Mapping[str, Any] = field(default_factory=dict)

    @property
    def spans(self) -> Array:
        """The peak-to-peak drive of each axis in the identification."""
        return np.ptp(self.range, axis=1)

    @property
    def peaks(self) -> Array:
        """The largest magnitude of the drive of size axis in the identification."""
        return np.abs(self.range).max(axis=1)

    def stage(self, dt: float | None = None, spans: Array | None = None, peaks: Array | None = None) -> Stage:
        """The stage at a sample time, s, by default that of the identification, as are spans and peaks of its drive."""
        chosen = [self.spans if spans is None else spans, self.peaks if peaks is None else peaks]
        return Stage(self.chain, self.theta, dt or self.dt, *(size.tolist() for size in chosen))

    @property
    def axes(self) -> tuple[str, ...]:
        """The measured axes, those that can follow a reference."""
        return tuple(self.chain.axes[axis] for axis in self.outputs)

    @property
    def inputs(self) -> dict[str, str]:
        """What control takes of each axis, by its unit: the displacement, or the drive where none is measured."""
        units = zip(self.chain.axes, self.response_units, self.drive_units, strict=True)
        return {axis: response or drive for axis, response, drive in units}

    @property
    def word(self) -> str:
        """The name, as one of a function."""
        plain = re.sub(r"\W+", "_", self.name, flags=re.ASCII).strip("_").lower() or "model"
        return plain if plain[0].isalpha() else f"model_{plain}"

    @property
    def outputs(self) -> list[int]:
        """The axes with a response."""
        return list(self.chain.measured)

    def value(self, column: int) -> float:
        """Of a parameter, in the user's unit."""
        return float(self.theta[column] / factor(self.units[column]))

    def entry(self, column: int) -> Entry:
        return self.chain.entries[column]

    def scale(self, axis: int) -> tuple[float, float]:
        """Size of the units of drive and response of an axis, in SI units."""
        return factor(self.drive_units[axis]), factor(self.response_units[axis] or "1")

    @property
    def ends(self) -> list[tuple[float, float]]:
        """Of each axis the least and the largest drive of the identification, in the user's units."""
        sizes = [self.scale(axis)[0] for axis in range(len(self.range))]
        return [(float(low / size), float(high / size)) for (low, high), size in zip(self.range, sizes, strict=True)]

    @cached_property
    def test_vector(self) -> tuple[Array, Array]:
        """A drive (axes, samples) within the range, with loops inside each other, steps and a rest, and the response
        (measured axes, samples) to it, in the user's units."""
        at = np.linspace(0, 1, SAMPLES)
        shares = [
            np.interp(at, np.linspace(0, 1, len(LEVELS)), np.roll(LEVELS, 3 * axis)) for axis in range(len(self.range))
        ]
        waves = [share + 0.03 * np.sin(40 * at) * at for share in shares]
        low, high = self.range.T[:, :, None]
        drive = low + (high - low) * np.clip(waves, 0, 1)
        with np.errstate(all="ignore"):
            response = self.stage().respond(drive, EVERYTHING)[self.outputs]
        drives = [row / self.scale(axis)[0] for axis, row in enumerate(drive)]
        responses = [row / self.scale(axis)[1] for axis, row in zip(self.outputs, response, strict=True)]
        return np.array(drives), np.array(responses)


LEVELS = (0.2, 0.5, 0.95, 0.1, 0.7, 0.3, 0.6, 0.6, 0.05, 0.9, 0.9, 0.4, 0.2)  # shares of the range
