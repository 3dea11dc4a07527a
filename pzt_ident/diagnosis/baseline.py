"""A fit as effects are scored beside it, in the steps of the simulation that these need."""

from __future__ import annotations

import numpy as np

from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.search.problem import Problem

COARSER, COARSE = (8, 4, 2), 0.01  # times as long steps; of the response, by which they may change it


class Baseline:
    """A model at the point of a fit, in some steps of the simulation, and its residual."""

    def __init__(self, case: Case, fit: Fit, steps: tuple[int, ...]) -> None:
        self.problem = fit.problem if steps == fit.steps else case.problem(fit.effects, steps, fit.measured_only)
        self.steps = steps
        self.followed = self.problem.tangent(fit.point, sampled=True), self.problem.held(fit.point)
        self.residual = self.problem.along(*self.followed).residuals(fit.point)[0]


def coarsest(case: Case, fit: Fit, fine: Baseline) -> Baseline:
    """The model of a fit in the coarsest steps, those of the job at least, that change its response by no more than a
    part of how that varies."""
    given = [record.steps for record in case.records]
    for parts in COARSER:
        steps = tuple(max(least, count // parts) for least, count in zip(given, fit.steps, strict=True))
        if steps != fit.steps:
            baseline = Baseline(case, fit, steps)
            if np.linalg.norm(baseline.residual - fine.residual) < COARSE * stroke(fit.problem):
                return baseline
    return fine


def stroke(problem: Problem) -> float:
    """How the measured responses vary, root mean square, in units of the loss."""
    records = [simulator.record for simulator in problem.simulators["identify"]]
    responses = [record.response[list(record.measured), record.settle :].T / problem.sizes for record in records]
    squares = sum(np.sum(np.var(response, axis=0)) * len(response) for response in responses)
    return float(np.sqrt(squares / problem.scored))
