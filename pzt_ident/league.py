"""Optimizers side by side: their own results, before any polish, at equal evaluations."""

from __future__ import annotations

from typing import Any

import numpy as np

NEAR = 1.01  # of the best RMSE that any run found


def compare(runs: list[dict[str, Any]], histories: dict[str, np.ndarray]) -> list[dict[str, Any]]:
    """One row an optimizer, best first, and in each run the evaluations after which it was within one percent.

    histories: (generations, 3) of evaluations, seconds, best RMSE, by run. Success is the share of runs within one
    percent of the best RMSE found by any run, polished or not.
    """
    best = min(min(run["rmse"]["identify"], run["rmse_before_polish"]["identify"]) for run in runs)
    for run in runs:
        evaluations, _, losses = histories[run["run"]].T
        near = np.flatnonzero(losses <= NEAR * best)
        run["evaluations_to_1_percent"] = int(evaluations[near[0]]) if near.size else None
    rows = [
        row(name, [run for run in runs if run["optimizer"] == name])
        for name in dict.fromkeys(r["optimizer"] for r in runs)
    ]
    return sorted(rows, key=lambda row: row["rmse_median"])


def row(optimizer: str, runs: list[dict[str, Any]]) -> dict[str, Any]:
    own = np.array([run["rmse_before_polish"]["identify"] for run in runs])
    reached = [run["evaluations_to_1_percent"] for run in runs]
    known = [value for value in reached if value is not None]
    lower, median, upper = np.percentile(own, [25, 50, 75])
    return {
        "optimizer": optimizer,
        "runs": len(runs),
        "rmse_median": median,
        "rmse_lower_quartile": lower,
        "rmse_upper_quartile": upper,
        "rmse_best": own.min(),
        "polished_rmse_median": np.median([run["rmse"]["identify"] for run in runs]),
        "seconds_median": np.median([run["seconds"] for run in runs]),
        "cpu_seconds_median": np.median([run["cpu_seconds"] for run in runs]),
        "evaluations": max(run["evaluations"] for run in runs),
        "evaluations_to_1_percent_median": float(np.median(known)) if 2 * len(known) > len(runs) else None,
        "success": len(known) / len(runs),
    }
