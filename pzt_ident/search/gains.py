"""The gains of hysteresis operators, and what a job keeps far from what these data or the catalogue expect."""

from __future__ import annotations

from collections.abc import Iterator

from pzt_ident.model.block import Place
from pzt_ident.model.chain import Entry
from pzt_ident.search.problem import Problem

FAR = 2.0  # times the bounds that are declared
LITTLE = 0.03  # of what the response moves by over what the drive does: no gain is so small


def free_gains(problem: Problem) -> Iterator[tuple[int, Entry]]:
    """The free gains of hysteresis operators, by their number among the free parameters."""
    for number, column in enumerate(problem.free):
        entry = problem.model.entries[column]
        if entry.block.place == Place.OPERATOR and entry.word == "gain" and entry.parameter.unit == "response/drive":
            yield number, entry


def far_off(problem: Problem) -> Iterator[str]:
    """A sentence on each gain that the job keeps far from what the response moves by, and on all else that it keeps far
    beyond the bounds that are declared."""
    gains = {problem.free[number] for number, _ in free_gains(problem)}
    yield from (
        text for column in range(len(problem.theta)) if column not in gains and (text := beyond(problem, column))
    )
    for number, entry in free_gains(problem):
        low, high, unit = problem.lower[number], problem.upper[number], problem.units[number]
        most = problem.declared_bounds(int(problem.free[number]))
        span = max(map(abs, most)) / max(map(abs, entry.parameter.bounds))
        least = 0.0 if low < 0 < high else min(abs(low), abs(high))
        if max(abs(low), abs(high)) < LITTLE * span or least > max(map(abs, most)):
            range_ = f"{low:.4g} to {high:.4g} {unit}"
            moves = f"{span:.4g} {unit}"
            yield f"{entry.name} is {range_} in the job, and the response moves by {moves}: are the units right?"


def beyond(problem: Problem, column: int) -> str:
    """A sentence on a parameter that the job keeps far beyond the bounds that are declared; else empty."""
    unit = problem.all_units[column]
    if column in problem.linear_columns or unit == "1":
        return ""
    (low, high), (least, most) = problem.range_of(column), problem.declared_bounds(column)
    far_below = high < (FAR * least if least < 0 else least / FAR)
    far_above = low > (FAR * most if most > 0 else most / FAR)
    if not far_below and not far_above:
        return ""
    name = problem.model.entries[column].name
    range_ = f"{low:.4g} {unit}" if low == high else f"{low:.4g} to {high:.4g} {unit}"
    return f"{name} is {range_} in the job, and usual is {least:.4g} to {most:.4g} {unit}: are the units right?"
