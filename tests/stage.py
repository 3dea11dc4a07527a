"""Small campaigns of a stage that the package itself simulates, with effects and noise in them."""

from dataclasses import replace

import numpy as np

import measured
import rig
from pzt_ident.diagnosis.case import Case
from pzt_ident.model.registry import blocks
from pzt_ident.search.cube import FixedValue

NOISE = 5e-9  # m
STAGE = {
    "bouc_wen.gain": 0.082e-6,
    "bouc_wen.alpha": 0.55,
    "bouc_wen.beta": 0.015,
    "bouc_wen.gamma": 0.005,
    "lumped.mass": 0.15,
    "lumped.damping": 70.0,
    "lumped.stiffness": 7e7,
}
EFFECTS = {
    "creep": {"creep.ratio": 0.08, "creep.tau": 1.0, "creep.decades": 4.0},
    "quadratic_gain": {"quadratic_gain.curvature": 3e-4},
    "amplifier_lag": {"amplifier_lag.tau": 3e-3},
    "sensor_lag": {"sensor_lag.tau": 3e-3},
}


def loops():
    """A drive to fit and one to validate, V: nested loops between two rests."""
    fitted = rig.path(0, 100, 20, 80, 0, 60, 60, 30, 30, 120, 0, points=120)
    unseen = rig.path(0, 70, 70, 10, 110, 110, 40, 40, 0, points=130)
    return [np.concatenate([np.zeros(100), drive, np.zeros(150)]) for drive in (fitted, unseen)]


def records(
    parameters, drives=None, dt=5e-3, model=("bouc_wen",), noise=NOISE, seed=1, steps=8, effects=EFFECTS, forms=()
):
    """One record to identify and one to validate of the stage with the effects that the parameters name, in other forms
    where these are given; simulated in so many steps a sample."""
    rng = np.random.default_rng(seed)
    words = {name.split(".")[0] for name in parameters}
    other = {form.split(".")[0]: form for form in forms}
    chain = [other.get(word, word) for word in (*model, *sorted(words & set(effects) - set(model)))]
    stage = {name: value for name, value in STAGE.items() if name.split(".")[0] in model}
    made = []
    for drive, use in zip(drives or loops(), ("identify", "validate"), strict=True):
        response = rig.response(chain, stage | parameters, drive, dt=dt, steps=steps) + rng.normal(0, noise, drive.size)
        blank = rig.record(drive, response=[response], dt=dt)
        made.append(replace(blank, use=use, name=use, response_units=("um",)))
    return made


def case(parameters=None, fixed=None, effects=(), model=("bouc_wen",), **more):
    """The model without effects on records of a stage that has some; `fixed` parameters are known."""
    return Case(model, effects, records(parameters or {}, model=model, **more), specs(fixed or {}))


def specs(fixed):
    return {name: FixedValue(value) for name, value in fixed.items()}


def considering(made, *effects):
    """The same case, in which only these effects may be missing."""
    made.ruled_out = tuple({*blocks.effects()} - {*effects})
    return made


def with_response(made, change):
    """The same case with change(record) added to each response."""
    changed = [replace(r, response=r.response + change(r)) for r in made.records]
    return Case(made.words, made.effects, changed, made.specs)


def beside(made, other):
    """One stage of two axes from two stages of one."""
    records = [
        replace(
            one,
            drive=np.vstack([one.drive, two.drive]),
            response=np.vstack([one.response, two.response]),
            axes=("x", "y"),
            drive_units=("V", "V"),
            response_units=("um", "um"),
        )
        for one, two in zip(made.records, other.records, strict=True)
    ]
    return Case(made.words, made.effects, records, made.specs)


JOB = """\
# nested loops
name: small
records:
  - {file: identify.csv, use: identify}
  - {file: validate.csv, use: validate}
channels:
  time: "time [s]"
  axes:
    x: {drive: "u_x [V]", response: "x [um]"}
model: [bouc_wen]
effects: []  # none yet
limits: {drive: [0, 120], slew: 300, duration: 30}
"""


def write(folder, made, job=JOB):
    """The records as CSV and a job beside them; the path of the job."""
    folder.mkdir(parents=True, exist_ok=True)
    for record in made:
        measured.write(folder / f"{record.name}.csv", record.time, record.drive[0], record.response[0] * 1e6)
    path = folder / "job.yaml"
    path.write_text(job, encoding="utf-8")
    return path
