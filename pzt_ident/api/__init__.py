"""The package as a library, on the functions that the commands call.

In: arrays, frames or files, the words of a model. Out: fits, diagnoses and staircases that print and draw themselves.
"""

from pzt_ident.api.diagnosis import Diagnosis, Improvement, NextExperiment, diagnose, improve
from pzt_ident.api.fit import Fit
from pzt_ident.api.fitted import Parameter
from pzt_ident.api.fleet import Fleet, fleet
from pzt_ident.api.identification import identify, load
from pzt_ident.api.model import Model
from pzt_ident.api.record import Record
from pzt_ident.errors import InputError, RunError
from pzt_ident.search.loop import minimize

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
