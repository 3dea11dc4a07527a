"""A step of the staircase."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.misfit import share_explained


@dataclass
class Step:
    """A step of the staircase: the fit after it, the effect it added or removed, the look-alikes that these data cannot
    distinguish from it with their fits (itself first), the shares of the misfit it removed and was expected to, what
    else it changed, and the case that it goes on in where that has wider bounds."""

    fit: Fit
    added: str | None = None
    removed: str | None = None
    rivals: dict[str, Fit] = field(default_factory=dict)
    explained: float = 0.0
    expected: float | None = None
    change: str = ""
    case: Case | None = None

    @property
    def tied(self) -> tuple[str, ...]:
        return tuple(self.rivals)


class Doubt(Protocol):
    """What takes up a share of the misfit and is not in the last model, and a sentence on why."""

    @property
    def effect(self) -> str: ...
    @property
    def share(self) -> float: ...
    @property
    def why_not(self) -> str: ...


StepListener = Callable[[Step], None]


def explained_share(case: Case, before: Fit, after: Fit) -> float:
    """Share of the misfit on the identification records that a step removes."""
    return share_explained(before.identify, after.identify, case.floor)


def effects_without(fit: Fit, effect: str) -> tuple[str, ...]:
    return tuple(word for word in fit.effects if word != effect)
