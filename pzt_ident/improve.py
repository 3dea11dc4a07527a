"""From a job to what its model is missing, and to the job that has it: `diagnosis.json`, `improvement.json`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from pzt_ident.amend import amended
from pzt_ident.compare import compare
from pzt_ident.diagnosis import improve as stairs
from pzt_ident.diagnosis.locate import locate
from pzt_ident.diagnosis.next_experiment import LEAST, Proposal, Reach, propose
from pzt_ident.diagnosis.noise import noise_floor
from pzt_ident.diagnosis.refit import Case, Fit, first_fit
from pzt_ident.diagnosis.verdict import Diagnosis
from pzt_ident.diagnosis.verdict import diagnose as judge
from pzt_ident.files import write_json, write_text
from pzt_ident.job import Job
from pzt_ident.registry import blocks
from pzt_ident.report.words import happening
from pzt_ident.run import (
    Event,
    Listen,
    environment,
    errors_in,
    folder_for,
    make_empty,
    problem_of,
    read,
    recorded,
    unit_of,
)
from pzt_ident.signals import write_signals
from pzt_ident.units import factor


@contextmanager
def begun(job: Job, out: Path | None, listen: Listen = lambda event: None) -> Iterator[tuple[Case, Path]]:
    """The case, and a folder that holds the job, what it runs on and, in `events.jsonl`, what happens as it does.

    Raises InputError where job or data are wrong.
    """
    records = read(job)
    problem_of(job, records)
    folder = folder_for(job, out)
    make_empty(folder)
    write_text(folder / "job.yaml", amended(job, job.effects, folder))
    write_json(folder / "environment.json", environment(job, records))
    case = Case(job.model, job.effects, records, job.parameters, job.rule_out, job.shared)
    with recorded(folder, listen) as tell, np.errstate(all="ignore"):
        case.tell = lambda event: tell(spoken(case, event))
        yield case, folder
        tell({"event": "done", "folder": str(folder)})


def spoken(case: Case, event: Event) -> Event:
    """An event with its errors in the user's unit, and in words."""
    size = size_of(case)
    found = event | {use: event[use] / size for use in ("identify", "validate") if event.get(use) is not None}
    return found | {"said": happening(found, unit_of(list(case.records)))}


def told(case: Case, step: stairs.Step) -> None:
    case.tell({"event": "stair", **stair(case, step)})


def diagnose(job: Job, out: Path | None = None, listen: Listen = lambda event: None) -> Path:
    """Fit the job's model, say where it fails and what it misses; writes `diagnosis.json`, `residuals.json` and
    `signals.nc` into the folder returned."""
    with begun(job, out, listen) as (case, folder):
        first = first_fit(case, job.seed)
        told(case, stairs.Step(first))
        found = judge(case, first)
        content = diagnosis_of(job, case, found, folder)
        write_signals(folder / "signals.nc", first.problem, first.point)
        write_json(folder / "diagnosis.json", content)
        compare(folder, folder)
    return folder


def improve(job: Job, out: Path | None = None, listen: Listen = lambda event: None) -> Path:
    """Diagnose, add what is missing and diagnose again, until nothing is missing or nothing more is known.

    Writes `improved.yaml`, `diagnosis.json` and `residuals.json` of the last model, `improvement.json`, and the signals
    of the model as given and of the last one.
    """
    with begun(job, out, listen) as (case, folder):
        steps, last = stairs.improve(case, first_fit(case, job.seed), partial(told, case))
        diagnosis = diagnosis_of(job, case, last, folder)
        for name, step in (("signals_as_given.nc", steps[0]), ("signals.nc", steps[-1])):
            write_signals(folder / name, step.fit.problem, step.fit.point)
        content = improvement_of(job, case, steps, diagnosis) | {"next_experiment": diagnosis["next_experiment"]}
        end = steps[-1].fit
        values = case.silent(end.effects) if end.alone else None
        write_text(folder / "improved.yaml", amended(job, end.effects, folder, steps=end.steps, values=values))
        write_json(folder / "diagnosis.json", diagnosis)
        write_json(folder / "improvement.json", content)
        compare(folder, folder)
    return folder


def improvement_of(job: Job, case: Case, steps: list[stairs.Step], last: dict[str, Any]) -> dict[str, Any]:
    """The content of `improvement.json`, less the next experiment."""
    verdict, reason = last["verdict"], last["reason"]
    if verdict in ("missing", "inconclusive"):
        tried = "Another effect scores, but was tried and taken back, or the staircase has all its steps."
        verdict, reason = "unexplained", f"{tried} {reason}"
    added = [word for word in steps[-1].fit.effects if word not in job.effects]
    if verdict != "adequate" and added:
        reason += f" Added on the way, and not proven while that is open: {', '.join(added)}."
    reason += silenced(case, steps[-1].fit) + bounded(steps[-1].fit)
    return {
        "name": job.name,
        "steps": [stair(case, step) for step in steps],
        "verdict": verdict,
        "reason": reason,
        "effects": added,
        "noise_floor": floors(case),
        "floor": case.floor / size_of(case),
        "unit": unit_of(list(case.records)),
    }


def silenced(case: Case, fit: Fit | None) -> str:
    """A sentence about effects that fit better where axes without a response do not have them."""
    names = case.silent(fit.effects) if fit and fit.alone else {}
    if not names:
        return ""
    axes = " and ".join(dict.fromkeys(name.partition(".")[0] for name in names))
    said = f" What comes from {axes}, which has no response, fits better without these effects there"
    return f"{said}: {', '.join(f'`{name}: {{value: {null:g}}}`' for name, null in names.items())}."


def bounded(fit: Fit) -> str:
    """A sentence about each parameter that ended on a bound."""
    problem, said = fit.problem, ""
    why = "these data do not determine it, its bounds are too narrow, or it stands in for something else"
    for name in fit.on_bounds:
        i = problem.names.index(name)
        bound = (problem.lower if fit.point[i] < 0.5 else problem.upper)[i]
        said += f" {name} ended on its bound of {f'{bound:.3g} {problem.units[i]}'.removesuffix(' 1')}: {why}."
    return said


def broken(fit: Fit) -> str:
    """A sentence about each record over which a block breaks a condition of its own equation."""
    theta = fit.problem.parameters(fit.point)
    plans = [plan for plans in fit.problem.plans.values() for plan in plans]
    return "".join(f" Record {plan.record.name}: {each}." for plan in plans for each in plan.broken(theta))


def size_of(case: Case) -> float:
    return factor(unit_of(list(case.records)))


def floors(case: Case) -> dict[str, float]:
    first = case.records[0]
    return {
        first.axes[a]: noise_floor(list(case.records), a).value / factor(str(first.response_units[a]))
        for a in first.measured
    }


def errors_of(case: Case, fit: Fit) -> dict[str, float | None]:
    size = size_of(case)
    return {"identify": fit.identify / size, "validate": None if fit.validate is None else fit.validate / size}


def by_record(case: Case, fit: Fit) -> list[dict[str, Any]]:
    return [errors_in(record, fit.problem, fit.point) for record in fit.problem.records]


def stair(case: Case, step: stairs.Step) -> dict[str, Any]:
    values = zip(step.fit.values.items(), step.fit.problem.units, strict=True)
    return {
        "added": step.added,
        "removed": step.removed,
        "class": list(step.tied),
        "rmse": errors_of(case, step.fit),
        "records": by_record(case, step.fit),
        "explained": step.explained,
        "expected": step.expected,
        "parameters": {name: {"value": value, "unit": unit} for (name, value), unit in values},
    }


def diagnosis_of(job: Job, case: Case, found: Diagnosis, folder: Path) -> dict[str, Any]:
    rivals = {item.score.effect: item.fit for item in found.candidates if item.fit and item.score.effect in found.tied}
    proposal = propose(case, rivals, reach_of(job, case)) if len(rivals) > 1 else None
    reason = f"{found.reason} {rest(case, found.before)}" if found.verdict == "unexplained" else found.reason
    return {
        "verdict": found.verdict,
        "reason": reason + silenced(case, found.best.fit if found.best else None) + broken(found.before),
        "unit": unit_of(list(case.records)),
        "noise_floor": floors(case),
        "rmse": errors_of(case, found.before),
        "records": by_record(case, found.before),
        "candidates": [
            {
                "effect": item.score.effect,
                "class": found.tied if item.score.effect in found.tied else [item.score.effect],
                "explained": item.score.explained,
                "expected": item.score.guess,
                "units": item.score.units,
                "visibility": item.score.visibility,
                "power": item.score.power if np.isfinite(item.score.power) else None,
                "rmse": errors_of(case, item.fit) if item.fit else None,
                "records": by_record(case, item.fit) if item.fit else None,
                "decision": item.decision,
                "physics": (blocks[item.score.effect].__doc__ or "").splitlines()[0],
                "looks_like": list(blocks[item.score.effect].looks_like),
                "separate_by": blocks[item.score.effect].separate_by,
                "remedy": blocks[item.score.effect].remedy,
            }
            for item in found.candidates
        ],
        "next_experiment": written(case, proposal, folder) if proposal else None,
    }


def rest(case: Case, fit: Fit) -> str:
    """What that which a fit leaves depends on most, a sentence for each axis."""
    plans = [plan for plans in fit.problem.plans.values() for plan in plans]
    records, theta = [plan.record for plan in plans], fit.problem.parameters(fit.point)
    noise = [noise_floor(list(case.records), axis) for axis in records[0].measured]
    found = [axis for axis in locate(records, [plan.errors(theta)[0] for plan in plans], noise) if axis.misfit]
    names = [f"{axis.axis}: " if len(records[0].measured) > 1 else "" for axis in found]
    return " ".join(f"{name}{axis.sentences[0]}" for name, axis in zip(names, found, strict=True))


def reach_of(job: Job, case: Case) -> Reach:
    """The job's limits; where it gives none, what the records themselves did."""
    axis = case.records[0].measured[0]
    unit = factor(str(case.records[0].drive_units[axis]))
    drives = [record.drive[axis] for record in case.records]
    rate = max(float(np.abs(np.diff(r.drive[axis])).max()) / r.dt for r in case.records)
    length = max(r.samples * r.dt for r in case.records)
    limits = job.limits
    low, high = limits.drive or (min(u.min() for u in drives) / unit, max(u.max() for u in drives) / unit)
    slew = limits.slew * unit if limits.slew else rate
    return Reach(low * unit, high * unit, slew, limits.duration or max(length, 60.0))


def written(case: Case, proposal: Proposal, folder: Path) -> dict[str, Any]:
    """The proposal and its drive as CSV."""
    first = case.records[0]
    size = [factor(str(unit)) for unit in first.drive_units]
    header = ",".join(
        ["time [s]", *(f"u_{axis} [{unit}]" for axis, unit in zip(first.axes, first.drive_units, strict=True))]
    )
    time = np.arange(proposal.drive.shape[1]) * proposal.dt
    rows = np.column_stack([time, *(row / s for row, s in zip(proposal.drive, size, strict=True))])
    text = "\n".join([header, *(",".join(f"{value:.9g}" for value in row) for row in rows)]) + "\n"
    path = folder / "next_experiment.csv"
    write_text(path, text)
    apart = f"them {proposal.apart:.1f} noise floors" if proposal.apart > LEAST else "some of them"
    said = f"{proposal.name}: {proposal.why}; sets {apart} apart"
    return {"splits": list(proposal.splits), "file": path.name, "why": said}
