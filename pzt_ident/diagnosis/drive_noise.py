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
    their path longer, and where that changes little."""
    return None if adequate(case, first, first) else quiet_beside(case, first, first, PROMISING)


def quiet_behind(case: Case, first: Fit, end: Fit) -> tuple[Case, Fit] | None:
    """The same where the noise of its drives is most of what a fit with effects leaves; else None."""
    return quiet_beside(case, first, end, DECISIVE)


def quiet_beside(case: Case, first: Fit, fit: Fit, share: float) -> tuple[Case, Fit] | None:
    """The same where that removes so much of what a fit leaves, and not little."""
    quiet = quieted(case)
    if quiet is case or not case.budget.allows(QUIET):
        return None
    after = refit(quiet, fit, fit.effects, {})
    clear = removed_rms(fit.total, after.total) > CLEAR * case.floor
    if not clear or share_explained(fit.total, after.total, case.floor) < share:
        return None
    return quiet, after if fit is first else refit(quiet, first, first.effects, {})


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
