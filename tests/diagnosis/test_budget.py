"""What a diagnosis may take is counted in its own work."""

from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pzt_ident.diagnosis import budget
from pzt_ident.engine import native, work


@pytest.fixture
def clock(monkeypatch):
    """CPU seconds of the process and of its one thread, which stand still but where a test moves them."""
    clock = SimpleNamespace(now=1.0, read=lambda: clock.now)
    monkeypatch.setattr(native, "thread_time", clock.read)
    monkeypatch.setattr(budget, "process_time", clock.read)
    monkeypatch.setattr(native, "loads", lambda: False)
    return clock


def compiled(clock, seconds, *others):
    """A function that takes so many seconds to compile, and others on the way."""

    def compile_it():
        for other in others:
            native.address_of("other", other)
        clock.now += seconds
        return SimpleNamespace(address=1)

    return compile_it


def test_work_spends_it(clock):
    spent = budget.Budget(10)
    work.add(9)
    assert spent.allows("this", 1.0)
    work.add(2)
    assert not spent.allows("that", 1.0)
    assert spent.untried == ["that"]


@given(st.floats(0, 1), st.floats(0, 100), st.floats(0, 100))
def test_time_changes_nothing_but_on_a_machine_that_is_slower(share, worked, taken):
    now = 1.0
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(budget, "process_time", lambda: now)
        work.begin(0.0)
        spent = budget.Budget(60)
        work.add(worked)
        now += taken
        most = min(share * budget.SLOWER, share + budget.LATER * max(budget.WHOLE - share, 0)) * 60
        if taken < most - 1e-9:
            assert spent.spent(share) == (worked >= share * 60)
        elif taken > most + 1e-9:
            assert spent.spent(share)


def test_kernels_that_are_compiled_do_not(clock):
    """A first use on a machine has as much for its verdict as any later one."""
    spent = budget.Budget(10)
    native.address_of("one", compiled(clock, 100, compiled(clock, 50), compiled(clock, 25)))
    clock.now += 9
    assert spent.allows("this", 1.0)
    clock.now += 2
    assert spent.spent(1.0)


@given(st.floats(0, 1), st.floats(0, 1))
def test_each_path_has_a_part_of_what_is_left_for_exploring(first, second):
    spent = budget.Budget(60)
    assert spent.beside == pytest.approx(budget.BESIDE * budget.EXPLORING)
    work.add(60 * first)
    spent.begin_path()
    assert spent.beside == pytest.approx(first + budget.BESIDE * max(budget.EXPLORING - first, 0))
    work.add(60 * second)
    spent.begin_again()
    assert spent.beside == pytest.approx(budget.BESIDE * budget.EXPLORING)


@pytest.mark.parametrize("seconds", [None, 0.0])
def test_a_budget_without_end_or_seconds_has_paths_too(seconds):
    spent = budget.Budget(seconds)
    work.add(1)
    spent.begin_path()
    assert spent.allows("this", spent.beside) == (seconds is None)


@given(st.floats(0, 2), st.floats(0, 2))
def test_fits_of_a_proof_have_what_those_before_it_left_them_and_a_little_more_if_that_is_nothing(worked, taken):
    now = 1.0
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(budget, "process_time", lambda: now)
        work.begin(0.0)
        spent = budget.Budget(60)
        work.add(60 * worked)
        now += 60 * taken
        assert spent.lasts() == (not spent.spent(budget.PROVING))
        late = spent.spent(budget.WHOLE)
        spent.begin_proof()
        assert spent.lasts() == (not spent.spent(budget.WHOLE + budget.PROOF * late))
        work.add(60 * (budget.WHOLE + budget.PROOF))
        assert not spent.lasts()
