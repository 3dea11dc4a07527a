"""Long records: effects are sought on fewer samples, and what is found is fitted and proven on all of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import ceil

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.noise import noise_floor
from pzt_ident.data.record import Record
from pzt_ident.diagnosis import staircase as stairs
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import adequate
from pzt_ident.diagnosis.drive_noise import quieted
from pzt_ident.diagnosis.drive_shape import reshaped
from pzt_ident.diagnosis.faults import with_faults, without_outdone
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.judges import judged
from pzt_ident.diagnosis.paths import PROVEN
from pzt_ident.diagnosis.proof import unproven
from pzt_ident.diagnosis.refit import refine_steps
from pzt_ident.diagnosis.staircase import Staircase, StepListener
from pzt_ident.diagnosis.step import explained_share
from pzt_ident.diagnosis.suspect import Suspect
from pzt_ident.diagnosis.verdict import Diagnosis, diagnose

Array = NDArray[np.float64]
First = Callable[[Case], Fit]

LONG = 200_000  # samples of all identification records together: up to as many nothing is thinned
BETWEEN = 0.1  # noise floors, root mean square, that a drive may lie beside the line between the samples that are kept
TURNING = 1.0  # noise floors: the most that it may
INTERPOLATED = 1.75  # noise variances: as much is between a noisy response and the line between the samples kept
PLACES = 10  # of a drive, and of its speed, that are told apart
UNSEEN = 0.01  # of the samples left out that may be where the drive has not been before
SAME = 0.2  # of the RMSE, or SAME_FLOORS noise floors, root mean square, by which a fit may differ on all samples
SAME_FLOORS = 0.3
ON_FEWER = 0.5  # of the budget: what is sought again on all samples has all of it, as if there were no fewer


def improve(
    case: Case, first: First, on_step: Callable[[Case], StepListener] = lambda case: lambda step: None
) -> Staircase:
    """The staircase of a case; where its records are long, that of fewer samples, if it holds on all. first: the fit of
    the model as given. on_step: the listener to the steps of a case."""
    thin = thinned(case)
    if thin is not None:
        staircase = on_all_samples(case, thin, stairs.improve(thin, first(thin), on_step(thin)))
        if staircase is not None:
            return without_outdone(case, staircase)
        case.budget.begin_again()
    return without_outdone(case, stairs.improve(case, first(case), on_step(case)))


def diagnosed(case: Case, first: First) -> Diagnosis:
    """The diagnosis of the model as given; where the records are long, that of fewer samples, if it holds on all."""
    thin = thinned(case)
    if thin is not None:
        diagnosis = diagnosed_in(thin, first(thin))
        kept = on_all_samples(case, thin, Staircase([stairs.Step(diagnosis.before)], diagnosis))
        missing = [item for item in diagnosis.candidates if item.fit and item.decision == "missing"]
        fits = [on_all(case, item.fit) for item in missing if item.fit]
        if kept is not None and all(
            holds(case, item.fit, fit) for item, fit in zip(missing, fits, strict=True) if item.fit
        ):
            for item, fit in zip(missing, fits, strict=True):
                item.fit = item.refits[item.score.effect] = fit
            return kept.last
        case.budget.begin_again()
    return diagnosed_in(case, first(case))


def diagnosed_in(case: Case, first: Fit) -> Diagnosis:
    """The diagnosis of a fit, by the records that can judge it."""
    diagnosis = diagnose(case, first)
    judging, fit = judged(case, first, diagnosis.fits)
    return with_faults(judging, diagnosis if judging is case else diagnose(judging, fit))


def thinned(case: Case) -> Case | None:
    """The case with fewer samples to fit, judged on all validation records as they are; None where its identification
    records are short enough, or can lose none."""
    counts = np.array([record.samples for record in case.records if record.use == "identify"])
    if counts.sum() <= LONG:
        return None
    floors, most = [noise_floor(list(case.records), axis).value for axis in case.records[0].measured], most_of(counts)
    records = [thin_record(record, most, floors) if record.use == "identify" else record for record in case.records]
    thin = Case(case.words, case.effects, records, case.specs, case.ruled_out, case.shared, case.on_event)
    thin.error_scales, thin.floor, thin.budget = case.error_scales, case.floor, case.budget.part(ON_FEWER)
    return thin if [record.samples for record in records] != [record.samples for record in case.records] else None


def most_of(counts: NDArray[np.int64]) -> int:
    """The length to which records are cut so that LONG samples are left of all: shorter ones stay whole."""
    left, ordered = LONG, np.sort(counts)
    for number, count in enumerate(ordered):
        if count * (ordered.size - number) > left:
            return left // (ordered.size - number)
        left -= int(count)
    return int(ordered[-1])


def thin_record(record: Record, most: int, floors: Sequence[float]) -> Record:
    """A record with about so many samples: every n-th, as far as nothing is lost between them, and of these the first,
    as far as the others go where these have been. floors: noise of each measured axis, SI units."""
    wanted = ceil(record.samples / most)
    steps = sorted({wanted, *(2**i for i in range(wanted.bit_length()))} - {1}, reverse=True)
    step = next((step for step in steps if step <= wanted and keeps_all(record, step, floors)), 1)
    drive, response, settle = record.drive[:, ::step], record.response[:, ::step], -(-record.settle // step)
    end = drive.shape[1] if record.run_in else enough(drive, settle + most)
    return replace(record, dt=record.dt * step, settle=settle, drive=drive[:, :end], response=response[:, :end])


def enough(drive: Array, least: int) -> int:
    """How many samples of a drive, (axes, samples), go nearly everywhere that it goes: at least so many, or twice, four
    times as many."""
    samples = drive.shape[1]
    if least >= samples:
        return samples
    kinds = np.array([situations(u) for u in drive]).T
    _, first, kind = np.unique(kinds, axis=0, return_index=True, return_inverse=True)
    reached = first[kind.ravel()]
    while least < samples and np.mean(reached[least:] >= least) > UNSEEN:
        least *= 2
    return min(least, samples)


def situations(u: Array) -> NDArray[np.int64]:
    """What a drive does at each sample, (samples,): where it is, how fast it moves, and how long it has moved that way
    or rested, roughly."""
    move = np.diff(u, prepend=u[:1])
    way = np.sign(move)
    turned = np.append(True, way[1:] != way[:-1])
    since = np.arange(u.size) - np.maximum.accumulate(np.where(turned, np.arange(u.size), 0))
    place = (u - u.min()) / (np.ptp(u) or 1.0)
    speed = way * np.sqrt(np.abs(move) / (np.abs(move).max() or 1.0))
    rough = np.floor(PLACES * place), np.round(PLACES * speed), np.floor(np.log2(1 + since))
    return np.asarray((rough[0] * 1000 + rough[1]) * 1000 + rough[2], dtype=np.int64)


def keeps_all(record: Record, step: int, floors: Sequence[float]) -> bool:
    """Whether drives and responses are those of every `step`-th sample but for the noise: a step at the start takes one
    sample."""
    if record.rest_at or (record.run_in and record.samples % step):
        return False
    responses = list(zip(record.response[list(record.measured)], floors, strict=True))
    if any(np.mean(off_line(y, step) ** 2) > INTERPOLATED * floor**2 for y, floor in responses):
        return False
    for u in record.drive:
        gains = [np.ptp(y) / (np.ptp(u) * floor or np.inf) for y, floor in responses]
        beside = np.abs(off_line(u, step)) * max(gains)
        if np.sqrt(np.mean(beside**2)) > BETWEEN or beside.max() > TURNING:
            return False
    return True


def off_line(signal: Array, step: int) -> Array:
    """How far a signal is from the lines between its every `step`-th samples: (samples,)."""
    at = np.arange(signal.size)
    return np.asarray(signal - np.interp(at, at[::step], signal[::step]))


def on_all_samples(case: Case, thin: Case, staircase: Staircase) -> Staircase | None:
    """A staircase of fewer samples with its fits on all of them; None where the last one leaves more or less there,
    where it is not adequate on both alike, or where other effects are proven there than on fewer."""
    if staircase.last.verdict == "refused":
        return None
    homes, as_given = {id(None): case}, [record.smooth_drive for record in case.records]
    for few in [staircase.case, *(step.case for step in staircase.steps)]:
        if few is not None and id(few) not in homes:
            whole = quieted(case) if any(record.denoise_drive for record in few.records) else case
            whole = reshaped(whole) if [record.smooth_drive for record in few.records] != as_given else whole
            homes[id(few)] = whole.with_words(few.words).with_specs(few.specs)
            homes[id(few)].shares = few.shares
    home, steps = case, list[stairs.Step]()
    case.shares = thin.shares
    for step in staircase.steps:
        home = homes[id(step.case)] if step.case else home
        fit = on_all(home, step.fit)
        share = explained_share(case, steps[-1].fit, fit) if steps else step.explained
        steps.append(replace(step, fit=fit, explained=share, case=step.case and home))
    first, last = steps[0].fit, steps[-1].fit
    rivals = {step.added: step.tied for step in staircase.steps if step.added}
    few_first, few_last = staircase.steps[0].fit, staircase.steps[-1].fit
    if not holds(case, few_last, last) or adequate(case, first, last) != adequate(thin, few_first, few_last):
        return None
    back = staircase.steps[-1].change == PROVEN  # at once, not from suspect to suspect
    doubted = [] if back else [suspect.effect for suspect in staircase.suspects if isinstance(suspect, Suspect)]
    fullest = steps[-1 - len(doubted)].fit
    if [suspect.effect for suspect in unproven(home, first, fullest, rivals)] != doubted:
        return None
    counts = [sum(record.samples for record in sampled.records) for sampled in (thin, case)]
    sought = f" Effects were sought on {counts[0]:,} of {counts[1]:,} samples; what was found holds on all."
    last_case = homes[id(staircase.case)] if staircase.case else None
    return replace(
        staircase,
        steps=steps,
        last=replace(staircase.last, before=last, reason=staircase.last.reason + sought),
        case=last_case,
    )


def on_all(case: Case, fit: Fit) -> Fit:
    """A fit, gone on with on all samples."""
    problem = case.problem(fit.effects, (), fit.measured_only)
    start = dict(zip(problem.names, problem.physical(np.full(problem.dimensions, 0.5))[0].tolist(), strict=True))
    point = case.descend(problem, problem.unit_point(start | fit.values))
    return refine_steps(case, fit_at(fit.effects, problem, point, fit.converged, fit.measured_only))


def holds(case: Case, fit: Fit, whole: Fit) -> bool:
    """Whether a fit leaves as much on all samples as on fewer."""
    pairs = [(fit.identify, whole.identify), (fit.validate, whole.validate)]
    return all(
        abs(few - every) <= SAME * max(few, every) or abs(few**2 - every**2) ** 0.5 <= SAME_FLOORS * case.floor
        for few, every in pairs
        if few is not None and every is not None
    )
