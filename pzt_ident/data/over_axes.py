"""Numbers over several axes: what they are called, and what they count."""

from __future__ import annotations

from collections.abc import Mapping

from pzt_ident.data.noise import WHOLE
from pzt_ident.data.notation import listed, percent
from pzt_ident.data.units import of_one_kind


def together(units: Mapping[str, str]) -> str:
    """What stands behind the name of a number that is over all axes, the root mean square of theirs."""
    return f" ({listed(units)} together)" if len(units) > 1 else ""


def weighed(units: Mapping[str, str]) -> list[str]:
    """A sentence on what such a number counts where the responses are of different kinds."""
    if of_one_kind([*units.values()]):
        return []
    least = percent(WHOLE, 1)
    return [f"An RMSE of {listed(units)} together counts each in its noise floor, or in {least} of its span if more."]
