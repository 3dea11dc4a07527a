"""Numbers that a bank works out by NumPy once for each distinct candidate, before the lanes."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from pzt_ident.model.block import Bank

Array = NDArray[np.float64]


class Precomputation:
    """A bank's `solve` over candidates. columns: of theta, by parameter; known: what is the same for all."""

    def __init__(self, block: type[Bank], columns: Mapping[str, int | list[int]], known: Mapping[str, float]) -> None:
        self.block = block
        self.columns = columns
        self.known = dict(known)

    def __call__(self, theta: Array) -> Array:
        """(candidates, branches, words of `solved`); NaN where a candidate has none."""
        needed = [column for own in self.columns.values() for column in np.atleast_1d(own)]
        kinds, first, which = np.unique(theta[:, needed], axis=0, return_index=True, return_inverse=True)
        found = np.full((len(kinds), self.block.branches, len(self.block.solved)), np.nan)
        for i, candidate in enumerate(theta[first]):
            if np.isfinite(kinds[i]).all():
                with suppress(np.linalg.LinAlgError), np.errstate(all="ignore"):
                    own = self.known | {word: candidate[column] for word, column in self.columns.items()}
                    found[i] = np.transpose(self.block.solve(SimpleNamespace(**own)))  # type: ignore[attr-defined]
        return found[which.ravel()]
