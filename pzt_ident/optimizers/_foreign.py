"""Lend libraries that draw from NumPy's global random state one of their own."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import RLock

import numpy as np
from numpy.random.mtrand import get_bit_generator, set_bit_generator

_state_lock = RLock()
_lent = np.random.MT19937(0)


@contextmanager
def numpy_seeded(rng: np.random.Generator) -> Iterator[None]:
    """Inside, the global NumPy state is seeded from `rng`; afterwards it is that of before."""
    with _state_lock:
        given = get_bit_generator()
        set_bit_generator(_lent)
        np.random.seed(rng.integers(2**32, size=4))  # noqa: NPY002
        try:
            yield
        finally:
            set_bit_generator(given)
