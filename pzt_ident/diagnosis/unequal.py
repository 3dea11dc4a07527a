"""Effects with amounts of their own in each record whose size is that of the device, and so the same in all."""

from __future__ import annotations

import numpy as np

from pzt_ident.diagnosis.fit import Fit
from pzt_ident.model.registry import blocks, word_of

RATIO = 3.0  # between the largest and the smallest of one size, as it is found


def differs_in_size(fit: Fit, effect: str) -> bool:
    """Whether what an effect declares to be alike in all records is not, on a measured axis."""
    model, alike = fit.problem.model, blocks[effect].alike
    own = [
        (number, entry.axis)
        for number, entry in enumerate(model.amounts)
        if entry.block.name == word_of(effect) and entry.word in alike
    ]
    if not own:
        return False
    theta = fit.problem.parameters(fit.point)
    for axis in {axis for _, axis in own}:
        columns = [len(model.names) + number for number, each in own if each == axis]
        sizes = [
            float(np.linalg.norm(simulator.amounts.complete(theta)[0, columns]))
            for simulator in fit.problem.every_simulator
        ]
        if max(sizes) > RATIO * min(sizes):
            return True
    return False
