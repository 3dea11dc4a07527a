"""Numbers over several axes: how they are labelled, and how they are weighted."""

from __future__ import annotations

from collections.abc import Mapping

from pzt_ident.data.noise import LEAST_SCALE
from pzt_ident.data.notation import listed, percent
from pzt_ident.data.units import of_one_kind

USE_NAMES = {"identify": "identification", "validate": "validation"}


def over_uses(errors: Mapping[str, str]) -> str:
    """Errors by use in words: `0.12 um on the identification records, 0.15 um on the validation records`."""
    return ", ".join(f"{error} on the {USE_NAMES[use]} records" for use, error in errors.items())


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
