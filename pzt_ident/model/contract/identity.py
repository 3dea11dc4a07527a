"""Calls the functions of an effect with its parameters at their nulls, where it must change nothing."""

from __future__ import annotations

from typing import Any

from pzt_ident.model.contract.declared import fault, parameters
from pzt_ident.model.contract.functions import arguments_of, call_function, example
from pzt_ident.model.contract.kinds import kind_of

DRIVE = (0.25, 0.5, -1.0, 1.0, 1.0, 0.125)


def check_identity(block: Any) -> None:
    """Raises InputError for an effect that changes its input although its parameters are at their nulls.

    Only the kinds whose `step` gives the sample behind them: block, beside and coupling.
    """
    nulls = {word: item.null for word, item in parameters(block).items() if item.null is not None}
    kind = kind_of(block)
    if not block.remedy or kind not in ("block", "beside", "coupling"):
        return
    known = example(block) | nulls
    coefficients = call_function(block, "prepare", *(known[name] for name in arguments_of(block, "prepare")))
    states = call_function(block, "start", DRIVE[0], *((0.75 * DRIVE[0],) if kind == "coupling" else ()), *coefficients)
    for sample in DRIVE:
        beside = () if kind == "block" else (0.75 * sample,)
        result = call_function(block, "step", *states, sample, *beside, *coefficients)
        *states, response = result if isinstance(result, tuple) else (result,)
        if response != sample:
            at_null = " and ".join(f"{word} = {null:g}" for word, null in nulls.items())
            message = f"gives {response!r} for {sample!r} with {at_null}: an effect at its null must change nothing"
            raise fault(block, "step", message, "return the input as it is there, to the last digit")
