"""Campaigns of malformed jobs and data: each mutant through `check`, and those that are accepted through a run."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from experiments.trust import files, jobs, spoilt
from experiments.trust.bench import Bench, Case, Ended, InThisProcess, command
from experiments.trust.good import JOBS, write_good
from experiments.trust.judge import faults_of, files_in
from experiments.trust.mutants import REFUSE, SAME, Mutant
from experiments.trust.trees import read

MOST_EVALUATIONS = 2000
"""Of a run that a mutant asks for; what asks for more is only checked."""


def identified(folder: Path) -> Ended:
    """Run the job of a folder in this process; the answer is the result's parameters."""
    from pzt_ident.errors import InputError, RunError
    from pzt_ident.job.schema import load_job
    from pzt_ident.run.identify import run

    try:
        out = run(load_job(folder / "job.yaml"), folder / "out", place=InThisProcess())
    except InputError as error:
        return Ended(2, f"Error: {error}")
    except RunError as error:
        return Ended(1, f"Error: {error}")
    except Exception as error:
        return Ended(1, f"Error: {type(error).__name__}: {error}")
    return Ended(0, "", (out / "result.json").read_text(encoding="utf-8"))


def parameters_of(answer: str) -> dict[str, float]:
    return {name: facts["value"] for name, facts in json.loads(answer)["best"]["parameters"].items()}


def job_cases(numbers: range, seed: int, scratch: Path) -> Iterator[Case]:
    """Each is a good job with one mutation, in a folder of its own."""
    with Bench() as bench:
        good = {}
        for base in JOBS:
            write_good(scratch / base, seed, base)
            good[base] = parameters_of(bench.call(identified, scratch / base).answer)
        for number in numbers:
            rng = np.random.default_rng([seed, number])
            base = list(JOBS)[rng.integers(len(JOBS))]
            mutant = jobs.mutant(base, rng)
            folder = scratch / f"{number}"
            write_good(folder, seed, base).write_bytes(mutant.content)
            case = judged_job(bench, folder, Case(number, f"{base}: {mutant.how}", ""), mutant, base, good[base])
            yield case
            if not case.faults:
                shutil.rmtree(folder)


def judged_job(bench: Bench, folder: Path, case: Case, mutant: Mutant, base: str, good: dict[str, float]) -> Case:
    before = files_in(folder)
    checked = bench.call(command, ["check", "job.yaml", "--json"], folder)
    case.came, case.message = "accepted" if checked.code == 0 else "refused", checked.message
    if files_in(folder) != before:
        case.faults.append("check wrote something")
    if checked.code != 0:
        if mutant.expect == SAME:
            case.faults.append("refused, though it is the good job")
        files = ("job.yaml", "a.csv", "b.csv", "bare.txt", "x.npy", *filter(None, [mutant.value]))
        case.faults += faults_of(checked, files, mutant.value)
        return case
    if mutant.expect == REFUSE:
        case.faults.append("accepted")
        return case
    facts = json.loads(checked.answer)
    tree = tree_of(mutant.content)
    case.faults += [f"misread: {fault}" for fault in understood(tree, facts)]
    if facts["evaluations"] <= MOST_EVALUATIONS:
        ran = bench.call(identified, folder)
        case.message += ran.message
        if ran.code == 0:
            is_good = mutant.expect == SAME or tree == read(JOBS[base])
            if is_good and parameters_of(ran.answer) != good:
                case.faults.append("another result than the good job's")
        else:
            case.came = "accepted, no result"
            case.faults += list(faults_of(ran, ("",))) if ran.code != 1 or "Error: " in ran.message[7:] else []
    return case


def file_cases(numbers: range, seed: int, scratch: Path) -> Iterator[Case]:
    """Each is the file of a good measurement with one mutation, in a folder of its own."""
    columns = files.good(seed)
    with Bench() as bench:
        for number in numbers:
            rng = np.random.default_rng([seed, number])
            form = list(files.FORMATS)[rng.integers(len(files.FORMATS))]
            mutant = spoilt.mutant(form, columns, rng)
            folder = scratch / f"{number}"
            folder.mkdir()
            (folder / f"data.{form}").write_bytes(mutant.content)
            (folder / "job.yaml").write_text(files.job_for(form, f"data.{form}"))
            case = judged_file(bench, folder, Case(number, f"{form}: {mutant.how}", ""), mutant, form, columns)
            yield case
            if not case.faults:
                shutil.rmtree(folder)


def judged_file(
    bench: Bench, folder: Path, case: Case, mutant: Mutant, form: str, columns: dict[str, np.ndarray]
) -> Case:
    before = files_in(folder)
    ran = bench.call(identified, folder)
    case.came, case.message = "accepted" if ran.code == 0 else "refused", ran.message
    if ran.code != 0:
        if mutant.expect == SAME:
            case.faults.append("refused, though it is the good file")
        case.faults += faults_of(ran, [f"data.{form}"], mutant.value)
        if files_in(folder) != before:
            case.faults.append("something was written")
        return case
    if mutant.expect == REFUSE:
        case.faults.append("accepted")
        return case
    worked_on = signals(folder / "out" / "signals.nc")
    true = np.column_stack(list(columns.values())) if mutant.expect == SAME else files.read(mutant.content, form)
    if true is None:
        case.faults.append("no data to another reader")
    elif worked_on.shape != true.shape or not np.allclose(worked_on[:, 1:], true[:, 1:], rtol=1e-9, atol=1e-15):
        case.faults.append("other numbers than another reader finds")
    return case


def signals(path: Path) -> np.ndarray:
    """(samples, 3): time, drive and response that a run worked on."""
    with h5py.File(path) as file:
        group = file[next(iter(file))]
        return np.column_stack([group[name][()] for name in ("time", "drive_x", "response_x")])


def tree_of(content: bytes) -> Any:
    try:
        return read(content)
    except Exception:
        return None


def understood(tree: Any, facts: dict[str, Any]) -> Iterator[str]:
    if tree is None:
        yield "no YAML to another reader"
        return
    try:
        yield from jobs.misread(tree, facts)
    except Exception as error:
        yield f"not a job to another reader ({error!r})"
