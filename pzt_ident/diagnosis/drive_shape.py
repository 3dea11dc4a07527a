"""How recorded drives go between their samples, which mechanics and delays feel: on lines, or smoothly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pzt_ident.data.record import Record, interpolated
from pzt_ident.diagnosis.budget import WHOLE
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import CLEAR, DECISIVE, adequate, removed_rms
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.possible import applicable
from pzt_ident.diagnosis.refit import refit

SMOOTH = "drives smooth between their samples"  # the step after which they are
PROBE = "delay"  # the effect that feels it most
PROMISING = 0.02  # of the misfit of the model as given, or of that with a delay
UNLIKE = 0.02  # of its deviation, by which a drive midway between its samples is off the line


def with_smooth_drives(case: Case, first: Fit) -> tuple[Case, Fit] | None:
    """The case with drives that are smooth between their samples, and the fit as given in it, where the model as given
    or one with a delay leaves clearly less then; else None."""
    return smooth_beside(case, first, first, PROMISING)


def smooth_behind(case: Case, first: Fit, best: Fit | None) -> tuple[Case, Fit] | None:
    """The same where the model with the best effect, or with a delay beside that, leaves less than half then."""
    return smooth_beside(case, first, best, DECISIVE) if best else None


def smooth_beside(case: Case, first: Fit, fit: Fit, least: float) -> tuple[Case, Fit] | None:
    """The same where smooth drives remove that share of what a fit leaves, or one with a delay beside it."""
    if adequate(case, first, fit) or (smooth := smoothed(case)) is case:
        return None
    probed = [(PROBE,)] if PROBE in applicable(case, fit.effects) else []
    for more in ((), *probed):
        if not case.budget.allows(SMOOTH):
            return None
        on_lines, after = (refit(home, fit, (*fit.effects, *more), half_a_sample(case)) for home in (case, smooth))
        clear = removed_rms(on_lines.total, after.total) > CLEAR * case.floor
        share = share_explained(on_lines.total, after.total, case.floor)
        if clear and share >= least and not (after.by_use > on_lines.by_use).any():
            return smooth, refit(smooth, first, first.effects, {})
    return None


def has_smooth(case: Case) -> bool:
    """Whether drives may be smooth between their samples."""
    return smoothed(case) is not case


def better_on_lines(case: Case, end: Fit) -> bool:
    """Whether the last model of a staircase with smooth drives leaves clearly less with drives on lines. case: that of
    the job."""
    if adequate(case, end, end) or not case.budget.allows(SMOOTH, WHOLE):
        return False
    return removed_rms(end.total, refit(case, end, end.effects, {}).total) > CLEAR * case.floor


def half_a_sample(case: Case) -> dict[str, float]:
    """A delay of half a sample of each measured axis, by name."""
    problem = case.problem((*case.effects, PROBE))
    dt = min(record.dt for record in case.records)
    return {name: dt / 2 for name in problem.names if f"{PROBE}." in name}


def smoothed(case: Case) -> Case:
    """The case with drives that are smooth between their samples; the same where that is hardly off the lines."""
    if case.smooth is None:
        records = [smooth(record) for record in case.records]
        changed = any(new is not old for new, old in zip(records, case.records, strict=True))
        case.smooth = case.with_records(records) if changed else case
    return case.smooth


def smooth(record: Record) -> Record:
    """The record with smooth drives; the same where they hardly differ from lines, and where they are."""
    if record.smooth_drive or not any(off_lines(record, drive) > UNLIKE * np.std(drive) for drive in record.drive):
        return record
    return replace(record, smooth_drive=True)


def off_lines(record: Record, drive: np.ndarray) -> float:
    """How far a drive that is smooth is off the lines midway between its samples, root mean square."""
    periodic = bool(record.run_in)
    apart = interpolated(drive, 2, periodic, True) - interpolated(drive, 2, periodic, False)
    return float(np.sqrt(np.mean(apart[1:-2:2] ** 2)))
