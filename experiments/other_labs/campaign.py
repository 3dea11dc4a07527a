"""What a campaign is: records, a base model, and hooks that put into it what is hidden; its simulation."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .declared import entry
from .dynamics import lumped
from .hysteresis import operator

CAMPAIGNS = {}
declare = entry(CAMPAIGNS)
PSO = "{name: pso, population: 60, generations: 120}"
SMALL_PSO = "{name: pso, population: 40, generations: 80}"
LEAST_SQUARES = "{name: least_squares, budget: 300}"
FREE = {"gain": "wide", "alpha": [0, 1], "beta": "wide", "gamma": "wide"}


@dataclass(frozen=True)
class Record:
    """Drives by axis; the first `ahead` samples are simulated and not recorded. settle: as the job has it."""

    name: str
    use: str
    rate: float
    drives: dict
    ahead: int = 0
    settle: str = ""

    @property
    def times(self):
        return np.arange(len(self.drives["x"])) / self.rate


@dataclass(frozen=True)
class At:
    """Where a hook works: fine times and their step, record and its number; parameters and drive of one axis."""

    times: np.ndarray
    step: float
    number: int
    record: Record
    parameters: dict = None
    drive: np.ndarray = None

    def mechanics(self, **changed):
        """Mass, damping and stiffness of the axis."""
        return {name: self.parameters[name] for name in ("mass", "damping", "stiffness")} | changed


@dataclass
class Campaign:
    """A stage, what is hidden in it, its acquisition, and the job that a user wrote.

    hidden: hooks at `drive`, `hysteresis`, `stroke` (static), `creep`, `mechanics`, `reading`, each of one axis, and
    `forces`, `readings`, of all axes. mechanics: "lumped" or a function. steps: of the simulation for each sample.
    bounds: by parameter, two numbers, or `fix`, or `wide`, `tight`, `low`, `high` about the truth. more: further
    parameters of the job, a value or bounds. noise: standard deviation in um, None where sizes.json has it. memory,
    coloured: pole and share of the noise that is first-order autoregressive. counts, drive_counts: steps of the
    sensor in um and of the recorded drive in V.
    """

    title: str
    records: list
    parameters: dict
    model: str
    base: str = "bouc_wen"
    mechanics: str | Callable | None = None
    measured: tuple = ("x",)
    hidden: dict = field(default_factory=dict)
    steps: int = 1
    bounds: dict = field(default_factory=dict)
    more: dict = field(default_factory=dict)
    effects: str = ""
    optimizers: tuple = (PSO,)
    repeats: int = 2
    noise: float | None = None
    memory: float = 0.0
    coloured: float = 0.0
    counts: float = 0.0
    drive_counts: float = 0.0
    format: str = "csv"
    timed: bool = True
    time_unit: str = "s"
    drive_unit: str = "V"
    unit: str = "um"


def _record(name, use, drives, settle):
    count = max(len(drive.values) for drive in drives)
    arrays = {axis: drive.array(count) for axis, drive in zip("xy", drives, strict=False)}
    return Record(name, use, drives[0].rate, arrays, drives[0].ahead, settle)


def identify(name, *drives, settle=""):
    """A record to identify with, its drives of x and y, the shorter one at rest in the end."""
    return _record(name, "identify", drives, settle)


def validate(name, *drives, settle=""):
    return _record(name, "validate", drives, settle)


def weights(*values):
    """Parameters of eight plays."""
    return {f"weight_{i}": value for i, value in enumerate(values, 1)}


def _finer(times, drive, steps):
    if steps == 1:
        return times, drive
    fine = np.linspace(times[0], times[-1], (len(times) - 1) * steps + 1)
    return fine, np.interp(fine, times, drive)


def _keep(signal, at):
    return signal


def _mechanics(campaign):
    if campaign.mechanics == "lumped":
        return lambda force, at: lumped(force, at.step, **at.mechanics())
    return campaign.mechanics or _keep


def simulate(campaign, number):
    """Displacements of the measured axes in um, without noise, at the recorded samples of a record."""
    record, hidden = campaign.records[number], campaign.hidden
    times, steps = record.times, campaign.steps
    step = (times[1] - times[0]) / steps
    hysteresis = hidden.get("hysteresis", lambda u, at: operator(campaign.base, u, at.parameters))
    forces, places = {}, {}
    for axis, drive in record.drives.items():
        fine, u = _finer(times, drive, steps)
        parameters = campaign.parameters[axis]
        u = hidden.get("drive", _keep)(u, At(fine, step, number, record, parameters, u))
        places[axis] = At(fine, step, number, record, parameters, u)
        force = hysteresis(u, places[axis])
        for hook in ("stroke", "creep"):
            force = hidden.get(hook, _keep)(force, places[axis])
        forces[axis] = force
    stage = At(fine, step, number, record)
    forces = hidden.get("forces", _keep)(forces, stage)
    mechanics = hidden.get("mechanics", _mechanics(campaign))
    reading = hidden.get("reading", _keep)
    moved = {axis: reading(mechanics(forces[axis], at), at) for axis, at in places.items()}
    moved = hidden.get("readings", _keep)(moved, stage)
    return {axis: moved[axis][::steps][record.ahead :] for axis in campaign.measured}
