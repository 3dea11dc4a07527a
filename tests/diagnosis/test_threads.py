"""Threads share the work, and nothing of a result tells how many there are."""

import threading

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pzt_ident.diagnosis import threads
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.threads import side_by_side
from pzt_ident.engine import work


def test_threads_are_as_silent_about_floating_point_as_the_caller(recwarn):
    with np.errstate(all="ignore"):
        quotients = list(side_by_side(lambda divisor: np.ones(1) / divisor, [0.0, 2.0]))
    assert quotients == [np.inf, 0.5]
    assert not recwarn.list


@pytest.fixture(params=[1, 2, 5])
def number(request, monkeypatch):
    monkeypatch.setattr(threads, "THREADS", request.param)


def worked(seconds):
    """What this thread had done, before it works for so long."""
    before = work.done()
    work.add(seconds)
    return before


@given(st.lists(st.floats(0, 10), max_size=12), st.floats(0, 5))
def test_work_is_counted_in_order_however_many_threads_there_are(seconds, before):
    for threads_used in (1, 2, 5):
        threads.THREADS, usual = threads_used, threads.THREADS
        try:
            work.begin(before)
            begun = list(side_by_side(worked, seconds))
        finally:
            threads.THREADS = usual
        expected = [before + sum(seconds[: max(0, i - threads.AHEAD + 1)]) for i in range(len(seconds))]
        assert begun == pytest.approx(expected)
        assert work.done() == pytest.approx(before + sum(seconds))


def test_an_item_is_asked_for_when_one_so_many_before_it_is_done(number):
    """What is begun may depend on results that are there on any machine."""
    done, asked = [], []

    def items():
        for item in range(9):
            asked.append(len(done))
            yield item

    for result in side_by_side(lambda item: item, items()):
        done.append(result)
    assert done == list(range(9))
    assert asked == [max(0, item - threads.AHEAD + 1) for item in range(9)]


def test_a_budget_ends_at_the_same_item_however_many_threads_there_are(number):
    budget = Budget(10)
    begun = list(side_by_side(worked, (3.0 for _ in range(20) if budget.allows("this", 1.0))))
    assert len(begun) == 7 and budget.untried == ["this"]


def test_each_thread_counts_its_own_work():
    before = work.done()
    other = threading.Thread(target=work.add, args=(5.0,))
    other.start()
    other.join()
    assert work.done() == before
