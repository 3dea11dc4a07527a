"""The stage of Lin & Lin (2012), Table 7, as an identified one: to be driven, inverted and controlled."""

from __future__ import annotations

import numpy as np

from experiments.rigs.xy_stage import Axis, coupled
from pzt_ident.control.stage import Stage
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks

RANGE = {"x": 130.0, "y": 90.0}  # V, of Case II
AXES = dict(zip("xy", coupled().axes, strict=True))
COUPLING = coupled().coupling()


def damping_of(axis: Axis, ratio: float) -> float:
    """N s/m."""
    return 2 * ratio * (axis.mass * axis.stiffness) ** 0.5


def table_7(dt: float, words: str = "bouc_wen cross_coupling lumped", axes: str = "xy", ratio: float = 0.02) -> Stage:
    """A stage at a sample time. The damping, which the paper identified as zero, is a share of the critical one."""
    model = Chain([blocks[word] for word in words.split()], tuple(axes), range(len(axes)))
    known: dict[str, float] = {}
    for place, (name, axis) in enumerate(AXES.items()):
        prefix = f"{name}." if len(axes) > 1 else ""
        if name in axes:
            known |= {f"{prefix}bouc_wen.{word}": getattr(axis, word) for word in ("gain", "alpha", "beta", "gamma")}
            known |= {f"{prefix}lumped.{word}": getattr(axis, word) for word in ("mass", "stiffness")}
            known[f"{prefix}lumped.damping"] = damping_of(axis, ratio)
            known[f"{prefix}cross_coupling.ratio"] = COUPLING[place][1 - place]
    ranges = [RANGE[name] for name in axes]
    return Stage(model, np.array([known[name] for name in model.names]), dt, ranges, ranges)
