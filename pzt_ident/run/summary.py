"""What a job and its data hold, and what a run of it would do."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from pzt_ident.data.evidence import LONG
from pzt_ident.data.noise import WEAK, noise_floor
from pzt_ident.data.notation import listed
from pzt_ident.data.record import Record
from pzt_ident.data.units import factor
from pzt_ident.diagnosis.possible import applicable, out_of_place
from pzt_ident.job.schema import Job
from pzt_ident.model.block import Modes
from pzt_ident.run.identify import tasks_of
from pzt_ident.run.improve import case_of
from pzt_ident.run.statement import Statement
from pzt_ident.search.gains import far_off, free_gains
from pzt_ident.search.problem import Problem

Facts = dict[str, Any]

MOVED = 2e-3  # of the range of a drive that moves
ASIDE, SWIFT = 0.05, 0.2  # of the range, from zero and from its ends, and of most moves: a drive that is under way


def summary_of(job: Job) -> Facts:
    """Records, axes, parameters and optimizers of a job, and what a diagnosis cannot name in it. Raises InputError on
    whatever is wrong with its data."""
    statement = Statement(job)
    records, problem = statement.records, statement.problem
    tasks, case = tasks_of(statement, job.folder), case_of(statement)
    axes = [_axis(records, axis) for axis in range(len(records[0].axes))]
    return {
        "name": job.name,
        "hash": job.hash,
        "model": [block.name for block in problem.model.blocks],
        "records": [_record(record) for record in records],
        "axes": axes,
        "parameters": _parameters(problem),
        "notes": [
            *far_off(problem),
            *_products(problem),
            *_ratios(problem),
            *_weak_floors(axes),
            *_unmeasured(axes),
            *_all_fitted(records),
            *_in_motion(job, records, problem),
        ],
        "nameable": applicable(case, case.effects),
        "faults": applicable(case, case.effects, in_setup=True),
        "out_of_place": out_of_place(case),
        "runs": [task.run for task in tasks],
        "evaluations": sum(task.stop["evaluations"] for task in tasks),
    }


def _record(record: Record) -> Facts:
    return {
        "name": record.name,
        "use": record.use,
        "samples": record.samples,
        "sample_rate": 1 / record.dt,
        "seconds": record.samples * record.dt,
        "settle": record.settle * record.dt,
        "file": record.file,
        "notes": list(record.notes),
    }


def _axis(records: list[Record], axis: int) -> Facts:
    first = records[0]
    channels = {"drive": first.drive_units[axis], "response": first.response_units[axis]}
    facts: Facts = {"name": first.axes[axis]}
    for channel, unit in channels.items():
        facts[f"{channel}_unit"] = unit
        if unit is not None:
            values = [getattr(record, channel)[axis] / factor(unit) for record in records]
            facts[f"{channel}_range"] = [float(min(map(np.min, values))), float(max(map(np.max, values)))]
    if unit := channels["response"]:
        floor = noise_floor(records, axis)
        facts |= {"noise_floor": floor.value / factor(unit), "noise_floor_source": floor.source}
    return facts


def _parameters(problem: Problem) -> list[Facts]:
    bounds = dict(zip(problem.names, zip(problem.lower, problem.upper, strict=True), strict=True))
    found = []
    for entry, unit, value in zip(problem.model.entries, problem.all_units, problem.theta, strict=True):
        facts: Facts = {"name": entry.name, "unit": unit, "doc": entry.parameter.doc}
        if entry.name in bounds:
            facts["bounds"] = [float(bound) for bound in bounds[entry.name]]
        elif np.isfinite(value):
            facts["value"] = float(value / factor(unit))
        found.append(facts)
    return found


def _products(problem: Problem) -> Iterator[str]:
    """A sentence on each gain that is known only together with the shapes of modes."""
    modes = next((block.name for block in problem.model.blocks if issubclass(block, Modes)), None)
    for _, entry in free_gains(problem) if modes else ():
        yield f"{entry.name} and the shapes of {modes} are known only as products: give {entry.name} a `value`"


def _ratios(problem: Problem) -> Iterator[str]:
    """A sentence on each oscillator of which the mass is free beside damping and stiffness."""
    for mass in (name for name in problem.names if name.endswith(".mass")):
        others = [mass.removesuffix("mass") + word for word in ("damping", "stiffness")]
        if set(others) <= set(problem.names):
            names = listed([mass, *others])
            yield f"of {names} the data hold two ratios, whatever the mass is: give {mass} a `value`"


def _weak_floors(axes: list[Facts]) -> Iterator[str]:
    """A sentence on each noise floor that is taken while the stage moves."""
    for axis in axes:
        if axis.get("noise_floor_source") == WEAK:
            yield (
                f"{axis['name']}: the noise floor is taken while the stage moves, where slow noise passes for signal, "
                f"fast signal for noise: record a rest of {LONG} samples or one drive twice to know it"
            )


def _unmeasured(axes: list[Facts]) -> Iterator[str]:
    """A sentence on each axis without a response."""
    measured = next(axis["name"] for axis in axes if axis["response_unit"] is not None)
    for axis in axes:
        if axis["response_unit"] is None:
            yield (
                f"{axis['name']} has no response: its drive matters where a coupling takes it to another axis, and its "
                f"parameters are those of {measured} but for what the job says of {axis['name']}"
            )


def _all_fitted(records: list[Record]) -> Iterator[str]:
    """A sentence where no record is kept back."""
    if all(record.use == "identify" for record in records):
        yield "all records are fitted: keep one back by `use: validate` to see what the model predicts of it"


def _in_motion(job: Job, records: list[Record], problem: Problem) -> Iterator[str]:
    """A sentence on the records that are cut out of their files where the drive moves, and on those that begin in the
    middle of a motion, if nothing says what was before."""
    if any(block.lead for block in problem.model.blocks):
        return
    both = zip(job.records, records, strict=True)
    open_ones = [(source, record) for source, record in both if not (record.run_in or record.rest_at)]
    cut = [r.name for source, r in open_ones if (source.rows or source.time or (0,))[0] and _moves_at_once(r)]
    begun = [record.name for _, record in open_ones if record.name not in cut and _is_under_way(record)]
    follows = "`history` in `model` follows what was before"
    for names, what in ((cut, "cut out where the drive moves"), (begun, "under way from the first sample on")):
        if names:
            are = "is" if len(names) == 1 else "are"
            yield f"{listed(names)} {are} {what}, and the model starts from rest there: {follows}"


def _is_under_way(record: Record) -> bool:
    """Whether a drive begins away from zero and from the ends of its range, as fast as it mostly moves."""
    for drive in record.drive:
        moves, span, first = np.abs(np.diff(drive)), np.ptp(drive), drive[0]
        aside = min(abs(first), first - drive.min(), drive.max() - first) > ASIDE * span
        if aside and moves[:3].max() > SWIFT * np.quantile(moves[moves > 0], 0.9):
            return True
    return False


def _moves_at_once(record: Record) -> bool:
    """Whether a drive has left its first value in the first hundredth of the samples."""
    first = record.drive[:, : max(2, record.samples // 100)]
    return bool((np.abs(first[:, -1] - first[:, 0]) > MOVED * np.array(record.spans)).any())
