"""How this package computes in a process that is not its own: that of a user, or of a cluster."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def computing() -> Iterator[None]:
    """A candidate that overflows is counted, not warned about, and BLAS keeps to one thread: on matrices as small as
    these its threads wait for each other, which takes twenty times as long."""
    import numpy as np
    from threadpoolctl import threadpool_limits

    with np.errstate(all="ignore"), threadpool_limits(1, "blas"):
        yield
