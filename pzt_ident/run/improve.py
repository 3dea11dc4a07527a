"""From a job to what its model is missing, and to the job that has it: `diagnosis.json`, `improvement.json`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from pzt_ident.data.noise import units_and_floors
from pzt_ident.data.record import Record
from pzt_ident.data.signals import write_signals
from pzt_ident.data.units import factor
from pzt_ident.diagnosis import staircase as stairs
from pzt_ident.diagnosis.bounds import narrow_bounds_sentence
from pzt_ident.diagnosis.budget import Budget, sensible
from pzt_ident.diagnosis.caveats import broken_conditions, caveats, misfit_sentences
from pzt_ident.diagnosis.refit import Case, Fit
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.verdict import Diagnosis
from pzt_ident.diagnosis.verdict import diagnose as judge
from pzt_ident.files import write_sealed, write_text
from pzt_ident.job.edit import edited
from pzt_ident.job.schema import Job
from pzt_ident.model.description import headline
from pzt_ident.model.registry import blocks, form_of, phrase_of, word_of
from pzt_ident.run.collect import errors_in
from pzt_ident.run.events import Event, Listen, event_log, nobody, sentence
from pzt_ident.run.folder import begin, results_folder
from pzt_ident.run.misfit import compare
from pzt_ident.run.next_drive import limits_of, separating
from pzt_ident.run.start import read_start, start_point
from pzt_ident.run.statement import Statement, loss_unit


@contextmanager
def opened_case(
    job: Job,
    out: Path | None,
    listen: Listen = nobody,
    budget: float | None = None,
    start: Path | None = None,
    records: Sequence[Record] | None = None,
    task: str = "improve",
) -> Iterator[tuple[Case, Path]]:
    """The case, and a folder that holds the job, what it runs on and, in `events.jsonl`, what happens as it does.

    records: those of the job where they were read already. Raises InputError where job or data are wrong.
    """
    statement, folder = Statement(job, records), results_folder(job, out)
    began = {"name": task, "budget": budget, "start": start and str(start)}
    begin(folder, job, edited(job, job.effects, folder), statement.records, began)
    case = case_of(statement)
    with event_log(folder, listen) as tell, np.errstate(all="ignore"):
        case.on_event = lambda event: tell(worded(case, event))
        case.budget = Budget(sensible(sum(record.samples for record in case.records)) if budget is None else budget)
        yield case, folder
        tell({"event": "done", "folder": str(folder)})


def case_of(statement: Statement) -> Case:
    """The case that a job makes with its records."""
    job = statement.job
    records, given = statement.records, statement.problem
    return Case(job.model, job.effects, records, job.parameters, job.rule_out, job.shared, base_problem=given)


def worded(case: Case, event: Event) -> Event:
    """An event with its errors in the user's unit, and in words."""
    size = size_of(case)
    in_units = event | {use: event[use] / size for use in ("identify", "validate") if event.get(use) is not None}
    return in_units | {"said": sentence(in_units, case.records[0].units)}


def told(case: Case, step: stairs.Step) -> None:
    case.on_event({"event": "stair", "units": case.records[0].units, **stair(case, step)})


def diagnose(
    job: Job,
    out: Path | None = None,
    listen: Listen = nobody,
    budget: float | None = None,
    start: Path | None = None,
) -> Path:
    """Fit the job's model, say where it fails and what it misses; writes `diagnosis.json`, `residuals.json` and
    `signals.nc` into the folder returned. budget, start: as of `improve`."""
    with opened_case(job, out, listen, budget, start, task="diagnose") as (case, folder):
        first = fitted(case, job, start)
        told(case, stairs.Step(first))
        found = judge(case, first)
        content = diagnosis_of(job, case, found, folder)
        write_signals(folder / "signals.nc", first.problem.errors(first.point))
        write_sealed(folder / "diagnosis.json", content)
        compare(folder, folder)
    return folder


def fitted(case: Case, job: Job, start: Path | None) -> Fit:
    """The fit of the job's model, the best of random points and of the fit in a place that is given."""
    if start is None:
        return first_fit(case, job.seed)
    known = start_point(case.problem(case.effects), read_start(start, job))
    return first_fit(case, job.seed, known)


def improve(
    job: Job,
    out: Path | None = None,
    listen: Listen = nobody,
    budget: float | None = None,
    start: Path | None = None,
    records: Sequence[Record] | None = None,
) -> Path:
    """Diagnose, add what is missing and diagnose again, until nothing is missing or nothing more is known.

    budget: CPU seconds, by default 60 or 1 ms a sample. After them the verdict is on what was found by then, and says
    what was not tried. start: a folder of results, or a file of values, whose fit is gone on from where it is the
    better one. records: those of the job where they were read already.

    Writes `improved.yaml`, `diagnosis.json` and `residuals.json` of the last model, `improvement.json`, and the signals
    of the model as given and of the last one.
    """
    with opened_case(job, out, listen, budget, start, records) as (case, folder):
        staircase = stairs.improve(case, fitted(case, job, start), SoFar(job, case, folder))
        steps, diagnosis = staircase.steps, diagnosis_of(job, case, staircase.last, folder)
        for name, step in (("signals_as_given.nc", steps[0]), ("signals.nc", steps[-1])):
            write_signals(folder / name, step.fit.problem.errors(step.fit.point))
        proposals = (separating(job, case, step.rivals, folder) for step in ties(steps))
        proposed = diagnosis["next_experiment"] or next(filter(None, proposals), None)
        content = improvement_of(job, case, staircase, diagnosis) | {"next_experiment": proposed}
        write_sealed(folder / "diagnosis.json", diagnosis)
        write_improvement(folder, content, improved(job, case, staircase, folder))
        compare(folder, folder)
    return folder


class SoFar:
    """A listener to the steps of a staircase that keeps the best account so far on the disk."""

    def __init__(self, job: Job, case: Case, folder: Path) -> None:
        self.job, self.case, self.folder = job, case, folder
        self.steps: list[stairs.Step] = []
        self.least = np.inf

    def __call__(self, step: stairs.Step) -> None:
        told(self.case, step)
        self.steps = [*self.steps, step] if step.added or step.removed else [step]
        if step.fit.total < self.least:
            self.least = step.fit.total
            staircase = stairs.Staircase(self.steps, Diagnosis("unfinished", "", step.fit, [], []))
            last = {
                "verdict": "unfinished",
                "reason": "The best account so far: the diagnosis did not come to its end.",
            }
            content = improvement_of(self.job, self.case, staircase, last) | {"next_experiment": None}
            write_improvement(self.folder, content, improved(self.job, self.case, staircase, self.folder))


def write_improvement(folder: Path, content: dict[str, Any], job_text: str) -> None:
    """Write `improvement.json` and the job that goes with it."""
    write_text(folder / "improved.yaml", job_text)
    write_sealed(folder / "improvement.json", content)


def improved(job: Job, case: Case, staircase: stairs.Staircase, folder: Path) -> str:
    """The text of the job with the last model: its effects, its simulation steps, parameters that are fixed at their
    nulls, bounds that are wider."""
    end = staircase.steps[-1].fit
    values = case.unmeasured_nulls(end.effects) if end.measured_only else {}
    bounds = wider_bounds(job, staircase.case or case)
    return edited(job, end.effects, folder, steps=end.steps, values=values, bounds=bounds)


def wider_bounds(job: Job, case: Case) -> dict[str, tuple[float, float]]:
    """The bounds of a case that are not those of its job, by name."""
    return {name: spec.bounds for name, spec in case.specs.items() if spec.bounds and spec != job.parameters[name]}


def improvement_of(job: Job, case: Case, staircase: stairs.Staircase, last: dict[str, Any]) -> dict[str, Any]:
    """The content of `improvement.json`, less the next experiment."""
    steps, suspects = staircase.steps, staircase.suspects
    reason = last["reason"]
    added = [item for item in steps[-1].fit.effects if item not in job.effects]
    reason += "".join(f" {suspect.why_not}" for suspect in suspects)
    undecided = dict.fromkeys(step.tied for step in ties(steps))
    reason += "".join(f" These data cannot tell {' from '.join(map(phrase_of, tied))}." for tied in undecided)
    reason += narrow_bounds_sentence(case, steps[-1].fit) + caveats(case, steps[-1].fit)
    return {
        "name": job.name,
        "steps": [stair(case, step) for step in steps],
        "verdict": last["verdict"],
        "reason": reason,
        "effects": list(map(word_of, added)),
        "forms": forms_of(added),
        "suspects": [
            {"effect": word_of(item.effect), "explained": item.share, "why not": item.why_not} for item in suspects
        ],
        **units_and_floors(list(case.records)),
    }


def forms_of(items: Iterable[str]) -> dict[str, str]:
    """The forms of the effects that have several, by word."""
    return {word_of(item): blocks[item].item().partition(".")[2] for item in items if len(blocks.forms(item)) > 1}


def size_of(case: Case) -> float:
    return factor(loss_unit(case.records))


def ties(steps: list[stairs.Step]) -> list[stairs.Step]:
    """The stairs of effects that the last model has and these data cannot tell from others."""
    return [step for step in steps if len(step.rivals) > 1 and step.added in steps[-1].fit.effects]


def errors_of(case: Case, fit: Fit) -> dict[str, float | None]:
    size = size_of(case)
    return {"identify": fit.identify / size, "validate": None if fit.validate is None else fit.validate / size}


def by_record(case: Case, fit: Fit) -> list[dict[str, Any]]:
    return [errors_in(record, fit.problem, fit.point) for record in fit.problem.records]


def stair(case: Case, step: stairs.Step) -> dict[str, Any]:
    return {
        "added": step.added and word_of(step.added),
        "removed": step.removed and word_of(step.removed),
        "form": step.added and form_of(step.added),
        "change": step.change or None,
        "class": list(map(word_of, step.tied)),
        "rmse": errors_of(case, step.fit),
        "records": by_record(case, step.fit),
        "explained": step.explained,
        "expected": step.expected,
        "parameters": parameters_of(step.fit),
        "effects": list(step.fit.effects),
        "steps": list(step.fit.steps),
    }


def parameters_of(fit: Fit) -> dict[str, dict[str, Any]]:
    """The free parameters of a fit with their units and standard errors, None where the data do not determine them."""
    return {
        item.name: {"value": item.value, "unit": item.unit, "standard_error": item.standard_error}
        for item in fit.estimates
    }


def refitted(case: Case, fit: Fit) -> dict[str, Any]:
    """What the job of a refit is to have, so that a run of it starts there and finds no less."""
    units = zip(fit.values.items(), fit.problem.units, strict=True)
    return {
        "parameters": {name: {"value": value, "unit": unit} for (name, value), unit in units},
        "steps": list(fit.steps),
        "values": case.unmeasured_nulls(fit.effects) if fit.measured_only else {},
    }


def diagnosis_of(job: Job, case: Case, found: Diagnosis, folder: Path) -> dict[str, Any]:
    rivals = stairs.rivals_of(found)
    proposed = separating(job, case, rivals, folder)
    reason = (
        f"{found.reason} {misfit_sentences(case, found.before)}" if found.verdict == "unexplained" else found.reason
    )
    if len(rivals) > 1 and not proposed:
        reason += f" No drive within {limits_of(job, case)} tells them apart: allow more under `limits`."
    return {
        "verdict": found.verdict,
        "reason": reason
        + caveats(case, found.best.fit if found.best and found.best.fit else found.before)
        + broken_conditions(found.before)
        + case.budget.sentence,
        **units_and_floors(list(case.records)),
        "rmse": errors_of(case, found.before),
        "records": by_record(case, found.before),
        "effects": list(found.before.effects),
        "parameters": parameters_of(found.before),
        "candidates": [
            {
                "effect": word_of(item.score.effect),
                "form": form_of(item.score.effect),
                "item": item.score.effect,
                "class": list(map(word_of, found.tied if item.score.effect in found.tied else [item.score.effect])),
                "explained": min(item.score.explained_in_bounds, 1.0),
                "expected": item.score.guess,
                "units": item.score.units,
                "visibility": item.score.visibility,
                "power": item.score.power if np.isfinite(item.score.power) else None,
                "rmse": errors_of(case, item.fit) if item.fit else None,
                "records": by_record(case, item.fit) if item.fit else None,
                **(refitted(case, item.fit) if item.fit else {}),
                "decision": item.decision,
                "physics": headline(blocks[item.score.effect]),
                "look_alikes": list(blocks[item.score.effect].look_alikes),
                "separate_by": blocks[item.score.effect].separate_by,
                "remedy": blocks[item.score.effect].remedy,
            }
            for item in found.candidates
        ],
        "next_experiment": proposed,
    }
