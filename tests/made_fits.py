"""Fits with given errors, the noise floor being 1."""

from types import SimpleNamespace

import numpy as np

from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import word_of

CASE = SimpleNamespace(floor=1.0, floors=np.ones(1), on_event=lambda event: None, budget=Budget())
FAR = 10.0  # an error that nobody takes for noise


def fit(identify, validate=None, effects=(), dimensions=4, own=(), limit=""):
    """own: places in their ranges of the shapes that its last effect brought along. limit: what it is on their lower
    bounds."""
    columns, block = range(len(own)), SimpleNamespace(name=word_of(effects[-1]) if effects else "")
    entries = [
        SimpleNamespace(parameter=Parameter("1", (0, 1), "", limit=limit), block=block, word=str(i)) for i in columns
    ]
    problem = SimpleNamespace(
        dimensions=dimensions,
        names=[f"own_{i}" for i in columns],
        free=columns,
        model=SimpleNamespace(entries=entries, measured=(), amounts=(), additions=()),
        physical=np.atleast_2d,
        sizes=np.ones(1),
        loss=lambda points: np.array([2 * identify]),
        by_axis=lambda points, use: np.array([[{"identify": identify, "validate": validate}[use]]]),
    )
    return Fit(tuple(effects), problem, np.array(own, float), identify, validate)


def above(left, validate=None):
    """A fit that leaves so much above the noise, root mean square."""
    return fit(np.hypot(1, left), validate)


def without(before, gone):
    """An error of which so much is gone, root mean square; below zero is more."""
    return float(np.sqrt(before**2 - np.sign(gone) * gone**2))
