"""Tasks in processes: which of them die, fail or are done again."""

import errno
import os
import signal
import struct
import subprocess
import sys
import time
from itertools import count
from multiprocessing import Pipe
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace

import numpy as np
import pytest

from pzt_ident.errors import RunError
from pzt_ident.run.place import Local
from pzt_ident.run.pool import ATTEMPTS, Worker, message_of, search_path, serve


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


def test_a_worker_ends_quietly_with_its_parent(capfd, tmp_path):
    ours, theirs = Pipe()
    ours.send(())
    ours.close()
    handler, errors = signal.getsignal(signal.SIGINT), np.geterr()
    serve(endless, (), theirs, str(tmp_path))
    signal.signal(signal.SIGINT, handler)
    np.seterr(**errors)
    assert capfd.readouterr().err == ""


def littered(tell, folder):
    """The first time it is killed with a scratch folder of its own."""
    with TemporaryDirectory() as scratch:
        if not (note := folder / "scratch").exists():
            note.write_text(scratch)
            os.kill(os.getpid(), signal.SIGKILL)


def test_a_killed_worker_leaves_no_scratch(tmp_path):
    assert Local(1).run_all(littered, (tmp_path,), [("only", ())], lambda event: None) == {}
    assert not Path((tmp_path / "scratch").read_text()).exists()


ORPHANED = """\
import os, signal, tempfile
from pathlib import Path
from pzt_ident.run import pool

def orphaned(tell, parent):
    Path("scratch").write_text(tempfile.mkdtemp())
    os.kill(parent, signal.SIGKILL)

if __name__ == "__main__":
    import orphan
    pool.run_all(orphan.orphaned, (os.getpid(),), [("only", ())], 1, print)
"""


def test_a_worker_whose_parent_is_killed_clears_up(tmp_path):
    (tmp_path / "orphan.py").write_text(ORPHANED)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), *search_path()])}
    subprocess.run([sys.executable, "-m", "orphan"], cwd=tmp_path, env=environment, timeout=60)
    scratch = Path((tmp_path / "scratch").read_text())
    until = time.monotonic() + 30
    while scratch.parent.exists() and time.monotonic() < until:
        time.sleep(0.02)
    assert scratch.parent.name.startswith("pzt-ident-")
    assert not scratch.parent.exists()


def full(tell, number):
    if number == 1:
        raise OSError(errno.ENOSPC, "No space left on device", "losses")


def test_a_full_disk_is_no_fault_of_the_task_but_ends_all(tmp_path):
    results: dict = {}
    with pytest.raises(OSError, match="No space left on device: 'losses'") as raised:
        Local(1).run_all(full, (), [(str(i), (i,)) for i in range(3)], lambda event: None, results.__setitem__)
    assert (raised.value.errno, list(results)) == (errno.ENOSPC, ["0"])


KILLED_AS_IT_STARTS = """\
import os, signal
from pathlib import Path

deaths = Path("deaths")
if len(deaths.read_text()) < {times}:
    deaths.write_text(deaths.read_text() + "x")
    os.kill(os.getpid(), signal.SIGKILL)
"""
ONE_TASK = """\
from types import SimpleNamespace
from pzt_ident.run import pool

pool.PRELOADED, pool.blocks = ("killed",), SimpleNamespace(modules=tuple)
try:
    print(pool.run_all(pool.forget, (), [("only", (1,))], 1, print, print))
except pool.RunError as error:
    print(error)
"""


@pytest.mark.parametrize(
    ("times", "said"),
    [
        (2, "only None\n{}\n"),
        (ATTEMPTS, "no process can be started on this machine: each one is killed as it starts\n"),
    ],
)
def test_where_the_server_of_the_workers_is_killed_as_one_starts_another_is_begun(tmp_path, times, said):
    (tmp_path / "killed.py").write_text(KILLED_AS_IT_STARTS.format(times=times))
    (tmp_path / "deaths").touch()
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), *search_path()])}
    line = [sys.executable, "-c", ONE_TASK]
    ended = subprocess.run(line, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=60)
    assert (ended.stdout, ended.stderr, ended.returncode) == (said, "", 0)


def test_a_worker_that_dies_in_the_middle_of_a_message_has_died():
    ours, theirs = Pipe()
    os.write(theirs.fileno(), struct.pack("!i", 100) + b"half of it")
    theirs.close()
    worker = Worker(SimpleNamespace(join=lambda: None, exitcode=-9), ours)
    assert message_of(worker) == ("died", "its process was killed by signal 9")
