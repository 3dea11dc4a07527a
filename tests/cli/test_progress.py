"""What a person sees while a run goes on."""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress

import pytest

from pzt_ident.cli import progress
from pzt_ident.cli.progress import Progress, duration, listening
from terminal import Terminal

START = {"event": "start", "runs": ["a", "b"], "budget": 1000, "unit": "um", "together": ""}


def generation(run: str, evaluations: int, best: float) -> dict:
    return {"event": "generation", "run": run, "evaluations": evaluations, "best": best}


@pytest.fixture
def clock(monkeypatch):
    """Seconds that pass only on demand."""
    now = [100.0]
    monkeypatch.setattr(progress.time, "perf_counter", lambda: now[0])
    return now


def test_progress_adds_the_runs_up(clock):
    state = Progress()
    state.take(START)
    assert str(state) == "0 %: 0 of 1000 evaluations, best RMSE - um"
    state.take(generation("a", 100, 0.5))
    clock[0] += 10
    state.take(generation("b", 50, 0.2))
    state.take(generation("a", 150, 0.4))
    assert str(state) == "20 %: 200 of 1000 evaluations, best RMSE 0.2 um, 1 min 20 s left"


def test_an_ended_run_has_nothing_left(clock):
    state = Progress()
    state.take(START)
    state.take(generation("a", 100, 0.5))
    state.take({"event": "failed", "run": "a", "reason": "killed"})
    assert state.done == 500
    state.take(generation("b", 500, 0.5))
    assert str(state).endswith("best RMSE 0.5 um, finishing")


def test_lines_are_few(clock, capsys):
    with listening(silent=False) as listen:
        listen(START)
        for step in range(1, 101):
            clock[0] += 0.125
            listen(generation("a", step, 1 / step))
    lines = capsys.readouterr().err.splitlines()
    assert [line.partition(",")[0] for line in lines] == ["4 %: 40 of 1000 evaluations", "8 %: 80 of 1000 evaluations"]


def test_a_diagnosis_says_what_it_is_at(clock, capsys):
    with listening(silent=False) as listen:
        for done in range(1, 101):
            clock[0] += 0.0625
            listen({"event": "scored", "said": f"{done} of 100 effects scored"})
        listen({"event": "stair", "said": "+ creep: RMSE 0.2 µm"})
    assert capsys.readouterr().err == "80 of 100 effects scored\n+ creep: RMSE 0.2 µm\n"


def test_an_end_from_outside_is_an_interrupt(capsys):
    with pytest.raises(KeyboardInterrupt), listening(silent=False) as listen:
        listen(START | {"folder": "out"})
        os.kill(os.getpid(), signal.SIGTERM)
    assert capsys.readouterr().err == "`pzt-ident resume out` goes on from here\n"
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_that_got_lost_is_raised_with_the_next_event(number):
    before = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}[number]
    left = signal.signal(number, before)  # by other tests in this process
    with pytest.raises(KeyboardInterrupt), listening(silent=True) as listen:
        listen(START)
        with suppress(KeyboardInterrupt):
            os.kill(os.getpid(), number)
        listen(generation("a", 500, 0.25))
        pytest.fail("it is lost")
    assert signal.signal(number, left) == before


def test_a_finished_run_says_so(capsys):
    with listening(silent=False) as listen:
        listen({"event": "finished"})
    assert capsys.readouterr().err == "every run is finished: nothing is searched again\n"


def test_silence(capsys):
    with listening(silent=True) as listen:
        listen(START)
        listen({"event": "failed", "run": "a", "reason": "killed"})
    assert capsys.readouterr() == ("", "")


def test_a_terminal_gets_one_live_bar(monkeypatch):
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "120")
    with listening(silent=False) as listen:
        listen(START)
        listen(generation("a", 500, 0.25))
        listen({"event": "failed", "run": "b", "reason": "killed by [signal] 9"})
    shown = screen.getvalue()
    assert "best RMSE 0.25 um" in shown
    assert "b failed: killed by [signal] 9" in shown
    assert "\x1b[2K" in shown


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.4, "0 s"), (59.4, "59 s"), (59.6, "1 min 0 s"), (125, "2 min 5 s"), (4800, "1 h 20 min")]
)
def test_duration(seconds, text):
    assert duration(seconds) == text
