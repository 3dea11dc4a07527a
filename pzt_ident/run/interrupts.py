"""Ctrl-C, and SIGTERM, which means the same: when they are heard, and that none is lost."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

NUMBERS = (signal.SIGINT, signal.SIGTERM)


class Interrupt:
    """A signal handler that raises KeyboardInterrupt. Where that got lost, as in the middle of an import, `check`
    raises it again."""

    def __init__(self) -> None:
        self.received = False

    def __call__(self, number: int, frame: Any) -> None:
        self.received = True
        self.check()

    def check(self) -> None:
        if self.received:
            raise KeyboardInterrupt


@contextmanager
def interrupts_heard() -> Iterator[Callable[[], None]]:
    """SIGTERM, too, raises KeyboardInterrupt inside. What this gives is to be called now and then: it raises an
    interrupt again that got lost. A Ctrl-C that nobody is to hear stays so."""
    interrupt = Interrupt()
    heard = [signal.SIGTERM, *[signal.SIGINT] * (signal.getsignal(signal.SIGINT) is signal.default_int_handler)]
    before = {number: signal.signal(number, interrupt) for number in heard}
    try:
        yield interrupt.check
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def interrupts_blocked() -> Iterator[None]:
    """Started inside, a process is deaf to Ctrl-C, where there are signal masks."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def interrupts_deferred() -> Iterator[Callable[[], None]]:
    """An interrupt waits for the next call of what this gives, or for the end."""
    received: list[int] = []

    def check() -> None:
        if received:
            raise KeyboardInterrupt

    main = threading.current_thread() is threading.main_thread()
    before = {number: signal.getsignal(number) for number in NUMBERS} if main else {}
    raising = {n: h for n, h in before.items() if h is signal.default_int_handler or isinstance(h, Interrupt)}
    for number in raising:
        signal.signal(number, lambda number, frame: received.append(number))
    try:
        yield check
    finally:
        for number, handler in raising.items():
            signal.signal(number, handler)
    check()
