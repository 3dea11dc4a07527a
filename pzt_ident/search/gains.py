"""The gains of hysteresis operators, and which of them a job keeps where no gain of these data can be."""

from __future__ import annotations

from collections.abc import Iterator

from pzt_ident.model.block import Place
from pzt_ident.model.chain import Entry
from pzt_ident.search.problem import Problem

LITTLE = 0.03  # of what the response moves by over what the drive does: no gain is so small


def free_gains(problem: Problem) -> Iterator[tuple[int, Entry]]:
    """The free gains of hysteresis operators, by their number among the free parameters."""
    for number, column in enumerate(problem.free):
        entry = problem.model.entries[column]
        if entry.block.place == Place.OPERATOR and entry.word == "gain" and entry.parameter.unit == "response/drive":
            yield number, entry


def far_off(problem: Problem) -> Iterator[str]:
    """A sentence on each gain that the job keeps far from what the response moves by."""
    for number, entry in free_gains(problem):
        low, high, unit = problem.lower[number], problem.upper[number], problem.units[number]
        most = problem.declared_bounds(int(problem.free[number]))
        span = max(map(abs, most)) / max(map(abs, entry.parameter.bounds))
        if max(abs(low), abs(high)) < LITTLE * span or min(abs(low), abs(high)) > max(map(abs, most)):
            range_ = f"{low:.4g} to {high:.4g} {unit}"
            moves = f"{span:.4g} {unit}"
            yield f"{entry.name} is {range_} in the job, and the response moves by {moves}: are the units right?"
