"""Which of the records that were kept back can judge a model: not those of which the others leave the response open.

A chirp through a mode that no drive of the identification records makes ring is off by what these do not determine,
with any effect and without.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.notation import listed
from pzt_ident.data.record import Record
from pzt_ident.diagnosis.budget import WHOLE
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import adequate
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.undetermined import mechanics_of

Array = NDArray[np.float64]

FAR_OFF = 2.0  # times the loss of the identification records: what a record leaves that is asked whether it can judge
AS_WELL = 1.1  # of the loss: parameters that fit the identification records as well
OPEN = 0.5  # of the error of a record: what it varies by with such parameters where the others leave it open
DRAWS = 240  # points along the directions of the curvature, each as far as the loss grows little
DRAWS_SOLVED = 60  # the same where each costs a solution for what the response is linear in, or for what was before


def judged(case: Case, fit: Fit, accounts: Iterable[Fit] = ()) -> tuple[Case, Fit]:
    """The case of which only those records judge that can, and the fit in it; as they are where all can. accounts: the
    model with effects; where one leads to the noise, it is at that on all records."""
    led = any(adequate(case, fit, account) for account in accounts)
    open_records = [] if led else left_open(case, fit)
    if not open_records:
        return case, fit
    names = listed([record.name for record in open_records])
    case.caveat = (
        f" Nothing is judged by {names}: the identification records leave open what the model does there. "
        "Give a record like that `use: identify`."
    )
    other = case.with_records([replace(record, judges=record not in open_records) for record in case.records])
    problem = other.problem(fit.effects, fit.steps, fit.measured_only)
    return other, fit_at(fit.effects, problem, fit.point, fit.converged, fit.measured_only)


def left_open(case: Case, fit: Fit) -> list[Record]:
    """The records kept back that are far off, by an error that varies with parameters that fit the others as well."""
    kept = [record for record in case.records if record.use == "validate"]
    errors = errors_by_record(case, fit, kept, fit.point[None])[:, 0]
    limit = FAR_OFF * max(fit.identify, case.floor)
    far = [record for record, error in zip(kept, errors, strict=True) if limit < error < np.inf]
    if not far or not case.budget.allows("which records can judge", WHOLE):
        return []
    errors = errors_by_record(case, fit, far, np.vstack([fit.point, as_good(fit)]))
    spread = np.nan_to_num(errors, nan=np.inf).max(axis=1) - errors.min(axis=1)
    return [record for record, error, each in zip(far, errors[:, 0], spread, strict=True) if each > OPEN * error]


def as_good(fit: Fit) -> Array:
    """(points, dimensions) within the bounds that fit the identification records as well: along the directions of the
    curvature, and with any mechanics, of which a fit may rest on one of many that no record shows."""
    jacobian, _ = fit.problem.equations(fit.point, central=False)
    _, sizes, directions = np.linalg.svd(jacobian, full_matrices=False)
    growth = np.sqrt(AS_WELL**2 - 1) * fit.identify
    lengths = np.minimum(growth / np.maximum(sizes, np.finfo(float).tiny), 1.0)
    rng = np.random.default_rng(0)
    draws = DRAWS_SOLVED if fit.problem.linear.columns.size or fit.problem.model.amounts else DRAWS
    parts, any_place = rng.uniform(-1, 1, size=(draws, lengths.size)), rng.uniform(size=(draws, fit.point.size))
    near = np.clip(fit.point + parts * lengths @ directions, 0, 1)
    points = np.vstack([near, np.where(np.isin(fit.problem.free, [*mechanics_of(fit)]), any_place, fit.point)])
    return points[fit.problem.loss(points) <= AS_WELL * fit.identify]


def errors_by_record(case: Case, fit: Fit, records: Sequence[Record], points: Array) -> Array:
    """RMSE of records of the case in units of the loss: (records, points)."""
    problem, theta = fit.problem, fit.problem.parameters(points)
    simulators = [problem.simulator_of(problem.records[case.records.index(record)]) for record in records]
    squares = [simulator.squares(theta) / simulator.scored / problem.sizes**2 for simulator in simulators]
    return np.sqrt([each.mean(axis=1) for each in squares]).reshape(len(records), len(points))
