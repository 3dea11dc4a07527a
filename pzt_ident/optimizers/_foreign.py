"""Seed the global random states for libraries that draw from them, and restore them afterwards."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import RLock

import numpy as np

_state_lock = RLock()


@contextmanager
def numpy_seeded(rng: np.random.Generator) -> Iterator[None]:
    """Inside, the global NumPy state is seeded from `rng`; afterwards it is restored."""
    with _state_lock:
        state = np.random.get_state()  # noqa: NPY002
        np.random.seed(rng.integers(2**32, size=4))  # noqa: NPY002
        try:
            yield
        finally:
            np.random.set_state(state)  # noqa: NPY002
