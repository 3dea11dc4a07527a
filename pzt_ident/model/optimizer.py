"""What an author of an optimizer writes: typed settings and one generator over the unit cube."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Generator
from dataclasses import dataclass, field, fields, replace
from typing import Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray

from pzt_ident.errors import InputError, nearest

Array = NDArray[np.float64]
Search = Generator[Array, Array, None]


def setting(default: Any, unit: str, bounds: tuple[float, float], doc: str) -> Any:
    """Declare a setting that is a number; bounds are inclusive."""
    return field(default=default, metadata={"unit": unit, "bounds": bounds, "doc": doc})


def choice(default: str, words: tuple[str, ...], doc: str) -> Any:
    """Declare a setting that is one of a few words."""
    return field(default=default, metadata={"unit": "", "words": words, "doc": doc})


@dataclass(frozen=True)
class Optimizer(ABC):
    """Typed settings and one generator. A subclass is a frozen dataclass with fields from `setting` or `choice`.

    `wants`: with "residuals" it is sent residuals (M, N) if the problem has them, otherwise losses (M,). Those of one
    batch may be rotated together, so that N is small: only they may be subtracted from each other.
    `convergent`: its steps shrink towards an optimum, so that within 6000 evaluations it finds the minimum of |x - c|^2
    in 4 dimensions to 1e-4; others to 1e-2.
    Raises InputError for a setting of the wrong type or out of its bounds.
    """

    name: ClassVar[str] = ""
    source: ClassVar[str] = ""
    wants: ClassVar[Literal["losses", "residuals"]] = "losses"
    convergent: ClassVar[bool] = True

    @property
    @abstractmethod
    def evaluations(self) -> int:
        """The number of evaluations that these settings allow."""

    @abstractmethod
    def search(self, dimensions: int, rng: np.random.Generator) -> Search:
        """Yield candidates (M, P) in [0, 1] and be sent their losses (M,), inf for a failed one, until closed: the loop
        ends a search, and `evaluations` is only its budget."""

    @abstractmethod
    def with_budget(self, evaluations: int) -> Self:
        """The same settings for a budget of at least this many evaluations."""

    @classmethod
    def make(cls, **settings: Any) -> Self:
        """The constructor, which for an unknown setting raises InputError with the nearest words."""
        known = [item.name for item in fields(cls)]
        for word in settings:
            if word not in known:
                raise InputError(f"unknown setting {word!r}", where=cls.name, remedy=nearest(word, known))
        return cls(**settings)

    def __post_init__(self) -> None:
        for item in fields(self):
            _check(getattr(self, item.name), item.default, item.metadata, f"{self.name}.{item.name}")


@dataclass(frozen=True)
class Generational(Optimizer):
    """An optimizer whose budget is a number of generations of one population."""

    population: int = setting(70, "1", (4, 100_000), "Candidates in a generation.")
    generations: int = setting(250, "1", (1, 10_000_000), "The budget is this many times the population.")

    @property
    def evaluations(self) -> int:
        return self.population * self.generations

    def with_budget(self, evaluations: int) -> Self:
        return replace(self, generations=math.ceil(evaluations / self.population))


@dataclass(frozen=True)
class Budgeted(Optimizer):
    """An optimizer whose generations differ in size."""

    budget: int = setting(17_500, "1", (1, 1_000_000_000), "Evaluations.")

    @property
    def evaluations(self) -> int:
        return self.budget

    def with_budget(self, evaluations: int) -> Self:
        return replace(self, budget=evaluations)


def _check(value: Any, default: Any, facts: Any, where: str) -> None:
    if "words" in facts:
        if value not in facts["words"]:
            raise InputError(f"unknown word {value!r}", where=where, remedy=nearest(str(value), facts["words"]))
        return
    kinds = (int, np.integer) if isinstance(default, int) else (int, float, np.integer, np.floating)
    low, high = facts["bounds"]
    if isinstance(value, bool) or not isinstance(value, kinds):
        kind = "a whole number" if isinstance(default, int) else "a number"
        raise InputError(f"{value!r} is not {kind}", where=where, remedy=f"give {kind} from {low:g} to {high:g}")
    if not low <= value <= high:
        raise InputError(f"{value!r} is out of bounds", where=where, remedy=f"give a value from {low:g} to {high:g}")
