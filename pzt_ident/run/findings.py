"""What a diagnosis and an improvement found, as the contents of `diagnosis.json` and `improvement.json`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pzt_ident.data.noise import units_and_floors
from pzt_ident.data.units import factor
from pzt_ident.diagnosis import staircase as stairs
from pzt_ident.diagnosis.bounds import bounds_that_changed, narrow_bounds_sentence
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.caveats import amounts, broken_conditions, caveats, misfit_sentences
from pzt_ident.diagnosis.criteria import CLEAR, DECISIVE, removed_rms
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.forms import Candidate
from pzt_ident.diagnosis.history import history_sentence
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.refining import refined_operator
from pzt_ident.diagnosis.ties import TWIN
from pzt_ident.diagnosis.unmeasured import own_mechanics_sentence
from pzt_ident.diagnosis.verdict import Diagnosis
from pzt_ident.diagnosis.within_bounds import beyond_known_sentence, within_bounds_sentence
from pzt_ident.job.schema import Job
from pzt_ident.model.description import headline
from pzt_ident.model.registry import blocks, form_of, phrase_of, word_of
from pzt_ident.run.collect import errors_in
from pzt_ident.run.next_drive import limits_of, separating
from pzt_ident.run.statement import loss_unit


def improvement_of(
    job: Job,
    case: Case,
    staircase: stairs.Staircase,
    last: dict[str, Any],
    proposed: dict[str, Any] | None = None,
    budget: Budget | None = None,
) -> dict[str, Any]:
    """The content of `improvement.json`. proposed: the next experiment, None where there is none. budget: for the
    intervals of the last model, and what was worked of it."""
    steps, suspects = staircase.steps, sorted(staircase.suspects, key=lambda suspect: -suspect.share)
    reason, end = last["reason"], steps[-1].fit
    added = [effect for effect in end.effects if effect not in job.effects and not refined_operator(end, effect)]
    reason += "".join(f" {suspect.why_not}" for suspect in suspects)
    reason += prediction_sentence(case, steps)
    undecided = dict.fromkeys(step.tied for step in ties(steps))
    reason += "".join(f" These data cannot tell {' from '.join(map(phrase_of, tied))}." for tied in undecided)
    reason += no_drive_sentence(job, case, [step.rivals for step in ties(steps)]) if undecided and not proposed else ""
    reason += narrow_bounds_sentence(case, end)
    if last["verdict"] != "unfinished":
        reason += within_bounds_sentence(case, end) + beyond_known_sentence(case, end)
    reason += own_mechanics_sentence(case, end) + history_sentence(case, end)
    reason += caveats(case, end, reason)  # the last diagnosis may be of this fit
    return {
        "name": job.name,
        "steps": [*(stair(case, step) for step in steps[:-1]), stair(case, steps[-1], budget)],
        "verdict": last["verdict"],
        "reason": reason,
        "effects": list(map(word_of, added)),
        "forms": forms_of(added),
        "suspects": [
            {"effect": word_of(suspect.effect), "explained": suspect.share, "why not": suspect.why_not}
            for suspect in suspects
        ],
        **units_and_floors(list(case.records)),
        "next_experiment": proposed,
        "work": round(budget.worked, 3) if budget else None,
    }


def prediction_sentence(case: Case, steps: Sequence[stairs.Step]) -> str:
    """A sentence about a model with more effects than are proven, where it leaves much less on the validation records
    than the last one; empty where there is none."""
    end = steps[-1].fit
    fits = [step.fit for step in steps if step.fit.validate is not None]
    best = min(fits, key=lambda fit: fit.validate or 0.0, default=end)
    if not end.validate or not best.validate or {*best.effects} <= {*end.effects}:
        return ""
    little = removed_rms(end.validate, best.validate) <= CLEAR * case.floor
    if little or share_explained(end.validate, best.validate, case.floor) < DECISIVE:
        return ""
    floors = f"{best.validate / case.floor:.1f} instead of {end.validate / case.floor:.1f} noise floors"
    return (
        f" With `effects: [{', '.join(best.effects)}]` the model leaves {floors} on the validation records: use it to"
        " predict, but its effects are not proven."
    )


def forms_of(effects: Iterable[str]) -> dict[str, str]:
    """The forms of the effects that have several, by word."""
    several = [effect for effect in effects if len(blocks.forms(effect)) > 1]
    return {word_of(effect): blocks[effect].item().partition(".")[2] for effect in several}


def size_of(case: Case) -> float:
    """The unit of the errors of a case, in SI units."""
    return factor(loss_unit(case.records))


def ties(steps: list[stairs.Step]) -> list[stairs.Step]:
    """The stairs of effects that the last model has and these data cannot tell from others, of each the last."""
    last = {step.added: step for step in steps}
    return [step for step in last.values() if len(step.rivals) > 1 and step.added in steps[-1].fit.effects]


def errors_of(case: Case, fit: Fit) -> dict[str, float | None]:
    size = size_of(case)
    return {"identify": fit.identify / size, "validate": None if fit.validate is None else fit.validate / size}


def by_record(case: Case, fit: Fit) -> list[dict[str, Any]]:
    return [errors_in(record, fit.problem, fit.point) for record in fit.problem.records]


def stair(case: Case, step: stairs.Step, budget: Budget | None = None) -> dict[str, Any]:
    return {
        "added": step.added and word_of(step.added),
        "removed": step.removed and word_of(step.removed),
        "form": step.added and form_of(step.added),
        "change": step.change or None,
        "class": list(dict.fromkeys(map(word_of, step.tied))),
        "rmse": errors_of(case, step.fit),
        "records": by_record(case, step.fit),
        "explained": step.explained,
        "expected": step.expected,
        "parameters": parameters_of(step.fit, budget),
        "amounts": [amount._asdict() for amount in amounts(step.fit)],
        "model": list(map(word_of, case.words_of(step.fit))),
        "bounds": bounds_that_changed(case, step.fit),
        "effects": list(step.fit.effects),
        "steps": list(step.fit.steps),
    }


def parameters_of(fit: Fit, budget: Budget | None) -> dict[str, dict[str, Any]]:
    """The free parameters of a fit with their units, and whether the data determine them: standard errors and intervals
    are None where they do not."""
    keys = "value", "unit", "standard_error", "interval", "verdict"
    return {estimate.name: {key: getattr(estimate, key) for key in keys} for estimate in fit.estimates(budget)}


def refitted(case: Case, fit: Fit) -> dict[str, Any]:
    """What the job of a refit is to have, so that a run of it starts there and finds no less."""
    units = zip(fit.values.items(), fit.problem.units, strict=True)
    return {
        "parameters": {name: {"value": value, "unit": unit} for (name, value), unit in units},
        "steps": list(fit.steps),
        "values": case.unmeasured_nulls(fit.effects) if fit.measured_only else {},
    }


def diagnosis_of(job: Job, case: Case, diagnosis: Diagnosis, folder: Path) -> dict[str, Any]:
    """The content of `diagnosis.json`; the drive that it proposes is written into the folder."""
    before, best = diagnosis.before, diagnosis.best
    rivals = diagnosis.rivals
    proposed = separating(job, case, rivals, folder)
    reason = diagnosis.reason
    if diagnosis.verdict == "unexplained":
        reason += f" {misfit_sentences(case, before)}"
    if len(rivals) > 1 and not proposed:
        reason += no_drive_sentence(job, case, [rivals])
    return {
        "verdict": diagnosis.verdict,
        "reason": reason
        + caveats(case, best.fit if best and best.fit else before)
        + broken_conditions(before)
        + case.budget.sentence,
        **units_and_floors(list(case.records)),
        "rmse": errors_of(case, before),
        "records": by_record(case, before),
        "effects": list(before.effects),
        "parameters": parameters_of(before, case.budget),
        "candidates": [candidate_of(case, candidate, diagnosis.tied) for candidate in diagnosis.candidates],
        "faults": list(diagnosis.faults),
        "next_experiment": proposed,
    }


def no_drive_sentence(job: Job, case: Case, ties: Iterable[Mapping[str, Fit]]) -> str:
    """That no drive tells tied effects apart. ties: the fits with each of them, by effect."""
    totals = [[fit.total for fit in fits.values()] for fits in ties]
    one = all(max(each) - min(each) < TWIN * case.floor for each in totals)
    why = "these names are one model in this job." if one else "allow more under `limits`."
    return f" No drive within {limits_of(job, case)} tells them apart: {why}"


def candidate_of(case: Case, candidate: Candidate, tied: Sequence[str]) -> dict[str, Any]:
    """An effect that was scored, and its refit where there was one. tied: the effects that fit equally well."""
    score, fit, block = candidate.score, candidate.fit, blocks[candidate.score.effect]
    return {
        "effect": word_of(score.effect),
        "form": form_of(score.effect),
        "item": score.effect,
        "class": list(dict.fromkeys(map(word_of, tied if score.effect in tied else [score.effect]))),
        "explained": min(score.explained_in_bounds, 1.0),
        "expected": score.guess,
        "units": score.units,
        "visibility": score.visibility,
        "power": score.power if np.isfinite(score.power) else None,
        "rmse": errors_of(case, fit) if fit else None,
        "records": by_record(case, fit) if fit else None,
        **(refitted(case, fit) if fit else {}),
        "decision": candidate.decision,
        "physics": headline(block),
        "look_alikes": list(block.look_alikes),
        "separate_by": block.separate_by,
        "remedy": block.remedy,
    }
