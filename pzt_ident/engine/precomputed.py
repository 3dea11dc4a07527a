"""Numbers that a bank computes with NumPy once for each distinct candidate, ahead of the kernel."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from pzt_ident.model.block import Bank

Array = NDArray[np.float64]
Columns = Mapping[str, int | list[int]]


class Precomputation:
    """A bank's `solve` over candidates. columns: of theta, by parameter; constants: what has no column."""

    def __init__(
        self, block: type[Bank], columns: Mapping[str, int | list[int]], constants: Mapping[str, float]
    ) -> None:
        self.block = block
        self.columns = columns
        self.constants = dict(constants)

    def __call__(self, theta: Array, facts: Mapping[str, float]) -> Array:
        """(candidates, branches, words of `solved`); NaN where `solve` fails. facts: of the record."""
        needed = [column for columns in self.columns.values() for column in np.atleast_1d(columns)]
        distinct, first, index = np.unique(theta[:, needed], axis=0, return_index=True, return_inverse=True)
        solved = np.full((len(distinct), self.block.branches, len(self.block.solved)), np.nan)
        for i, candidate in enumerate(theta[first]):
            if np.isfinite(distinct[i]).all():
                with suppress(np.linalg.LinAlgError), np.errstate(all="ignore"):
                    own = {word: candidate[column] for word, column in self.columns.items()}
                    values = {**self.constants, **facts, **own}
                    solved[i] = np.transpose(self.block.solve(SimpleNamespace(**values)))  # type: ignore[attr-defined]
        return solved[index.ravel()]
