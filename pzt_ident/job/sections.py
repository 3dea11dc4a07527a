"""The sections of a job, except its records."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Any

from pydantic import Discriminator, Field, Tag

from pzt_ident.data.record import Axis, Channel

Positive = Annotated[float, Field(gt=0)]
Count = Annotated[int, Field(ge=1)]
Repeats = Annotated[int, Field(ge=1, le=1000)]


@dataclass(frozen=True)
class Channels:
    """Where time, drives and responses stand in the files of the records."""

    axes: dict[str, Axis]
    time: Channel | None = None


@dataclass(frozen=True)
class Setting:
    """Bounds free a parameter, a value fixes it: one of the two, in the user's units."""

    bounds: tuple[float, float] | None = None
    value: float | None = None


@dataclass(frozen=True)
class Choice:
    """An optimizer or block by name, with its settings."""

    name: str
    settings: dict[str, Any] = field(default_factory=dict)


def _kind(item: object) -> str:
    return "word" if not isinstance(item, (dict, Choice)) else "choice"


Item = Annotated[Annotated[str, Tag("word")] | Annotated[Choice, Tag("choice")], Discriminator(_kind)]
"""A block: its word, alone or with settings."""


@dataclass(frozen=True)
class Quantity:
    """A value in a unit, or in the unit of the response where none is given."""

    value: Positive
    unit: str | None = None


@dataclass(frozen=True)
class Stopping:
    """When a search ends, whichever comes first: evaluations, wall time, RMSE reached, generations without progress."""

    evaluations: Count | None = None
    seconds: Positive | None = None
    target: Quantity | None = None
    stagnation: Count | None = None


@dataclass(frozen=True)
class Limits:
    """What a proposed drive may do, in the user's units: lowest and highest drive, its rate per second, length in s."""

    drive: tuple[float, float] | None = None
    slew: Positive | None = None
    duration: Positive | None = None
