"""When Ctrl-C and SIGTERM are heard."""

import os
import signal

import pytest

from pzt_ident.run.interrupts import interrupts_deferred, interrupts_heard


@pytest.fixture(autouse=True)
def hearing():
    """Whatever other tests in this process have done."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


BOTH = pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])


@BOTH
def test_a_deferred_interrupt_waits_for_the_next_look(number):
    done = []
    with pytest.raises(KeyboardInterrupt), interrupts_heard(), interrupts_deferred() as check:
        os.kill(os.getpid(), number)
        done.append("went on")
        check()
        done.append("missed")
    assert done == ["went on"]


@BOTH
def test_a_deferred_interrupt_waits_for_the_end_at_most(number):
    before = signal.getsignal(number)
    with pytest.raises(KeyboardInterrupt), interrupts_heard(), interrupts_deferred():
        os.kill(os.getpid(), number)
    assert signal.getsignal(number) == before


def test_an_interrupt_that_nobody_is_to_hear_is_not_heard():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with interrupts_heard() as check, interrupts_deferred():
            os.kill(os.getpid(), signal.SIGINT)
            check()
    finally:
        signal.signal(signal.SIGINT, before)
