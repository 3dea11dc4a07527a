"""Libraries that draw from the global random states: lend them a state of ours and leave theirs as it was."""

from __future__ import annotations

import random
from collections.abc import Iterator
from contextlib import contextmanager
from threading import RLock

import numpy as np

_one_at_a_time = RLock()


@contextmanager
def numpy_seeded(rng: np.random.Generator) -> Iterator[None]:
    """Inside, the global NumPy state is seeded from `rng`; afterwards it is what it was."""
    with _one_at_a_time:
        kept = np.random.get_state()  # noqa: NPY002
        np.random.seed(rng.integers(2**32, size=4))  # noqa: NPY002
        try:
            yield
        finally:
            np.random.set_state(kept)  # noqa: NPY002


@contextmanager
def random_seeded(rng: np.random.Generator) -> Iterator[None]:
    """Inside, the state of the module `random` is seeded from `rng`; afterwards it is what it was."""
    with _one_at_a_time:
        kept = random.getstate()
        random.seed(int(rng.integers(2**63)))
        try:
            yield
        finally:
            random.setstate(kept)
