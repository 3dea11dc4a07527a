"""How much of a response is the step of its simulation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.modes import fastest_mode
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]

IN_A_PERIOD = 2  # finer steps, at least, of the fastest mode: what it rings in half of a longer step is as wrong
MOST = 4  # finer steps in one


def finer_steps(problem: Problem, record: Record, theta: Array) -> int:
    """So many steps per sample that a simulation in them tells what the step of a record costs: half steps, or shorter
    ones where a mode rings in these. theta: SI units, (1, parameters)."""
    values = dict(zip(problem.model.names, theta[0].tolist(), strict=True))
    least = IN_A_PERIOD * fastest_mode(problem.model, values) * record.dt
    return (2 if least <= 2 * record.steps else MOST) * record.steps


def change_in_finer_steps(problem: Problem, record: Record, finer: Record, theta: Array) -> Array:
    """By how much the response to a record changes where it is simulated in the steps of `finer`, root mean square
    beside the mean, SI units: (measured axes,)."""
    simulator = problem.simulator_of(record)
    complete = simulator.amounts.complete(theta)
    change = Simulator(problem.model, finer).simulate(complete) - simulator.simulate(complete)
    return np.asarray(np.std(change[0, :, record.settle :], axis=1))
