"""What cannot be, given what kinds of quantities the axes measure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from pzt_ident.data.record import Record
from pzt_ident.data.units import same_kind
from pzt_ident.errors import InputError
from pzt_ident.model.block import Place
from pzt_ident.model.chain import Chain, Entry

CHARGE = ("C", "C/m2")
Unit = Callable[[Entry, Record], str]


def agree(model: Chain, record: Record, unit: Unit) -> None:
    """Raises InputError where one number would be of another kind on every axis, or mechanics would move a charge.

    unit: that of a parameter, as the user writes it.
    """
    for entry in model.entries:
        units = [unit(replace(entry, axis=axis), record) for axis in model.measured]
        if f"{entry.block.name}.{entry.word}" in model.shared and not all(same_kind(each, units[0]) for each in units):
            said = f"{entry.name} is in {' and in '.join(units)}: no one number is both"
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
