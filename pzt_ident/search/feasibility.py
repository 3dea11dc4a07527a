"""Checks of whether a model can be identified from the records; each raises InputError with the reason."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from types import SimpleNamespace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.data.units import factor, same_kind
from pzt_ident.errors import InputError
from pzt_ident.model.block import Place
from pzt_ident.model.chain import Chain
from pzt_ident.search.scales import unit_of

Array = NDArray[np.float64]


class Identification(Protocol):
    """What is checked of a problem: its model, the number of free parameters and their bounds, in the user's units."""

    model: Chain
    linear: Any
    lower: Array
    upper: Array
    all_units: list[str]

    @property
    def dimensions(self) -> int: ...
    def parameters_at(self, values: Array) -> Array: ...
    def range_of(self, column: int) -> tuple[float, float]: ...


CHARGE = ("C", "C/m2")
SMALL, LARGE = 1e-3, 5.0  # of the drive's span: fields between these can be identified from it


def check_units(model: Chain, record: Record) -> None:
    """Raises InputError if a shared parameter has different kinds of units, or mechanics would move a charge."""
    for entry in model.entries:
        units = [unit_of(model, replace(entry, axis=axis), record) for axis in model.measured]
        if f"{entry.block.name}.{entry.word}" in model.shared and not all(
            same_kind(other, units[0]) for other in units
        ):
            message = f"{entry.name} is in {' and in '.join(units)}: no single number fits both"
            remedy = "take it out of `shared`; for one free density of all responses write `density: shared`"
            raise InputError(message, where="shared", remedy=remedy)
    moving = [block.name for block in model.blocks if block.place == Place.MECHANICS]
    for axis in model.measured:
        response_unit = record.response_units[axis]
        if moving and any(same_kind(str(response_unit), unit_of_charge) for unit_of_charge in CHARGE):
            message = (
                f"{moving[0]!r} moves a displacement, but the response of axis {model.axes[axis]} is in {response_unit}"
            )
            remedy = "fit charge and polarization without mechanics, on drives that are slow for it"
            raise InputError(message, where="model", remedy=remedy)


def check_feasible(problem: Identification, identify: list[Record]) -> None:
    """Raises InputError if the identification records are too short, their drive cannot identify a parameter, or a
    block refuses its bounds."""
    check_lengths(problem, identify)
    check_bounds(problem)
    check_drive(problem, identify)


def check_lengths(problem: Identification, identify: list[Record]) -> None:
    """Raises InputError if an identification record has no more scored samples than there are free parameters."""
    free = problem.dimensions + problem.linear.columns.size
    for record in identify:
        scored = record.samples - record.settle
        if scored <= free:
            raise InputError(
                f"{scored} scored samples for {free} free parameters",
                where=record.file or record.name,
                remedy="give a longer record, a shorter `settle`, or fix parameters",
            )


def check_bounds(problem: Identification) -> None:
    """Raises InputError if a block refuses the bounds of its parameters."""
    least, most = (problem.parameters_at(bounds) for bounds in (problem.lower, problem.upper))
    for block, axis in product(problem.model.blocks, problem.model.measured):
        if refuse := getattr(block, "refuse", None):
            columns = problem.model.columns(block, axis, axis) or {}
            refuse(*(SimpleNamespace(**{word: end[c] for word, c in columns.items()}) for end in (least, most)))


def check_drive(problem: Identification, identify: list[Record]) -> None:
    """Raises InputError if the span of the drive is far outside the bounds of a field: one of them has another unit,
    such as V for V/m, or the drive never leaves the linear range."""
    for column, entry in enumerate(problem.model.entries):
        if entry.word in entry.block.compared_with_drive:
            unit = problem.all_units[column]
            low, high = problem.range_of(column)
            span = max(record.spans[entry.axis] for record in identify) / factor(unit)
            if not SMALL * span < high or not low < LARGE * span:
                raise _out_of_reach(entry.name, unit, low, high, span)


def _out_of_reach(name: str, unit: str, low: float, high: float, span: float) -> InputError:
    consequence = "nothing switches: the response is linear" if low > span else "everything switches at once"
    bound = f"at least {low:g} {unit}" if low > span else f"at most {high:g} {unit}"
    message = f"is {bound} beside a drive of {span:.3g} {unit} peak to peak, so {consequence}"
    remedy = (
        "are they in the same unit? A drive in volts over 20 mm has the unit `50 V/m`. Otherwise use a larger drive, "
        "or give the parameter bounds of the size of the drive"
    )
    return InputError(message, where=name, remedy=remedy)
