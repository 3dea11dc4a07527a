"""What a campaign is: records, a base model, and hooks that put into it what is hidden; its simulation."""

import math
from dataclasses import dataclass, field, replace

import numpy as np

from experiments.other_labs.declared import entry

from .dynamics import lumped
from .hysteresis import operator

CAMPAIGNS = {}
declare = entry(CAMPAIGNS)
PSO = "{name: pso, population: 70, generations: 100}"
EVOLUTION = ("{name: differential_evolution, population: 40, generations: 40}", "{name: least_squares}")
LEAST_SQUARES = ("{name: least_squares}",)
MECHANICS = ("mass", "damping", "stiffness")


@dataclass(frozen=True)
class Record:
    """Volts by axis; ahead: volts before the first sample, which are simulated and not recorded."""

    name: str
    use: str
    rate: float
    drives: dict
    ahead: dict

    @property
    def count(self):
        return self.drives["x"].size


@dataclass(frozen=True)
class At:
    """Where a hook works: fine times and their step, number of the record and the record; drives of all axes."""

    times: np.ndarray
    step: float
    number: int
    record: Record
    drives: dict
    parameters: dict

    def mechanics(self, **changed):
        """Mass, damping and stiffness of the axis."""
        return {name: self.parameters[name] for name in MECHANICS} | changed


@dataclass(frozen=True)
class Campaign:
    """A stage, what is hidden in it, its acquisition, and the job that a user wrote.

    hidden: hooks by their place. `drive` gives the drive of one axis; `operator` what its hysteresis has beyond the
    job, values or a function of the drive; `hysteresis` is used in place of the base; `force` changes the force of one
    axis and `forces` those of all; `mechanics` moves one axis and `stage` all; `readings` changes the displacements,
    and `reading` the recorded samples of one axis. known: of the base beyond the parameters of the job. steps, finest:
    of the simulation for a sample, and at least so many a second, twice as many where a case is made. bounds: by
    parameter, two numbers or a word. lines: further parameters of the job. noise: standard deviation in um.
    memory: pole of the noise.
    """

    base: str
    parameters: dict
    records: tuple
    noise: float
    hidden: dict = field(default_factory=dict)
    mechanics: bool = True
    measured: tuple = ("x",)
    known: dict = field(default_factory=dict)
    steps: int = 8
    finest: float = 0.0
    bounds: dict = field(default_factory=dict)
    lines: tuple = ()
    optimizers: tuple = (PSO,)
    memory: float = 0.0
    counts: float = 0.0
    format: str = "csv"
    timed: bool = True
    drive_unit: str = "V"
    unit: str = "um"


def _record(name, use, drive, second=None, ahead=None):
    drives = {"x": drive, "y": second} if second else {"x": drive}
    count = max(each.values.size for each in drives.values())
    volts = {axis: np.pad(each.values, (0, count - each.values.size), "edge") for axis, each in drives.items()}
    return Record(name, use, drive.rate, volts, {} if ahead is None else {"x": ahead.values})


def identify(name, *drives, ahead=None):
    """A record to identify with, its drives of x and y, the shorter one held in the end."""
    return _record(name, "identify", *drives, ahead=ahead)


def validate(name, *drives, ahead=None):
    return _record(name, "validate", *drives, ahead=ahead)


def alone(drive, axis):
    """Drives of x and y, of which one rests."""
    return (drive, drive.rest_of()) if axis == "x" else (drive.rest_of(), drive)


def _finer(record, axis, steps):
    volts = np.concatenate([record.ahead.get(axis, []), record.drives[axis]])
    fine = np.arange((volts.size - 1) * steps + 1) / steps
    return np.interp(fine, np.arange(volts.size), volts)


def _place(campaign, number, finer):
    """Steps for a sample, and where hooks of all axes work, before the amplifier."""
    record = campaign.records[number]
    steps = max(campaign.steps, math.ceil(campaign.finest / record.rate)) * finer
    step = 1 / record.rate / steps
    drives = {axis: _finer(record, axis, steps) for axis in campaign.parameters}
    count, before = drives["x"].size, record.ahead["x"].size if record.ahead else 0
    times = np.arange(count) * step - before / record.rate
    return steps, before, At(times, step, number, record, drives, campaign.parameters)


def _force(campaign, axis, at):
    """Force of an axis as the displacement that it would hold still."""
    hidden, u = campaign.hidden, at.drives[axis]
    at = replace(at, parameters=campaign.parameters[axis])
    more = hidden.get("operator", {})
    more = campaign.known | (more(u, at) if callable(more) else more)
    own = hidden.get("hysteresis")
    force = own(u, at) if own else operator(campaign.base, u, at.step, at.parameters, **more)
    return hidden["force"](force, at) if "force" in hidden else force


def _moved(campaign, force, axis, at):
    at = replace(at, parameters=campaign.parameters[axis])
    if own := campaign.hidden.get("mechanics"):
        return own(force, at)
    return lumped(force, at.step, **at.mechanics()) if campaign.mechanics else force


def _stage(campaign, at):
    """Displacements of all axes as the sensors read them, at the fine times."""
    hidden = campaign.hidden
    if "drive" in hidden:
        at = replace(at, drives={axis: hidden["drive"](u, at) for axis, u in at.drives.items()})
    forces = {axis: _force(campaign, axis, at) for axis in campaign.parameters}
    if "forces" in hidden:
        forces = hidden["forces"](forces, at)
    if "stage" in hidden:
        moved = hidden["stage"](forces, at)
    else:
        moved = {axis: _moved(campaign, force, axis, at) for axis, force in forces.items()}
    return hidden["readings"](moved, at) if "readings" in hidden else moved


def simulate(campaign, number, finer=2):
    """Displacements of the measured axes in um, without noise, at the recorded samples of a record."""
    steps, before, at = _place(campaign, number, finer)
    moved = _stage(campaign, at)
    read = {axis: moved[axis][::steps][before:] for axis in campaign.measured}
    if reading := campaign.hidden.get("reading"):
        rate = at.record.rate
        read = {axis: reading(y, np.arange(y.size) / rate, number) for axis, y in read.items()}
    return read
