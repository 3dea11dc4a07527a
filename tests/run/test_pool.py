"""Tasks in processes: which of them die, fail or are done again."""

import os
import signal
import sys
from itertools import count
from multiprocessing import Pipe

import numpy as np

from pzt_ident.errors import RunError
from pzt_ident.run.place import Local
from pzt_ident.run.pool import ATTEMPTS, serve


def unlucky(tell, common, number):
    if number == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    if number == 2:
        sys.exit(3)
    if number == 4:
        raise RunError("comes to nothing")
    tell({"event": "fine", "number": number})
    return common, number, os.getpid()


def test_a_worker_that_dies_again_and_again_is_named_and_the_others_finish():
    events, results = [], {}
    tasks = [(f"job-{i}", (i,)) for i in range(6)]
    failed = Local(2).run_all(unlucky, ("given once",), tasks, events.append, results.__setitem__)
    assert failed == {
        "job-1": "its process was killed by signal 9",
        "job-2": "its process ended with exit code 3",
        "job-4": "comes to nothing",
    }
    assert {event["number"] for event in events if event["event"] == "fine"} == {0, 3, 5}
    again = [event["run"] for event in events if event["event"] == "again"]
    assert sorted(again) == ["job-1"] * (ATTEMPTS - 1) + ["job-2"] * (ATTEMPTS - 1)
    assert {name: result[:2] for name, result in results.items()} == {f"job-{i}": ("given once", i) for i in (0, 3, 5)}


def once(tell, folder, number):
    note = folder / str(number)
    if number == 3 and not note.exists():
        note.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number**2


def test_what_a_killed_worker_was_at_is_done_again(tmp_path):
    results: dict = {}
    tasks = ((str(i), (i,)) for i in range(8))
    assert Local(2).run_all(once, (tmp_path,), tasks, lambda event: None, results.__setitem__) == {}
    assert results == {str(i): i**2 for i in range(8)}


def whoami(tell, number):
    return os.getpid()


def test_a_worker_does_one_task_after_another_and_no_task_is_taken_before_there_is_room():
    taken, done, ahead = [], {}, []

    def tasks():
        for i in range(20):
            taken.append(i)
            yield str(i), (i,)

    def note(name, process):
        done[name] = process
        ahead.append(len(taken) - len(done))

    Local(2).run_all(whoami, (), tasks(), lambda event: None, note)
    assert len(done) == 20
    assert len(set(done.values())) <= 2
    assert max(ahead) <= 2


def endless(tell):
    for i in count():
        tell({"event": "generation", "number": i})


def test_a_worker_ends_quietly_with_its_parent(capfd):
    ours, theirs = Pipe()
    ours.send(())
    ours.close()
    handler, errors = signal.getsignal(signal.SIGINT), np.geterr()
    serve(endless, (), theirs)
    signal.signal(signal.SIGINT, handler)
    np.seterr(**errors)
    assert capfd.readouterr().err == ""
