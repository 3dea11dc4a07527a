"""Whether an effect with a loop of its own takes the place of the model's hysteresis operator."""

from __future__ import annotations

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray

from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.modes import values_of
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.block import Place
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks

Array = NDArray[np.float64]

REMAINDER = 1 / 4  # of the operator's loops as given: with less it is displaced
DEGREE = 7  # of the curve that a response without memory may have over its drive
SEEN = 3.0  # noise floors: loops that are narrower say nothing


def displaced_operator(case: Case, first: Fit, now: Fit, effect: str) -> str:
    """The operator of the model whose loops an effect with loops of its own has taken away on all measured axes that
    have any; empty where there is none."""
    if not blocks[effect].loops:
        return ""
    given, left = loop_widths(first), loop_widths(now)
    seen = given > SEEN * case.floors * first.problem.sizes
    names = [block.name for block in operators_of(now).blocks]
    gone = bool(seen.any() and (left < REMAINDER * given)[seen].all())
    return names[0] if names and gone else ""


def loop_widths(fit: Fit) -> Array:
    """What of the response of a fit's operator alone is no function of the drive, root mean square of all records, in
    SI units: (measured axes,)."""
    chain, values = operators_of(fit), values_of(fit)
    theta = np.array([values[name] for name in chain.names])
    squares = []
    for record in fit.problem.records:
        response = Simulator(chain, record).simulate(theta[None])[0]
        drives = record.drive[list(chain.measured)]
        squares.append([beyond_curve(drive, row) for drive, row in zip(drives, response, strict=True)])
    return np.asarray(np.sqrt(np.mean(squares, axis=0)))


def beyond_curve(drive: Array, response: Array) -> float:
    """Mean square of what a polynomial in the drive leaves of a response."""
    if not (span := np.ptp(drive)):
        return 0.0
    powers = chebvander((drive - drive.min()) / span * 2 - 1, DEGREE)
    left = response - powers @ np.linalg.lstsq(powers, response, rcond=None)[0]
    return float(np.mean(left**2))


def operators_of(fit: Fit) -> Chain:
    """The hysteresis operator of a fit and what acts in its equation, without the rest of the chain."""
    model = fit.problem.model
    operators = [block for block in model.blocks if block.place == Place.OPERATOR]
    return Chain((*operators, *model.listed_terms), model.axes, model.measured, [*model.shared], model.names)
