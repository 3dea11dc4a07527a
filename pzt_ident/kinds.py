"""What cannot be, given what kinds of quantities the axes measure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from pzt_ident.block import Place
from pzt_ident.errors import InputError
from pzt_ident.model import Model, Slot
from pzt_ident.record import Record
from pzt_ident.units import same_kind

CHARGE = ("C", "C/m2")
Unit = Callable[[Slot, Record], str]


def agree(model: Model, record: Record, unit: Unit) -> None:
    """Raises InputError where one number would be of another kind on every axis, or mechanics would move a charge.

    unit: that of a parameter, as the user writes it.
    """
    for slot in model.slots:
        units = [unit(replace(slot, axis=axis), record) for axis in model.measured]
        if f"{slot.block.name}.{slot.word}" in model.shared and not all(same_kind(each, units[0]) for each in units):
            said = f"{slot.name} is in {' and in '.join(units)}: no one number is both"
            remedy = "take it out of `shared`; free densities of all responses are one with `density: shared`"
            raise InputError(said, where="shared", remedy=remedy)
    moving = [block.name for block in model.blocks if block.place == Place.MECHANICS]
    for axis in model.measured:
        own = record.response_units[axis]
        if moving and any(same_kind(str(own), each) for each in CHARGE):
            said = (
                f"{moving[0]!r} would move the response of axis {model.axes[axis]}, which is in {own}: no displacement"
            )
            remedy = "fit charge and polarization without mechanics, on drives that are slow for it"
            raise InputError(said, where="model", remedy=remedy)
