"""How much of a response is the step of its simulation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.engine.simulator import Simulator
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]


def change_by_halving(problem: Problem, record: Record, finer: Record, theta: Array) -> Array:
    """By how much the response to a record changes where it is simulated in half steps, `finer`, root mean square
    beside the mean, SI units: (measured axes,)."""
    simulator = problem.simulator_of(record)
    complete = simulator.amounts.complete(theta)
    change = Simulator(problem.model, finer).simulate(complete) - simulator.simulate(complete)
    return np.asarray(np.std(change[0, :, record.settle :], axis=1))
