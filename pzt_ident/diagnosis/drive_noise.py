"""Recorded drives with noise, every reversal of which a hysteresis would count: the model as given without it, and what
a model makes of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.drive_noise import noise_of_drive, path_of, without_noise
from pzt_ident.data.record import Record
from pzt_ident.data.units import factor
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import CLEAR, DECISIVE, FAR, adequate, removed_rms
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.refit import refit
from pzt_ident.engine.simulator import Simulator

Array = NDArray[np.float64]

QUIET = "noise of the drive left out"  # the step after which drives have none
PROMISING = 0.02  # of the misfit of the model as given
LONGER = 1.001  # times its path without noise: less changes no hysteresis
MUCH, ALL = 0.5, 1.2  # of an RMSE: what is told of noise of the drives; a stage follows what makes more than it leaves


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


def passed_on(fit: Fit) -> Array:
    """Root mean square by which the response of a fit changes in the identification records with as much noise again as
    their drives were recorded with, SI units: (measured axes,)."""
    theta, random = fit.problem.parameters(fit.point), np.random.default_rng(0)
    simulators = fit.problem.simulators["identify"]
    squares = [simulator.scored * np.square(change_by_noise(simulator, theta, random)) for simulator in simulators]
    return np.asarray(np.sqrt(np.sum(squares, axis=0) / sum(simulator.scored for simulator in simulators)))


def change_by_noise(simulator: Simulator, theta: Array, random: np.random.Generator) -> Array:
    """The same of one record, about its mean."""
    record = simulator.record
    noise = np.array([[noise_of_drive(drive)] for drive in record.drive])
    noisy = replace(record, drive=record.drive + noise * random.standard_normal(record.drive.shape))
    change = simulator.on(noisy).simulate(theta)[0] - simulator.simulate(theta)[0]
    return np.asarray(np.std(change[:, record.settle :], axis=1))


def drive_noise_sentence(case: Case, fit: Fit) -> str:
    """A sentence on each axis where what a fit makes of the noise of recorded drives is far above the noise floor and
    may be MUCH of what it leaves, or all."""
    model, sentences = fit.problem.model, list[str]()
    errors, floors = fit.by_use[0] * fit.problem.sizes, case.floors * fit.problem.sizes
    passed = passed_on(fit) if (errors > FAR * floors).any() else np.zeros(len(floors))
    for i, axis in enumerate(model.measured):
        if max(FAR * floors[i], MUCH * errors[i]) < passed[i] < ALL * errors[i]:
            unit = str(fit.problem.records[0].response_units[axis])
            size = f"{passed[i] / factor(unit):.2g} {unit}{f' in {model.axes[axis]}' * (len(model.measured) > 1)}"
            sentences.append(
                f" The drives were recorded with noise, of which this model makes {size} rms,"
                f" {passed[i] / errors[i]:.2g} times what it leaves. If that is noise of the recorder and not of the"
                " drive, the noise floor is too low, and what is left may be no more."
            )
    return "".join(sentences)
