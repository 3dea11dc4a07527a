"""What an optimizer owes the search; `contract.check` is how it is asked."""

from __future__ import annotations

import inspect
from dataclasses import MISSING, fields
from typing import Any

from pzt_ident.errors import InputError, nearest
from pzt_ident.model.contract.declared import check_docstring, fault, ordered

WANTS = ("losses", "residuals")
BUDGET = 1000


def check_optimizer(item: Any) -> None:
    """Raises InputError for what cannot be searched with. One with its default settings is made, no candidate tried."""
    if not any(base.__name__ == "Optimizer" for base in item.__mro__):
        remedy = "derive it from Optimizer, Generational or Budgeted of pzt_ident.search.loop"
        raise InputError("is no optimizer", where=item.__name__, remedy=remedy)
    for word in sorted(item.__abstractmethods__):
        raise fault(item, word, f"has no `{word}`", f"write it, see `{word}` of pzt_ident.search.loop.Optimizer")
    made = vars(item).get("__dataclass_params__")
    if made is None or not made.frozen:
        raise fault(item, "", "is no frozen dataclass", "write `@dataclass(frozen=True)` under `@optimizers.register`")
    check_docstring(item)
    if item.wants not in WANTS:
        raise fault(item, "wants", f"unknown {item.wants!r}", nearest(str(item.wants), WANTS))
    if not isinstance(item.convergent, bool):
        raise fault(item, "convergent", f"{item.convergent!r} is no yes or no", "write True or False")
    for one in fields(item):
        _check_field(item, one)
    _check_budget(item, _tried(item, "", item))
    _check_search(item, item())


def _check_field(item: Any, one: Any) -> None:
    if one.default is MISSING or not {"bounds", "words"} & set(one.metadata):
        remedy = f"write `{one.name}: float = setting(...)`, or `choice(...)` for a word"
        raise fault(item, one.name, "is made by neither `setting` nor `choice`", remedy)
    bounds, words = one.metadata.get("bounds", (0, 1)), one.metadata.get("words", ())
    if not ordered(bounds) or not isinstance(words, tuple):
        raise fault(item, one.name, f"{words or bounds!r} is no range or tuple", "give (least, most), or all the words")


def _check_budget(item: Any, made: Any) -> None:
    if not isinstance(made.evaluations, int) or made.evaluations < 1:
        said = f"is {made.evaluations!r}, no whole number"
        raise fault(item, "evaluations", said, "give the budget as a property")
    again = _tried(item, "with_budget", made.with_budget, BUDGET)
    if not isinstance(again, item) or again.evaluations < BUDGET:
        said = f"gives {again!r} for a budget of {BUDGET} evaluations"
        raise fault(item, "with_budget", said, "give the same settings for at least so many, by dataclasses.replace")


def _check_search(item: Any, made: Any) -> None:
    import numpy as np

    found = _tried(item, "search", made.search, 2, np.random.default_rng(0))
    if not inspect.isgenerator(found):
        said = f"gives {type(found).__name__}, no generator"
        raise fault(item, "search", said, "yield candidates (M, P) and take their losses: `losses = yield points`")
    found.close()


def _tried(item: Any, where: str, function: Any, *arguments: Any) -> Any:
    try:
        return function(*arguments)
    except InputError as error:
        raise fault(item, error.where.rpartition(".")[2], error.message, error.remedy) from None
    except Exception as error:
        said = f"raises {type(error).__name__}: {error}"
        raise fault(item, where, said, "it is called with the default settings") from error
