"""One campaign identified through the public API: what the fit says, and how far off it is."""

from __future__ import annotations

from typing import Any

import numpy as np

import pzt_ident as pzt
from experiments.coverage.campaign import RATE, draw
from experiments.coverage.stage import MASS, Array, Truth, displacement

NAMES = {"gain": "bouc_wen.gain", "alpha": "bouc_wen.alpha", "beta": "bouc_wen.beta", "gamma": "bouc_wen.gamma"}
NAMES |= {"stiffness": "lumped.stiffness", "damping": "lumped.damping"}
BOUNDS = {"gain": (0.05, 0.2), "alpha": (0, 1), "beta": (0.005, 0.2), "gamma": (-0.05, 0.05)}
BOUNDS |= {"stiffness": (1e5, 1e6), "damping": (0, 100)}


def solve(seed: int, colour: str) -> dict[str, Any]:
    """Errors in standard errors of each parameter (None: not determined), and the share of the record that was not
    seen whose true displacement lies within 1.96 standard errors of the prediction."""
    campaign = draw(seed, colour)
    t = np.arange(campaign.drives[0].size) / RATE
    train = [
        pzt.Record(t, u, y, drive="V", response="um", name=name)
        for u, y, name in zip(campaign.drives, campaign.readings, ("loops", "tones"), strict=False)
    ]
    bounds = {NAMES[name]: limits for name, limits in BOUNDS.items()}
    fit = pzt.identify(
        pzt.Model("bouc_wen", "lumped"), train, bounds=bounds, fixed={"lumped.mass": MASS}, optimizer="pso", seed=seed
    )
    found = {name: fit.parameters[word] for name, word in NAMES.items()}
    errors = {
        name: None if entry.stderr is None else (entry.value - campaign.truth[name]) / entry.stderr
        for name, entry in found.items()
    }
    values = {name: entry.value for name, entry in found.items()}
    order = [name for word in fit.covariance.index for name in NAMES if NAMES[name] == word]
    slope = slopes(values, order, campaign.drives[2])
    spread = np.sqrt(np.einsum("ij,jk,ik->i", slope, fit.covariance.to_numpy(), slope))
    off = fit.simulate(t, campaign.drives[2]) - campaign.clean[2]
    inside = np.abs(off[1:]) <= 1.96 * spread[1:]  # the first sample is 0 V in both
    rmse = float(np.sqrt(np.mean(off**2)))
    return {
        "errors": errors,
        "inside": float(inside.mean()),
        "rmse": rmse,
        "spread": float(np.sqrt(np.mean(spread**2))),
    }


def slopes(values: Truth, order: list[str], drive: Array) -> Array:
    """Derivatives of the displacement by the parameters, central differences, (samples, parameters)."""
    columns = []
    for name in order:
        step = 1e-4 * max(abs(values[name]), 1e-3 * BOUNDS[name][1])
        sides = [displacement(drive, 1 / RATE, values | {name: values[name] + sign * step}) for sign in (1, -1)]
        columns.append((sides[0] - sides[1]) / (2 * step))
    return np.column_stack(columns)
