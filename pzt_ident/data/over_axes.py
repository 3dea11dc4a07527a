"""Numbers over several axes: how they are labelled, and how they are weighted."""

from __future__ import annotations

from collections.abc import Mapping

from pzt_ident.data.noise import LEAST_SCALE
from pzt_ident.data.notation import listed, percent
from pzt_ident.data.units import of_one_kind


def together(units: Mapping[str, str]) -> str:
    """The suffix to the name of a number that is the root mean square over all axes."""
    return f" ({listed(units)} together)" if len(units) > 1 else ""


def weighed(units: Mapping[str, str]) -> list[str]:
    """A sentence on the weights of the axes in such a number where the responses are of different kinds."""
    if of_one_kind([*units.values()]):
        return []
    least = percent(LEAST_SCALE, 1)
    names = listed(units)
    return [
        f"An RMSE of {names} together weights each by its noise floor, or by {least} of its span where that is more."
    ]
