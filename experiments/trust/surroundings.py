"""Surroundings that no manual promises: a full disk, nobody at home, a clock that goes back; and whether the result is
the same and nothing is lost."""

from __future__ import annotations

import os
import resource
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

from experiments.trust.bench import Case
from experiments.trust.essence import differences, essence
from experiments.trust.good import write_good
from experiments.trust.judge import PYTHON
from experiments.trust.kills import COMMANDS, PROGRAM, words_of, write_lot

CLOCK_BACK = """\
import time, datetime
past, real = [0.0], time.time
def back():
    past[0] += 1800.0
    return real() - past[0]
time.time = back
"""


@dataclass(frozen=True)
class Surrounding:
    """variables: of the environment, None for those that are not set. before: in the process ahead of the command."""

    name: str
    variables: dict[str, str | None] = field(default_factory=dict)
    workers: int = 1
    before: Callable[[], None] | None = None
    out: Path | None = None
    says: tuple[str, ...] = ()
    """Of which an error must say one; nothing where the command must come to the same result."""


def small_files() -> None:
    """No file may be larger than a few kB: what a full disk is to who writes."""
    import signal

    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (6000, resource.RLIM_INFINITY))


def few_open_files() -> None:
    resource.setrlimit(resource.RLIMIT_NOFILE, (64, 64))


SURROUNDINGS = (
    Surrounding("two processes", workers=2),
    Surrounding("C locale", {"LC_ALL": "C", "LANG": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}),
    Surrounding(
        "ASCII alone", {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONIOENCODING": "ascii"}
    ),
    Surrounding("another hash seed", {"PYTHONHASHSEED": "4711"}),
    Surrounding("a third hash seed", {"PYTHONHASHSEED": "0"}),
    Surrounding("no HOME", {"HOME": None}),
    Surrounding("a HOME that is not there", {"HOME": "/nobody/here"}),
    Surrounding("no cache folder", {"PZT_IDENT_CACHE": "/dev/null/cache", "NUMBA_CACHE_DIR": None}),
    Surrounding("a bare environment", dict.fromkeys(("HOME", "USER", "LANG", "TERM", "SHELL", "LOGNAME"))),
    Surrounding("no terminal", {"TERM": None, "COLUMNS": None}),
    Surrounding("a dumb terminal of one column", {"TERM": "dumb", "COLUMNS": "1"}),
    Surrounding("a clock that goes back", {"PYTHONPATH": "clock"}),
    Surrounding("another time zone", {"TZ": "Pacific/Kiritimati"}),
    Surrounding("few files at once", before=few_open_files),
    Surrounding("optimised Python", {"PYTHONOPTIMIZE": "1"}),
    Surrounding("Python without docstrings", {"PYTHONOPTIMIZE": "2"}, says=("without docstrings",)),
    Surrounding("full disk", before=small_files, says=("File too large", "No space left")),
    Surrounding("read-only folder", out=Path("/sys/out"), says=("Permission denied", "not permitted", "Read-only")),
)


def at_work(command: str, job: Path, out: Path, around: Surrounding) -> subprocess.CompletedProcess[str]:
    changed = os.environ | {name: value for name, value in around.variables.items() if value is not None}
    environment = {name: value for name, value in changed.items() if around.variables.get(name, "") is not None}
    if environment.get("PYTHONPATH") == "clock":
        clock = job.parent / "clock"
        clock.mkdir(exist_ok=True)
        (clock / "sitecustomize.py").write_text(CLOCK_BACK)
        environment["PYTHONPATH"] = os.pathsep.join([str(clock), os.environ.get("PYTHONPATH", os.getcwd())])
    words = [word for word in words_of(command, job, out) if word != "--quiet"]
    workers = ["--workers", str(around.workers)] if command != "improve" else []
    line = [*PROGRAM, *words, *workers]
    return subprocess.run(
        line, env=environment, capture_output=True, text=True, errors="replace", timeout=300, preexec_fn=around.before
    )


def cases(numbers: range, seed: int, scratch: Path) -> Iterator[Case]:
    """Each command in each surrounding, then two in one folder."""
    every = chain.from_iterable(in_all(command, seed, scratch / command) for command in COMMANDS)
    for number, case in zip(numbers, chain(every, two_in_one_folder(seed, scratch / "two")), strict=False):
        case.number = number
        yield case


def in_all(command: str, seed: int, scratch: Path) -> Iterator[Case]:
    """The same small job in each; where the surrounding forbids a result, it is resumed outside of it."""
    job, plain = write_lot(scratch, seed), Surrounding("plain")
    at_work(command, job, scratch / "whole", plain)
    true = essence(scratch / "whole")
    for number, around in enumerate(SURROUNDINGS):
        out = scratch / f"out{number}"
        ended = at_work(command, job, around.out or out, around)
        case = Case(0, f"{command}: {around.name}", "the same result")
        if PYTHON.search(ended.stderr + ended.stdout):
            case.faults.append(f"Python: {ended.stderr[-200:]}")
        if around.says:
            case.came = "an error, then the same result"
            if ended.returncode == 0 or not any(text in ended.stderr for text in around.says):
                case.faults.append(f"exit code {ended.returncode}: {ended.stderr[-300:]}")
            ended = resumed(out) if out.exists() else at_work(command, job, out, plain)
        if ended.returncode != 0:
            case.faults.append(f"exit code {ended.returncode}: {ended.stderr[-300:]}")
        else:
            case.faults += differences(true, essence(out))
        yield case


def resumed(out: Path) -> subprocess.CompletedProcess[str]:
    line = [*PROGRAM, "resume", str(out), "--no-report"]
    return subprocess.run(line, capture_output=True, text=True, timeout=300)


def two_in_one_folder(seed: int, scratch: Path) -> Iterator[Case]:
    """Two commands at once into one folder: one is refused, or both come to the same result."""
    job, out, case = write_good(scratch, seed), scratch / "both", Case(0, "run: two in one folder", "the same result")
    at_work("run", job, scratch / "whole", Surrounding("plain"))
    line = [*PROGRAM, *words_of("run", job, out), "--workers", "1"]
    both = [subprocess.Popen(line, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) for _ in range(2)]
    messages = [process.communicate(timeout=300)[1] for process in both]
    codes = sorted(process.returncode for process in both)
    if codes not in ([0, 0], [0, 2]) or any(PYTHON.search(text) for text in messages):
        case.faults.append(f"exit codes {codes}: {messages}")
    case.faults += differences(essence(scratch / "whole"), essence(out))
    yield case
