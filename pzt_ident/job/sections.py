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
    """Where signals stand in the files of the records.

    axes: drives and responses, by the name of the axis. time: not needed where the job gives a `sample_rate`.
    """

    axes: dict[str, Axis]
    time: Channel | None = None


@dataclass(frozen=True)
class Setting:
    """What is known of a parameter, in the units of the files; without either it is searched within declared bounds.

    bounds: between which it is searched. value: at which it is fixed instead.
    """

    bounds: tuple[float, float] | None = None
    value: float | None = None


@dataclass(frozen=True)
class Choice:
    """An optimizer or block and what is set of it: `{name: rod, elements: 12}`.

    name: its word. settings: as keys beside that.
    """

    name: str
    settings: dict[str, Any] = field(default_factory=dict)


def _kind(item: object) -> str:
    return "word" if not isinstance(item, (dict, Choice)) else "choice"


Item = Annotated[Annotated[str, Tag("word")] | Annotated[Choice, Tag("choice")], Discriminator(_kind)]
"""A block: its word, alone or with settings."""


@dataclass(frozen=True)
class Quantity:
    """A value in a unit: `0.05 um`.

    value: a number above zero. unit: by default that of the response.
    """

    value: Positive
    unit: str | None = None


@dataclass(frozen=True)
class Stopping:
    """When a search ends, whichever comes first.

    evaluations: how often the model is evaluated. seconds: wall time. target: the RMSE that is reached. stagnation:
    generations without progress.
    """

    evaluations: Count | None = None
    seconds: Positive | None = None
    target: Quantity | None = None
    stagnation: Count | None = None


@dataclass(frozen=True)
class Limits:
    """What a proposed drive may do, in the user's units.

    drive: the lowest and the highest. slew: the largest change per second. duration: how long it may last, s.
    """

    drive: tuple[float, float] | None = None
    slew: Positive | None = None
    duration: Positive | None = None
