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
    """Where the `time` and, by axis, the drives and responses (`axes`) stand in the files of the records."""

    axes: dict[str, Axis]
    time: Channel | None = None


@dataclass(frozen=True)
class Setting:
    """`bounds` free a parameter, a `value` fixes it: one of the two, in the user's units."""

    bounds: tuple[float, float] | None = None
    value: float | None = None


@dataclass(frozen=True)
class Choice:
    """An optimizer or block by its `name`, its `settings` as keys beside that: `{name: rod, elements: 12}`."""

    name: str
    settings: dict[str, Any] = field(default_factory=dict)


def _kind(item: object) -> str:
    return "word" if not isinstance(item, (dict, Choice)) else "choice"


Item = Annotated[Annotated[str, Tag("word")] | Annotated[Choice, Tag("choice")], Discriminator(_kind)]
"""A block: its word, alone or with settings."""


@dataclass(frozen=True)
class Quantity:
    """A value in a unit, or in the unit of the response where none is given: `0.05 um`."""

    value: Positive
    unit: str | None = None


@dataclass(frozen=True)
class Stopping:
    """When a search ends, whichever comes first: evaluations, seconds of wall time, the RMSE reached (target), or
    generations without progress (stagnation)."""

    evaluations: Count | None = None
    seconds: Positive | None = None
    target: Quantity | None = None
    stagnation: Count | None = None


@dataclass(frozen=True)
class Limits:
    """What a proposed drive may do, in the user's units: lowest and highest drive, its rate per second (slew), and its
    duration in s."""

    drive: tuple[float, float] | None = None
    slew: Positive | None = None
    duration: Positive | None = None
