"""From a job to what its model is missing, and to the job that has it: `diagnosis.json`, `improvement.json`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from pzt_ident.data.record import Record
from pzt_ident.data.signals import write_signals
from pzt_ident.diagnosis import staircase as stairs
from pzt_ident.diagnosis import thinning
from pzt_ident.diagnosis.bounds import bounds_that_changed
from pzt_ident.diagnosis.budget import Budget, sensible
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.thinning import diagnosed
from pzt_ident.diagnosis.verdict import Diagnosis
from pzt_ident.errors import RunError
from pzt_ident.files import write_sealed, write_text
from pzt_ident.job.edit import edited
from pzt_ident.job.schema import Job
from pzt_ident.run.events import Event, Listen, event_log, nobody, sentence
from pzt_ident.run.findings import diagnosis_of, improvement_of, size_of, stair, ties
from pzt_ident.run.folder import begin, results_folder
from pzt_ident.run.misfit import misfits
from pzt_ident.run.next_drive import separating
from pzt_ident.run.start import read_start, start_point
from pzt_ident.run.statement import Statement


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
    statement, folder = begin_task(job, out, budget, start, records, task)
    case = case_of(statement)
    with event_log(folder, listen) as tell, np.errstate(all="ignore"):
        case.on_event = lambda event: tell(worded(case, event))
        case.budget = Budget(sensible(sum(record.samples for record in case.records)) if budget is None else budget)
        yield case, folder
        tell({"event": "done", "folder": str(folder)})


def begin_task(
    job: Job,
    out: Path | None,
    budget: float | None,
    start: Path | None,
    records: Sequence[Record] | None = None,
    task: str = "improve",
) -> tuple[Statement, Path]:
    """What the job states, and its folder, with the job and with what it takes to begin again."""
    statement, folder = Statement(job, records), results_folder(job, out)
    settings = {"name": task, "budget": budget, "start": start and str(start.resolve())}
    begin(folder, job, edited(job, job.effects, folder), statement.records, settings)
    return statement, folder


def case_of(statement: Statement) -> Case:
    """The case that a job makes with its records."""
    job, problem = statement.job, statement.problem
    return Case(
        job.model, job.effects, statement.records, job.parameters, job.rule_out, job.shared, base_problem=problem
    )


def worded(case: Case, event: Event) -> Event:
    """An event with its errors in the user's unit, and in words."""
    size = size_of(case)
    in_units = event | {use: event[use] / size for use in ("identify", "validate") if event.get(use) is not None}
    return in_units | {"said": sentence(in_units, case.records[0].units)}


def announce(case: Case, step: stairs.Step, path: int = 1) -> None:
    """Tell whoever follows the case of a stair. path: the number of the path that it is on, beginning with 1."""
    case.on_event({"event": "stair", "path": path, "units": case.records[0].units, **stair(case, step)})


def announced(case: Case, first: Fit) -> Fit:
    """The fit of the model as given, of which whoever follows the case is told."""
    announce(case, stairs.Step(first))
    return first


def diagnose(
    job: Job,
    out: Path | None = None,
    listen: Listen = nobody,
    budget: float | None = None,
    start: Path | None = None,
    records: Sequence[Record] | None = None,
) -> Path:
    """Fit the job's model, say where it fails and what it misses; writes `diagnosis.json`, `residuals.json` and
    `signals.nc` into the folder returned. budget, start, records: as of `improve`."""
    with opened_case(job, out, listen, budget, start, records, task="diagnose") as (case, folder):
        found = diagnosed(case, lambda case: announced(case, fitted(case, job, start)))
        diagnosis, first = diagnosis_of(job, case, found, folder), found.before
        write_signals(folder / "signals.nc", first.problem.errors(first.point))
        write_diagnosis(folder, job, case, diagnosis)
    return folder


def write_diagnosis(folder: Path, job: Job, case: Case, diagnosis: dict[str, Any]) -> None:
    """Write `residuals.json` and, last of all, `diagnosis.json`: where it is, the folder is whole."""
    names = [record.name for record in case.records]
    write_sealed(folder / "residuals.json", misfits(folder, job.name, diagnosis, names))
    write_sealed(folder / "diagnosis.json", diagnosis)


def fitted(case: Case, job: Job, start: Path | None) -> Fit:
    """The fit of the job's model, the best of random points and of the fit in a place that is given. Raises RunError
    where it can be simulated at none of them."""
    known = None if start is None else start_point(case.problem(case.effects), read_start(start, job))
    fit = first_fit(case, job.seed, known)
    if not np.isfinite(fit.identify):
        raise RunError("the simulation of the model failed from each of its starts: narrow the bounds")
    return fit


def improve(
    job: Job,
    out: Path | None = None,
    listen: Listen = nobody,
    budget: float | None = None,
    start: Path | None = None,
    records: Sequence[Record] | None = None,
) -> Path:
    """Diagnose, add what is missing and diagnose again, until nothing is missing or nothing more is known.

    budget: seconds of work, by default 60 or 1 ms a sample. After them the verdict is on what was found by then, and
    says what was not tried. start: a folder of results, or a file of values, whose fit is gone on from where it is the
    better one. records: those of the job where they were read already.

    Writes `improved.yaml`, `diagnosis.json` and `residuals.json` of the last model, `improvement.json`, and the signals
    of the model as given and of the last one.
    """
    with opened_case(job, out, listen, budget, start, records) as (case, folder):
        staircase = thinning.improve(case, lambda case: fitted(case, job, start), lambda case: SoFar(job, case, folder))
        steps, end = staircase.steps, staircase.case or case
        diagnosis = diagnosis_of(job, end, staircase.last, folder)
        for name, step in (("signals_as_given.nc", steps[0]), ("signals.nc", steps[-1])):
            write_signals(folder / name, step.fit.problem.errors(step.fit.point))
        proposals = (separating(job, end, step.rivals, folder) for step in ties(steps))
        proposed = diagnosis["next_experiment"] or next(filter(None, proposals), None)
        content = improvement_of(job, case, staircase, diagnosis, proposed, case.budget)
        write_improvement(folder, content, improved(job, case, steps[-1].fit, folder))
        write_diagnosis(folder, job, case, diagnosis)
    return folder


class SoFar:
    """A listener to the steps of a staircase that keeps the best account so far on the disk."""

    def __init__(self, job: Job, case: Case, folder: Path) -> None:
        self.job, self.case, self.folder = job, case, folder
        self.steps: list[stairs.Step] = []
        self.least, self.paths = np.inf, 0

    def __call__(self, step: stairs.Step) -> None:
        goes_on = step.added or step.removed or step.change
        self.steps = [*self.steps, step] if goes_on else [step]
        self.paths += not goes_on
        announce(self.case, step, self.paths)
        if step.fit.total < self.least:
            self.least = step.fit.total
            staircase = stairs.Staircase(self.steps, Diagnosis("unfinished", "", step.fit, [], []))
            last = {
                "verdict": "unfinished",
                "reason": "The best account so far: the diagnosis did not come to its end.",
            }
            content = improvement_of(self.job, self.case, staircase, last)
            write_improvement(self.folder, content, improved(self.job, self.case, step.fit, self.folder))


def write_improvement(folder: Path, content: dict[str, Any], job_text: str) -> None:
    """Write `improvement.json` and the job that goes with it."""
    write_text(folder / "improved.yaml", job_text)
    write_sealed(folder / "improvement.json", content)


def improved(job: Job, case: Case, end: Fit, folder: Path) -> str:
    """The text of the job with the model of a fit: its blocks and effects, its simulation steps, parameters that are
    fixed at their nulls, bounds that are wider."""
    words = case.words_of(end)
    values = case.unmeasured_nulls(end.effects) if end.measured_only else {}
    bounds = bounds_that_changed(case, end)
    blocks = None if words == case.words else [item if isinstance(item, str) else item.name for item in words]
    records = end.problem.records
    switched = {word: [getattr(record, word) for record in records] for word in ("denoise_drive", "smooth_drive")}
    return edited(job, end.effects, folder, blocks, steps=end.steps, values=values, bounds=bounds, switched=switched)
