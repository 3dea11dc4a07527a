"""The checks of an optimizer; called by `contract.check`."""

from __future__ import annotations

import inspect
from dataclasses import MISSING, fields
from typing import Any

from pzt_ident.errors import InputError, nearest
from pzt_ident.model.contract.declared import check_docstring, fault, ordered

WANTS = ("losses", "residuals")
BUDGET = 1000


def check_optimizer(item: Any) -> None:
    """Raises InputError for a faulty optimizer. It is built with its default settings; no candidate is evaluated."""
    if not any(base.__name__ == "Optimizer" for base in item.__mro__):
        remedy = "derive it from Optimizer, Generational or Budgeted of pzt_ident.model.optimizer"
        raise InputError("is no optimizer", where=item.__name__, remedy=remedy)
    for word in sorted(item.__abstractmethods__):
        raise fault(item, word, f"has no `{word}`", f"write it, see `{word}` of pzt_ident.model.optimizer.Optimizer")
    dataclass_options = vars(item).get("__dataclass_params__")
    if dataclass_options is None or not dataclass_options.frozen:
        raise fault(item, "", "is no frozen dataclass", "write `@dataclass(frozen=True)` under `@optimizers.register`")
    check_docstring(item)
    if item.wants not in WANTS:
        raise fault(item, "wants", f"unknown {item.wants!r}", nearest(str(item.wants), WANTS))
    if not isinstance(item.convergent, bool):
        raise fault(item, "convergent", f"{item.convergent!r} is no yes or no", "write True or False")
    for setting in fields(item):
        _check_field(item, setting)
    _check_budget(item, _call(item, "", item))
    _check_search(item, item())


def _check_field(item: Any, setting: Any) -> None:
    if setting.default is MISSING or not {"bounds", "words"} & set(setting.metadata):
        remedy = f"write `{setting.name}: float = setting(...)`, or `choice(...)` for a word"
        raise fault(item, setting.name, "is made by neither `setting` nor `choice`", remedy)
    bounds, words = setting.metadata.get("bounds", (0, 1)), setting.metadata.get("words", ())
    if not ordered(bounds) or not isinstance(words, tuple):
        raise fault(
            item, setting.name, f"{words or bounds!r} is no range or tuple", "give (least, most), or all the words"
        )


def _check_budget(item: Any, optimizer: Any) -> None:
    if not isinstance(optimizer.evaluations, int) or optimizer.evaluations < 1:
        message = f"is {optimizer.evaluations!r}, no whole number"
        raise fault(item, "evaluations", message, "give the budget as a property")
    again = _call(item, "with_budget", optimizer.with_budget, BUDGET)
    if not isinstance(again, item) or again.evaluations < BUDGET:
        message = f"gives {again!r} for a budget of {BUDGET} evaluations"
        raise fault(item, "with_budget", message, "give the same settings for at least so many, by dataclasses.replace")


def _check_search(item: Any, optimizer: Any) -> None:
    import numpy as np

    generator = _call(item, "search", optimizer.search, 2, np.random.default_rng(0))
    if not inspect.isgenerator(generator):
        message = f"gives {type(generator).__name__}, no generator"
        raise fault(item, "search", message, "yield candidates (M, P) and take their losses: `losses = yield points`")
    generator.close()


def _call(item: Any, where: str, function: Any, *arguments: Any) -> Any:
    try:
        return function(*arguments)
    except InputError as error:
        raise fault(item, error.where.rpartition(".")[2], error.message, error.remedy) from None
    except Exception as error:
        message = f"raises {type(error).__name__}: {error}"
        raise fault(item, where, message, "it is called with the default settings") from error
