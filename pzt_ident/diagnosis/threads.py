"""Functions side by side in threads, with results and work that do not depend on how many there are."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from typing import TypeVar

import numpy as np

from pzt_ident.engine import work

Item = TypeVar("Item")
Result = TypeVar("Result")

AHEAD = 4  # items that are begun before the result of the first of them is taken, whatever the machine
THREADS = max(2, min(AHEAD, os.cpu_count() or 2))


def side_by_side(function: Callable[[Item], Result], items: Iterable[Item]) -> Iterator[Result]:
    """The function of each item, in order, from threads that are as silent about floating point as the caller's.

    An item is asked for when the result of the one AHEAD places before it was taken, and each is begun with the work
    that was counted until then: what depends on that, or on earlier results, is the same on any machine.
    """
    with ThreadPoolExecutor(THREADS, initializer=partial(np.seterr, **np.geterr())) as pool:
        begun: deque[Future[tuple[Result, float]]] = deque()
        for item in items:
            begun.append(pool.submit(counted, function, item, work.done()))
            if len(begun) == AHEAD:
                yield taken(begun.popleft())
        while begun:
            yield taken(begun.popleft())


def counted(function: Callable[[Item], Result], item: Item, before: float) -> tuple[Result, float]:
    """The result of one item in this thread, and its work."""
    work.begin(before)
    return function(item), work.done() - before


def taken(future: Future[tuple[Result, float]]) -> Result:
    """A result, whose work is now that of the thread which takes it."""
    result, seconds = future.result()
    work.add(seconds)
    return result
