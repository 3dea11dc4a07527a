"""A physical quantity, declared once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from pzt_ident.errors import InputError, nearest


@dataclass(frozen=True)
class Parameter:
    """A quantity of a block: everything else (bounds, schema, report, sensitivities) is derived from this.

    `unit` is written as in a job file. The words `drive` and `response` stand for the units of the axis' own
    channels, `first` for that of the first response, and the bounds of such a parameter are multiples of the data's own
    spans: `Parameter("response/drive", (0, 2))` of a record over 100 V and 8 um goes from 0 to 0.16 um/V.

    `null` is the value at which the block is exactly the identity; None where there is none.
    `effect` names the effect that the parameter belongs to; unless the job lists it, the parameter stays at its null.
    `count` makes a parameter one of each branch of the block, `weight_1`, `weight_2`, ...; where a job chooses how
    many, it is the setting's name. `each` says who has one of its own: every axis, the stage as a whole, or every axis
    after the first, to which it is relative and which has the null.
    `per_record` gives every record one of its own, for what begins anew or at another phase with each measurement.
    `value` is what it is fixed to unless the job frees it with bounds.
    `linear` has it solved for inside the search where the job says nothing of it: the response must be linear in all
    such parameters together, and they are not negative, or not positive where the response falls with the drive.
    `smooth` names the parameter that weighs the squared second differences of a counted one of these.
    """

    unit: str
    bounds: tuple[float, float]
    doc: str
    null: float | None = None
    scale: Literal["linear", "log"] = "linear"
    effect: str | None = None
    count: int | str | None = None
    each: Literal["axis", "stage", "later axis"] = "axis"
    per_record: bool = False
    value: float | None = None
    linear: bool = False
    smooth: str | None = None
    name: str = ""

    def __set_name__(self, owner: type, name: str) -> None:
        object.__setattr__(self, "name", name)


@dataclass(frozen=True)
class Setting:
    """What a job chooses of how a block is built, a whole number: `{name: rod, elements: 16}`."""

    value: int
    bounds: tuple[int, int]
    doc: str

    def check(self, value: Any, where: str) -> None:
        """Raises InputError for what is not a whole number within the bounds."""
        low, high = self.bounds
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            remedy = f"give a whole number from {low} to {high}"
            raise InputError(f"{value!r} is not {remedy.removeprefix('give ')}", where=where, remedy=remedy)


@dataclass(frozen=True)
class Form:
    """Which of its forms a job chooses of a block, by a word: `{name: homogenized_energy, density: free}`."""

    value: str
    words: tuple[str, ...]
    doc: str

    def check(self, value: Any, where: str) -> None:
        """Raises InputError for another word."""
        if value not in self.words:
            raise InputError(f"{value!r} is no such form", where=where, remedy=nearest(str(value), self.words))
