"""Recorded drives with noise, every reversal of which a hysteresis would count: the model as given without it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pzt_ident.data.drive_noise import path_of, without_noise
from pzt_ident.data.record import Record
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import CLEAR, DECISIVE, adequate, removed_rms
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.refit import refit

QUIET = "noise of the drive left out"  # the step after which drives have none
PROMISING = 0.02  # of the misfit of the model as given
LONGER = 1.001  # times its path without noise: less changes no hysteresis


def with_quiet_drives(case: Case, first: Fit) -> tuple[Case, Fit] | None:
    """The case with the noise of its drives left out, and the fit as given in it; None where they have none that makes
    their path longer, and where that is little of the misfit."""
    if adequate(case, first, first):
        return None
    quiet = quieted(case)
    return (quiet, refit(quiet, first, first.effects, {})) if is_noise(case, quiet, first, PROMISING) else None


def quiet_behind(case: Case, first: Fit, last: Case, end: Fit) -> tuple[Case, Fit] | None:
    """The same where the noise of its drives is most of what the last fit of a staircase leaves; else None. last: the
    case of that."""
    if not is_noise(last, quieted(last), end, DECISIVE):
        return None
    quiet = quieted(case)
    return quiet, refit(quiet, first, first.effects, {})


def is_noise(case: Case, quiet: Case, fit: Fit, least: float) -> bool:
    """Whether a fit leaves clearly less without the noise of the drives, and less by that share of its misfit."""
    if quiet is case or not case.budget.allows(QUIET):
        return False
    after = refit(quiet, fit, fit.effects, {})
    clear = removed_rms(fit.total, after.total) > CLEAR * case.floor
    return clear and share_explained(fit.total, after.total, case.floor) >= least


def quieted(case: Case) -> Case:
    """The case with drives without noise; the same where none has any."""
    records = [denoised(record) for record in case.records]
    changed = any(new is not old for new, old in zip(records, case.records, strict=True))
    return case.with_records(records) if changed else case


def denoised(record: Record) -> Record:
    """The record with drives without noise; the same where that makes no path shorter, and where it was left out."""
    if record.denoise_drive:
        return record
    drives = np.array([without_noise(drive) for drive in record.drive])
    pairs = zip(record.drive, drives, strict=True)
    longer = any(path_of(with_it) > LONGER * path_of(without) for with_it, without in pairs)
    return replace(record, drive=drives, denoise_drive=True) if longer else record
