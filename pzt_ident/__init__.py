"""Identify hysteresis models of piezo stages, see where they fail and which physical effect is missing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pzt_ident.api import (
        Diagnosis,
        Fit,
        Fleet,
        Improvement,
        InputError,
        Model,
        NextExperiment,
        Parameter,
        Record,
        RunError,
        diagnose,
        fleet,
        identify,
        improve,
        load,
        minimize,
    )

__version__ = "0.1.0"
__all__ = [
    "Diagnosis",
    "Fit",
    "Fleet",
    "Improvement",
    "InputError",
    "Model",
    "NextExperiment",
    "Parameter",
    "Record",
    "RunError",
    "diagnose",
    "fleet",
    "identify",
    "improve",
    "load",
    "minimize",
]


def __getattr__(name: str) -> Any:
    """What users import comes when it is asked for: `pzt-ident --help` needs none of it."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from pzt_ident import api

    return getattr(api, name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
