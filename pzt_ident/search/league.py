"""Comparison of the optimizers: their results before the polish, at equal evaluations."""

from __future__ import annotations

from math import comb
from typing import Any

import numpy as np

NEAR = 1.01  # times the best RMSE of all runs


def rank(runs: list[dict[str, Any]], histories: dict[str, np.ndarray]) -> list[dict[str, Any]]:
    """One row per optimizer, best first. Adds to each run the evaluations after which it was within one percent.

    histories: by run, (generations, 3) with evaluations, seconds and best RMSE; a run without one started from a fit
    and is no optimizer's. Success is the share of runs within one percent of the best RMSE of all runs, polished or
    not, before the polish and after it.
    """
    best = min((min(run["rmse"]["identify"], run["rmse_before_polish"]["identify"]) for run in runs), default=0.0)
    for run in runs:
        run["evaluations_to_1_percent"] = None
        if run["run"] in histories:
            evaluations, _, losses = histories[run["run"]].T
            near = np.flatnonzero(losses <= NEAR * best)
            run["evaluations_to_1_percent"] = int(evaluations[near[0]]) if near.size else None
    runs = [run for run in runs if run["run"] in histories]
    rows = [
        summary_of(name, [run for run in runs if run["optimizer"] == name])
        for name in dict.fromkeys(r["optimizer"] for r in runs)
    ]
    for row in rows:
        polished = [run["rmse"]["identify"] for run in runs if run["optimizer"] == row["optimizer"]]
        row["polished_success"] = sum(error <= NEAR * best for error in polished) / len(polished)
    rows.sort(key=lambda row: row["rmse_median"])
    rmse = {row["optimizer"]: rmse_by_repeat(runs, row["optimizer"]) for row in rows}
    return [row | paired_comparison(rmse[rows[0]["optimizer"]], rmse[row["optimizer"]]) for row in rows]


def rmse_by_repeat(runs: list[dict[str, Any]], optimizer: str) -> dict[int, float]:
    return {run["repeat"]: run["rmse_before_polish"]["identify"] for run in runs if run["optimizer"] == optimizer}


def paired_comparison(leader: dict[int, float], other: dict[int, float]) -> dict[str, Any]:
    """The leading optimizer against another, repeat by repeat: in how many repeats it was ahead, how many differ, and
    the p-value of the two-sided sign test, which cannot be small for few repeats (five: 0.06 at best)."""
    pairs = [(leader[repeat], other[repeat]) for repeat in leader.keys() & other.keys()]
    ahead, differ = sum(a < b for a, b in pairs), sum(a != b for a, b in pairs)
    tail = sum(comb(differ, k) for k in range(min(ahead, differ - ahead) + 1)) / 2**differ
    return {"leader_ahead": ahead, "pairs": differ, "sign_test": min(1.0, 2 * tail)}


def summary_of(optimizer: str, runs: list[dict[str, Any]]) -> dict[str, Any]:
    """One row of the comparison."""
    rmse = np.array([run["rmse_before_polish"]["identify"] for run in runs])
    reached = [run["evaluations_to_1_percent"] for run in runs]
    known = [value for value in reached if value is not None]
    lower, median, upper = np.percentile(rmse, [25, 50, 75])
    return {
        "optimizer": optimizer,
        "runs": len(runs),
        "rmse_median": median,
        "rmse_lower_quartile": lower,
        "rmse_upper_quartile": upper,
        "rmse_best": rmse.min(),
        "polished_rmse_best": min(run["rmse"]["identify"] for run in runs),
        "polished_rmse_median": np.median([run["rmse"]["identify"] for run in runs]),
        "seconds_median": np.median([run["seconds"] for run in runs]),
        "cpu_seconds_median": np.median([run["cpu_seconds"] for run in runs]),
        "evaluations": max(run["evaluations"] for run in runs),
        "evaluations_to_1_percent_median": float(np.median(known)) if 2 * len(known) > len(runs) else None,
        "success": len(known) / len(runs),
    }
