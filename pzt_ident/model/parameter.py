"""A physical quantity, declared once."""

from __future__ import annotations

from dataclasses import dataclass
from math import isclose
from typing import Any, Literal

from pzt_ident.errors import InputError, nearest

SMALL = 0.15  # of an amount: a shape in its limit
NOTHING_BEYOND = "its range ends there"  # what is said of a bound where it does


@dataclass(frozen=True)
class Parameter:
    """A quantity of a block; schema, bounds, report and sensitivities are all derived from this declaration.

    `unit` is written as in a job file. The words `drive` and `response` stand for the units of the axis' channels,
    `first` for the unit of the first response; the bounds of such a parameter are multiples of the peak-to-peak spans
    of the data: `Parameter("response/drive", (0, 2))` of a record over 100 V and 8 um goes from 0 to 0.16 um/V.

    `null` is the value at which the block is exactly the identity; None if there is none.
    `end` is the value at which the range of a shape ends of itself, such as 0 for a spread, or the bound beyond which
    nothing changes, as of a time constant that is far longer than a record, or towards which the block is another form
    of itself, as a filter of third order is one of second; or both; None if there is none.
    `limit` tells what else an effect is whose shape is on its lower bound, or whose amount is on any: "a play".
    `small_to` names the amount of the block of which a shape is at most SMALL in that limit, too.
    `effect` names the effect that the parameter belongs to, or several of its forms; unless the job lists it, the
    parameter stays at its null.
    `count` makes one parameter for each branch of the block, `weight_1`, `weight_2`, ...; a number, or the name of the
    setting that holds it. `per` tells what has a value of its own: every axis, the whole stage, or every axis after the
    first, relative to the first one, which has the null.
    `per_record` gives every record a value of its own, for what starts anew or at another phase in each measurement.
    `value` is the fixed value, unless the job frees the parameter with bounds.
    `linear` has it solved for inside the search, unless the job gives it bounds or a value: the response must be linear
    in all such parameters together; they are not negative, or not positive where the response falls with the drive.
    `adds_to` names the parameter of the block that it is added to, as a payload to the moving mass.
    `smooth` names the parameter that weighs the squared second differences of a counted linear parameter.
    """

    unit: str
    bounds: tuple[float, float]
    doc: str
    null: float | None = None
    scale: Literal["linear", "log"] = "linear"
    effect: str | tuple[str, ...] | None = None
    count: int | str | None = None
    per: Literal["axis", "stage", "later axis"] = "axis"
    per_record: bool = False
    value: float | None = None
    linear: bool = False
    adds_to: str | None = None
    smooth: str | None = None
    end: float | Literal["lower", "upper", "both"] | None = None
    limit: str | None = None
    small_to: str | None = None
    name: str = ""

    def __set_name__(self, owner: type, name: str) -> None:
        object.__setattr__(self, "name", name)

    @property
    def effects(self) -> tuple[str, ...]:
        """The effect that it belongs to, or the forms of it."""
        return (self.effect,) if isinstance(self.effect, str) else self.effect or ()

    @property
    def effect_word(self) -> str:
        """The word of that effect; empty where it belongs to none."""
        return self.effects[0].partition(".")[0] if self.effects else ""

    @property
    def per_later_axis(self) -> bool:
        """Whether every axis but the first has one."""
        return self.per == "later axis"

    def ends_at(self, value: float, bound: Literal["lower", "upper"]) -> bool:
        """Whether a value, on a bound, is the null, or where the range ends of itself: one that rests there rests on no
        bound."""
        numbers = [own for own in (self.null, self.end) if own is not None and not isinstance(own, str)]
        return self.end in (bound, "both") or any(isclose(value, own, rel_tol=1e-5, abs_tol=1e-8) for own in numbers)


@dataclass(frozen=True)
class Setting:
    """A whole number that a job may choose for a block: `{name: rod, elements: 16}`."""

    value: int
    bounds: tuple[int, int]
    doc: str

    def check(self, value: Any, where: str) -> None:
        """Raises InputError unless the value is a whole number within the bounds."""
        low, high = self.bounds
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            remedy = f"give a whole number from {low} to {high}"
            raise InputError(f"{value!r} is not {remedy.removeprefix('give ')}", where=where, remedy=remedy)


@dataclass(frozen=True)
class Form:
    """A form of a block that a job may choose by a word: `{name: homogenized_energy, density: free}`."""

    value: str
    words: tuple[str, ...]
    doc: str

    def check(self, value: Any, where: str) -> None:
        """Raises InputError for an unknown word."""
        if value not in self.words:
            raise InputError(f"{value!r} is no such form", where=where, remedy=nearest(str(value), self.words))
