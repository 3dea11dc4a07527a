"""Measured channels as a job names them (Source, Channel, Axis) and as a simulation uses them (Record)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Use = Literal["identify", "validate"]


@dataclass(frozen=True)
class Channel:
    """Where a signal is in a file: by its name, its column or its dataset.

    name: in the header, such as `u_x [V]`. column: counted from 1, of a table or an array of two dimensions. unit:
    where it is not that in the header. dataset: which one of a file with several, such as an array of .npz or .mat,
    below that of the record. index: which part of an array. file: where it is not that of the record.
    """

    name: str | None = None
    column: int | None = None
    unit: str | None = None
    dataset: str | None = None
    index: tuple[int | str, ...] | None = None
    file: str | None = None


@dataclass(frozen=True)
class Axis:
    """An axis of the stage.

    drive: where the drive is. response: where the response is, of an axis that is measured.
    """

    drive: Channel
    response: Channel | None = None


@dataclass(frozen=True)
class Level:
    """A constant drive: `0 V`.

    value: the number. unit: by default that of the drive.
    """

    value: float
    unit: str | None = None


@dataclass(frozen=True)
class Source:
    """One record as the job names it.

    file: relative to the job. use: whether it is fitted or kept back. name: in results and messages, by default that of
    the file. sample_rate: Hz, where no column has the time. rows: a part of the file, counted from 0, the end excluded.
    time: a part of the file, from its stamps, s. What counts time from the start, as a drift, begins with the part.
    settle: the time at the start that is simulated but not scored, s. decimate: every n-th sample is taken, after a
    low-pass. run_in: how often the whole drive is simulated before its first sample, for a periodic record in steady
    state. rest_at: the drive at which the stage rested until one sample before the first, from where it goes there on a
    line, of all axes or by axis, for a record that begins with a step. denoise_drive: whether noise of the recorded
    drive is left out; it turns where that goes back by more. smooth_drive: whether the drive is smooth between its
    samples, as behind a filter against aliasing, and not linear, as it is unless the model takes it as smooth by
    itself: with `run_in` it is the Fourier series of the record, else a cubic spline; steps of 2 and more feel it.
    steps: simulation steps in a sample. dataset: below which one of a file with several its channels are. table: which
    one of a text export with several. index: which part of an array. sheet: which one of a workbook. channels: what is
    elsewhere in this record, by `time`, `drive`, `response` or, of one axis, `x.drive`: `{response: {file: y.npy}}`
    takes every response from another file.
    """

    file: str
    use: Use = "identify"
    name: str | None = None
    sample_rate: float | None = None
    rows: tuple[int | None, int | None] | None = None
    time: tuple[float | None, float | None] | None = None
    settle: float = 0.0
    decimate: int = 1
    run_in: int = 0
    rest_at: Mapping[str, Level] | None = None
    denoise_drive: bool = False
    smooth_drive: bool | None = None
    steps: int = 1
    dataset: str | None = None
    table: int | str | None = None
    index: tuple[int | str, ...] | None = None
    sheet: str | None = None
    channels: Mapping[str, Channel] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Record:
    """One measurement on a uniform time grid, in SI units.

    drive, response: (axes, samples); the response of an axis that is not measured is NaN throughout.
    dt, start: sample time and first time stamp, s. settle: samples simulated but not scored at the start.
    run_in: as of `Source`.
    rest_at: the drive of each axis at which the stage rested until one sample before the first; None where that is the
    drive of the first sample. Empty where it is on all axes.
    denoise_drive: whether the drives are without the noise that was recorded. smooth_drive: whether they are smooth
    between their samples; None where the model says.
    steps: simulation steps per sample.
    sha256: of the file as read. rows: the first row of the file that the record holds, and the first after it.
    judges: whether a model is judged by it; a record kept back may show what the others leave open.
    """

    name: str
    use: Use
    dt: float
    drive: NDArray[np.float64]
    response: NDArray[np.float64]
    start: float = 0.0
    settle: int = 0
    run_in: int = 0
    rest_at: tuple[float | None, ...] = ()
    denoise_drive: bool = False
    smooth_drive: bool | None = None
    steps: int = 1
    file: str = ""
    sha256: str = ""
    rows: tuple[int, int] = (0, 0)
    axes: tuple[str, ...] = ("x",)
    drive_units: tuple[str, ...] = ("V",)
    response_units: tuple[str | None, ...] = ("m",)
    notes: tuple[str, ...] = field(default=())
    judges: bool = True

    @property
    def samples(self) -> int:
        return self.drive.shape[1]

    @property
    def ahead(self) -> int:
        """Samples that are simulated from rest before the first one."""
        return 1 if self.rest_at else 0

    @property
    def levels(self) -> list[float]:
        """The drive of each axis at which the stage rests at first."""
        given = self.rest_at or (None,) * len(self.drive)
        return [float(drive[0]) if level is None else level for level, drive in zip(given, self.drive, strict=False)]

    @cached_property
    def spans(self) -> list[float]:
        """Largest less least drive of each axis."""
        return [float(np.ptp(drive)) for drive in self.drive]

    @cached_property
    def swings(self) -> list[float]:
        """Largest less least response of each axis."""
        return [float(np.ptp(response)) for response in self.response]

    @cached_property
    def scored_swings(self) -> NDArray[np.float64]:
        """The same of what is scored, (axes,)."""
        return np.asarray(np.ptp(self.response[:, self.settle :], axis=1))

    @cached_property
    def products(self) -> NDArray[np.float64]:
        """Of drive and response about their means, summed over the samples: (axes, 3), the square of the drive, that of
        the response, and the product of both."""
        drive, response = (rows - rows.mean(axis=1, keepdims=True) for rows in (self.drive, self.response))
        pairs = (drive, drive), (response, response), (drive, response)
        return np.stack([np.einsum("as,as->a", one, other) for one, other in pairs], axis=1)

    @cached_property
    def peaks(self) -> list[float]:
        """The largest drive of each axis, of either sign."""
        return [float(np.abs(drive).max()) for drive in self.drive]

    @property
    def measured(self) -> tuple[int, ...]:
        """Indices of the axes that have a response."""
        return tuple(i for i, unit in enumerate(self.response_units) if unit is not None)

    @property
    def units(self) -> dict[str, str]:
        """The unit of the response of each measured axis, by its name."""
        return {axis: unit for axis, unit in zip(self.axes, self.response_units, strict=True) if unit is not None}

    @property
    def elapsed(self) -> NDArray[np.float64]:
        """The time since the first sample, s: (samples,)."""
        return self.dt * np.arange(self.samples, dtype=np.float64)

    @property
    def time(self) -> NDArray[np.float64]:
        """The time stamps, s: (samples,)."""
        return self.start + self.elapsed


def interpolated(drive: NDArray[np.float64], steps: int, periodic: bool, smooth: bool) -> NDArray[np.float64]:
    """A drive at `steps` points per sample, the last sample held: linear between samples or, if smooth, band-limited
    where the drive is periodic and else a cubic spline. (samples,) -> (steps * samples,)."""
    if steps == 1:
        return drive
    if smooth and periodic:
        from scipy.signal import resample

        return np.asarray(resample(drive, steps * drive.size))
    extended = np.append(drive, drive[0] if periodic else drive[-1])
    grid = np.arange(steps * drive.size) / steps
    if not smooth:
        return np.interp(grid, np.arange(extended.size), extended)
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(np.arange(drive.size), drive)(np.minimum(grid, drive.size - 1)))


def drive_correlation(records: Sequence[Record], axis: int) -> float:
    """Correlation of an axis' response with its drive over all records, 0 where one of them is constant."""
    drives, responses, both = np.sum([record.products[axis] for record in records], axis=0)
    norm = np.sqrt(drives * responses)
    return float(both / norm) if norm > 0 else 0.0
