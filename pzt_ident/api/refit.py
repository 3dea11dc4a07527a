"""A fit gone on from, with other effects: between what a user has and what the diagnosis fits."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from pzt_ident.api.fitted import Fitted, Parts
from pzt_ident.api.model import Model
from pzt_ident.api.record import Record
from pzt_ident.api.statement import job_text, statement_of
from pzt_ident.diagnosis.bounds import bounds_that_changed
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.refit import refit as refitted
from pzt_ident.diagnosis.score import Scorer
from pzt_ident.errors import InputError, nearest
from pzt_ident.model.registry import blocks, word_of
from pzt_ident.run.checkpoint import Checkpoint
from pzt_ident.run.computing import computing
from pzt_ident.run.improve import case_of
from pzt_ident.run.statement import Statement
from pzt_ident.run.task import what_is_known


def with_effect(fit: Fitted, effect: str) -> Parts:
    """The parts of the fit with an effect more.

    Raises InputError where it is unknown, there already, or does not fit the model.
    """
    word = word_of(str(effect))
    if word in map(word_of, fit.model.effects):
        raise InputError(f"{effect!r} is in the model already", where="add", remedy="add another effect")
    if word not in blocks.effects():
        raise InputError(f"unknown effect {effect!r}", where="add", remedy=nearest(str(effect), blocks.effects()))
    effects = (*fit.model.effects, effect)
    restated(fit, fit.model.with_effects(effects))  # refused before anything is fitted
    with computing():
        case = case_of(fit.statement)
        before = as_given(case, fit)
        score = Scorer(case, before).score(effect)
        return from_refit(fit, case, refitted(case, before, effects, score.guess))


def as_given(case: Case, fit: Fitted) -> Fit:
    """A fit as the diagnosis goes on from it."""
    return fit_at(case.effects, case.problem(case.effects), fit.point)


def from_refit(fit: Fitted, case: Case, refit: Fit) -> Parts:
    """What the diagnosis fitted to the records of a fit, as the parts of a fit."""
    start = time.perf_counter()
    silent = case.unmeasured_nulls(refit.effects) if refit.measured_only else {}
    settings: dict[str, Any] = {name: {"value": value} for name, value in silent.items()}
    settings |= {name: {"bounds": list(bounds)} for name, bounds in bounds_that_changed(case, refit).items()}
    model = fit.model.with_blocks([*map(word_of, case.words_of(refit))]).with_effects(refit.effects)
    statement, records, sections = restated(fit, model, refit.steps, settings)
    point = statement.problem.unit_point(refit.values)
    known = what_is_known(statement, point)
    checkpoint, seconds = Checkpoint(), time.perf_counter() - start
    with checkpoint.appending() as append:
        append(seconds, np.array([refit.identify]))
    optimizer = optimizer_of(fit)
    run: dict[str, Any] = {
        "run": f"{optimizer}-0",
        "optimizer": optimizer,
        "repeat": 0,
        **known,
        "rmse_before_polish": known["rmse"],
        "evaluations": 1,
        "polish_evaluations": 0,
        "seconds": seconds,
        **dict.fromkeys(("cpu_seconds", "polish_seconds"), 0.0),
        "failed_simulations": 0,
        "stopped_by": "refit",
    }
    return Parts(statement, model, records, sections, [(run, checkpoint)])


def optimizer_of(fit: Fitted) -> str:
    """The optimizer that found a fit; the first of its job where the fit came from elsewhere."""
    words = [section["name"] for section in fit.sections["optimizers"]]
    return fit.best["optimizer"] if fit.best["optimizer"] in words else words[0]


def restated(
    fit: Fitted, model: Model, steps: tuple[int, ...] = (), settings: dict[str, Any] | None = None
) -> tuple[Statement, dict[str, tuple[Record, ...]], dict[str, Any]]:
    """What a fit's job states with another model, `steps` a sample of each record and other settings of some
    parameters: with its records and sections."""
    names = [record.name for record in fit.statement.records]
    counts = dict(zip(names, steps or [record.steps for record in fit.statement.records], strict=True))
    records = {
        use: tuple(record.with_steps(counts[record.name]) for record in group) for use, group in fit.records.items()
    }
    chosen = next(section for section in fit.sections["optimizers"] if section["name"] == optimizer_of(fit))
    gone = set(map(word_of, fit.model.blocks)) - set(map(word_of, model.blocks))
    kept = {name: value for name, value in fit.sections["parameters"].items() if name.split(".")[-2] not in gone}
    parameters = kept | (settings or {})
    sections = fit.sections | {"optimizers": [chosen], "repeats": 1, "parameters": parameters}
    text = job_text(fit.statement.job.name, model, records, sections)
    return statement_of(text, records), records, sections
