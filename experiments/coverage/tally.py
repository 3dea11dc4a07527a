"""How often the truth lies in the interval, with its own uncertainty."""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np

from experiments.coverage.campaign import COLOURS
from experiments.tables import table

Row = dict[str, Any]
WITHIN = 1.96


def text(found: list[Row]) -> str:
    header = ["95 % intervals that hold the truth", *COLOURS]
    chosen = [[row for row in found if row["colour"] == colour] for colour in COLOURS]
    names = list(found[0]["errors"])
    lines = [[name, *(share([row["errors"][name] for row in rows]) for rows in chosen)] for name in names]
    lines.append(["all parameters", *(pooled(rows) for rows in chosen)])
    lines.append(["displacement, unseen record", *(mean([row["inside"] for row in rows]) for rows in chosen)])
    lines.append(["scatter of errors, in standard errors", *(f"{scatter(rows):.2f}" for rows in chosen)])
    lines.append(["campaigns", *(str(len(rows)) for rows in chosen)])
    return table(header, lines)


def share(errors: list[float | None]) -> str:
    """Of those that are determined, with the standard deviation of a binomial share."""
    told = np.array([error for error in errors if error is not None])
    p = float(np.mean(np.abs(told) <= WITHIN))
    missing = f", {len(errors) - told.size} not determined" if told.size < len(errors) else ""
    return f"{100 * p:.1f} +- {100 * sqrt(p * (1 - p) / told.size):.1f} %{missing}"


def pooled(rows: list[Row]) -> str:
    """The parameters of a campaign are not independent: the uncertainty is that of the mean over campaigns."""
    each = [[abs(e) <= WITHIN for e in row["errors"].values() if e is not None] for row in rows]
    return mean([float(np.mean(inside)) for inside in each])


def mean(values: list[float]) -> str:
    return f"{100 * np.mean(values):.1f} +- {100 * np.std(values) / sqrt(len(values)):.1f} %"


def scatter(rows: list[Row]) -> float:
    """1 where the standard errors are right."""
    told = [e for row in rows for e in row["errors"].values() if e is not None]
    return float(np.sqrt(np.mean(np.square(told))))
