"""How recorded drives go between their samples, which mechanics and delays feel: on lines, or smoothly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pzt_ident.data.record import Record, interpolated
from pzt_ident.diagnosis.baseline import stroke
from pzt_ident.diagnosis.budget import WHOLE
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import CLEAR, DECISIVE, adequate, removed_rms
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.possible import applicable
from pzt_ident.diagnosis.refit import refit
from pzt_ident.model.registry import blocks

SMOOTH = "drives smooth between their samples"  # the step after which they are
LINEAR = "drives on lines between their samples"  # the same where the model takes them as smooth by itself
PROBE = "delay"  # the effect that feels it most
PROMISING = 0.02  # of the misfit of the model as given, or of that with a delay
LITTLE = 3.0  # noise floors, that drives leave which are hardly off the lines
UNLIKE = 0.02  # of its deviation, by which a drive midway between its samples is off the line


def with_other_drives(case: Case, first: Fit) -> tuple[Case, Fit] | None:
    """The case with drives that are smooth between their samples, or on lines where the model takes them as smooth, and
    the fit as given in it, where the model as given or one with a delay leaves clearly less then; else None."""
    return other_beside(case, first, first, PROMISING)


def other_behind(case: Case, first: Fit, best: Fit | None) -> tuple[Case, Fit] | None:
    """The same where the model with the best effect, or with a delay beside that, leaves less than half then."""
    return other_beside(case, first, best, DECISIVE) if best else None


def other_beside(case: Case, first: Fit, fit: Fit, least: float) -> tuple[Case, Fit] | None:
    """The same where such drives remove that share of what a fit leaves, or one with a delay beside it; where they are
    hardly off the lines, only if they lead to the noise: of what anything else leaves, they may take up a part. Nor are
    they asked then of a fit that leaves more than a little, unless the model takes them as smooth by itself."""
    if adequate(case, first, fit) or (other := reshaped(case)) is case:
        return None
    unlike = any(is_off_lines(record, UNLIKE) for record in case.records)
    if not (unlike or takes_smooth(case) or fit.total < LITTLE * case.floor):
        return None
    probed = [(PROBE,)] if PROBE in applicable(case, fit.effects) else []
    for more in ((), *probed):
        if not case.budget.allows(SMOOTH):
            return None
        usual, after = (refit(home, fit, (*fit.effects, *more), half_a_sample(case)) for home in (case, other))
        clear = removed_rms(usual.total, after.total) > CLEAR * case.floor
        share = share_explained(usual.total, after.total, case.floor)
        enough = share >= least and (unlike or adequate(case, first, after))
        if clear and enough and not (after.by_use > usual.by_use).any():
            return other, refit(other, first, first.effects, {})
    return None


def has_other(case: Case) -> bool:
    """Whether drives may go otherwise between their samples."""
    return reshaped(case) is not case


def way_of(case: Case) -> str:
    """The step after which drives go otherwise between their samples."""
    return LINEAR if takes_smooth(case) else SMOOTH


def better_as_usual(case: Case, end: Fit) -> bool:
    """Whether the last model of a staircase with other drives leaves clearly less with those of the job. case: that of
    the job."""
    if adequate(case, end, end) or not case.budget.allows(SMOOTH, WHOLE):
        return False
    return removed_rms(end.total, refit(case, end, end.effects, {}).total) > CLEAR * case.floor


def half_a_sample(case: Case) -> dict[str, float]:
    """A delay of half a sample of each measured axis, by name."""
    problem = case.problem((*case.effects, PROBE))
    dt = min(record.dt for record in case.records)
    return {name: dt / 2 for name in problem.names if f"{PROBE}." in name}


def reshaped(case: Case) -> Case:
    """The case with drives that go otherwise between their samples; the same where they are off the lines by less than
    UNLIKE, and by less than the noise could tell."""
    if case.reshaped is None:
        smooth, least = not takes_smooth(case), min(UNLIKE, case.floor / stroke(case.problem(case.effects)))
        records = [with_drive(record, smooth, least) for record in case.records]
        changed = any(new is not old for new, old in zip(records, case.records, strict=True))
        case.reshaped = case.with_records(records) if changed else case
    return case.reshaped


def takes_smooth(case: Case) -> bool:
    """Whether the model takes drives as smooth between their samples by itself."""
    return any(block.oversample > 1 for block in blocks.chain(case.words))


def with_drive(record: Record, smooth: bool, least: float) -> Record:
    """The record with drives that are smooth, or on lines; the same where the job says how they are, or where they are
    off the lines by less than a share of their deviation."""
    if record.smooth_drive is not None or not is_off_lines(record, least):
        return record
    return replace(record, smooth_drive=smooth)


def is_off_lines(record: Record, least: float) -> bool:
    """Whether a drive that is smooth is off the lines by more than a share of its deviation."""
    return any(off_lines(record, drive) > least * np.std(drive) for drive in record.drive)


def off_lines(record: Record, drive: np.ndarray) -> float:
    """How far a drive that is smooth is off the lines midway between its samples, root mean square."""
    periodic = bool(record.run_in)
    apart = interpolated(drive, 2, periodic, True) - interpolated(drive, 2, periodic, False)
    return float(np.sqrt(np.mean(apart[1:-2:2] ** 2)))
