"""Kills: of a command by power cut after every write, of its processes by chance; and whether `resume` comes to the
same result bit for bit."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from experiments.trust.bench import Case, InThisProcess
from experiments.trust.essence import differences, essence
from experiments.trust.good import write_good

COMMANDS = ("run", "improve", "fleet")
WRITES = ("open", "os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.truncate", "os.link", "os.chmod")
NOT_BEGUN = "holds no "
Words = list[str]


def words_of(command: str, job: Path, out: Path) -> Words:
    given = {"fleet": [str(job), str(job.parent / "d*/")], "improve": [str(job), "--budget", "30s"]}
    quiet = ["--quiet", "--no-report"] if command != "fleet" else ["--quiet"]
    return [command, *given.get(command, [str(job)]), "--out", str(out), *quiet]


def write_lot(folder: Path, seed: int) -> Path:
    """A job and three devices, one of them broken."""
    job = write_good(folder, seed)
    for number in range(3):
        write_good(folder / f"d{number}", seed + number)
    (folder / "d1" / "a.csv").write_text("broken\n")
    return job


def in_fork(words: Words, prepare: Callable[[], None] = lambda: None) -> tuple[int, str]:
    """Exit code and standard error of a command in a fork of this process, which has imported it; its tasks run in it
    too."""
    reading, writing = os.pipe()
    if pid := os.fork():
        os.close(writing)
        with os.fdopen(reading, "rb") as pipe:
            text = pipe.read().decode("utf-8", "replace")
        return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), text
    code = 1
    try:
        os.setpgid(0, 0)
        os.dup2(writing, 2)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        sys.stderr = os.fdopen(2, "w", closefd=False)
        code = here(words, prepare)
        sys.stderr.flush()
    finally:
        os._exit(code)


def here(words: Words, prepare: Callable[[], None] = lambda: None) -> int:
    """The command with its tasks in this process."""
    from pzt_ident.cli.commands import main
    from pzt_ident.run import place

    elsewhere = place.Local.run_all
    place.Local.run_all = InThisProcess.run_all  # type: ignore[method-assign]
    prepare()
    try:
        main(words, standalone_mode=True)
    except SystemExit as error:
        return int(error.code or 0)
    finally:
        place.Local.run_all = elsewhere  # type: ignore[method-assign]
    return 0


class PowerCut:
    """Kills this process ahead of its n-th write below a folder. torn: cut by chance the ends off the files that were
    written last and never made lasting, as a disk may after a power cut."""

    def __init__(self, folder: Path, write: int, torn: np.random.Generator | None = None) -> None:
        self.folder, self.left, self.torn = str(folder.resolve()), write, torn
        self.written: list[str] = []
        self.lasting: set[int] = set()

    def __call__(self) -> None:
        synced = os.fsync

        def fsync(file: Any) -> None:
            number = file if isinstance(file, int) else file.fileno()
            synced(number)
            self.lasting.add(os.fstat(number).st_ino)

        os.fsync = fsync
        sys.addaudithook(self.hear)

    def hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event not in WRITES or self.left < 0:
            return
        if event == "open" and not (isinstance(arguments[2], int) and arguments[2] & (os.O_WRONLY | os.O_RDWR)):
            return
        path = os.path.abspath(os.fsdecode(arguments[0])) if isinstance(arguments[0], str | bytes | os.PathLike) else ""
        if not path.startswith(self.folder):
            return
        if self.left == 0:
            self.left = -1
            self.cut()
        self.left -= 1
        self.written.append(os.path.abspath(os.fsdecode(arguments[1])) if event == "os.rename" else path)

    def cut(self) -> None:
        for path in dict.fromkeys(self.written[-4:] if self.torn is not None else []):
            if os.path.isfile(path) and os.stat(path).st_ino not in self.lasting and self.torn.random() < 0.6:
                os.truncate(path, int(os.path.getsize(path) * self.torn.random() * self.torn.integers(0, 2)))
        os.kill(os.getpid(), signal.SIGKILL)


def writes_of(words: Words, out: Path) -> int:
    """How often a command writes below its folder."""
    told = out.with_suffix(".writes")

    def prepare() -> None:
        cut, exit_ = PowerCut(out, 10**9), os._exit
        cut()

        def leave(code: int) -> None:
            told.write_text(str(len(cut.written)))
            exit_(code)

        os._exit = leave

    code, message = in_fork(words, prepare)
    assert code == 0, message
    return int(told.read_text())


def goes_on(out: Path, words: Words, call: Callable[[Words], tuple[int, str]]) -> tuple[str, list[str]]:
    """Resume what was killed, or begin it again where resume says that it had not begun; how, and what is wrong."""
    code, message = call(["resume", str(out), "--quiet", "--no-report"])
    if code == 2 and (NOT_BEGUN in message or "not been begun" in message):
        code, message = call(words)
        return "begun again", [] if code == 0 else [f"cannot be begun again: {message.strip()}"]
    return "resumed", [] if code == 0 else [f"exit code {code}: {message.strip()[:300]}"]


def cuts(numbers: range, seed: int, scratch: Path) -> Iterator[Case]:
    """Power cuts, so many a command, at writes spread over it, half of them torn."""

    number = 0
    for command in COMMANDS:
        job = write_lot(scratch / command, seed)
        whole = scratch / command / "whole"
        here(words_of(command, job, scratch / command / "warm"))  # what it imports and compiles, its forks have
        writes = writes_of(words_of(command, job, whole), whole)
        true = essence(whole)
        for write in np.unique(((np.array(numbers) + 0.5) / len(numbers) * writes).astype(int)):
            rng = np.random.default_rng([seed, number])
            torn = rng if rng.random() < 0.5 else None
            out = scratch / command / f"cut{write}"
            words = words_of(command, job, out)
            code, message = in_fork(words, PowerCut(out, int(write), torn))
            case = Case(number, f"{command}: power cut {'torn ' if torn is not None else ''}ahead of write {write}", "")
            if code != -signal.SIGKILL:
                case.faults.append(f"was not cut: {code} {message[-300:]}")
            case.came, faults = goes_on(out, words, in_fork)
            case.faults += faults or differences(true, essence(out))
            yield case
            if not case.faults:
                shutil.rmtree(out)
            number += 1


VICTIMS: dict[str, Callable[[list[int]], list[int]]] = {
    "main": lambda pids: pids[:1],
    "server": lambda pids: pids[2:3],
    "worker": lambda pids: pids[3:][-1:],
    "all": list,
}
"""Of the processes of a command, by age: the main one, the tracker of Python's resources, the server that workers are
forked from, and these, which are there while there is work for them."""
LONG = 1500
"""Generations of a search that can be hit."""


def chances(cases: range, seed: int, scratch: Path) -> Iterator[Case]:
    """Commands in processes of their own, of which some are killed at a time by chance."""
    jobs = {command: write_lot(scratch / f"by chance {command}", seed) for command in COMMANDS}
    true, lasts = {}, {}
    for command, job in jobs.items():
        job.write_text(job.read_text().replace("generations: 6", f"generations: {LONG}"))
        for attempt in ("cold", "warm"):
            whole, start = job.parent / attempt, time.monotonic()
            subprocess.run([*PROGRAM, *beside(command, job, whole)], check=True, capture_output=True)
            true[command], lasts[command] = essence(whole), time.monotonic() - start
    for number in cases:
        rng = np.random.default_rng([seed, number])
        command = COMMANDS[rng.integers(len(COMMANDS))]
        victim = "main" if command == "improve" else list(VICTIMS)[rng.integers(len(VICTIMS))]  # it works alone
        out = jobs[command].parent / f"out{number}"
        words = beside(command, jobs[command], out)
        after, struck = rng.uniform(0.1, 0.8) * lasts[command], False
        while not struck:  # it was over before: again, sooner
            shutil.rmtree(out, ignore_errors=True)
            struck, code, message = killed(words, victim, after)
            assert struck or code == 0, message
            how, after = f"{command}: {victim} killed after {after:.1f} s", after / 2
        case, faults = Case(number, how, "came to its end"), []
        if victim in ("main", "all"):
            case.came, faults = goes_on(out, words, in_process)
        elif code != 0:
            case.came, faults = "failed", [f"exit code {code}: {message[-300:]}"]
        case.faults += faults or differences(true[command], essence(out))
        yield case
        if not case.faults:
            shutil.rmtree(out)


PROGRAM = [sys.executable, "-m", "pzt_ident"]


def beside(command: str, job: Path, out: Path) -> Words:
    """A command whose tasks run in other processes."""
    return [*words_of(command, job, out), "--workers", "2"]


def in_process(words: Words) -> tuple[int, str]:
    ended = subprocess.run([*PROGRAM, *words], capture_output=True, text=True, timeout=300)
    return ended.returncode, ended.stderr


def killed(words: Words, victim: str, after: float) -> tuple[bool, int, str]:
    """Whether somebody was killed, at that time or as soon as there was one; exit code and standard error."""
    process = subprocess.Popen(
        [*PROGRAM, *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    time.sleep(after)
    while not (pids := VICTIMS[victim](family(process.pid))) and process.poll() is None:
        time.sleep(0.01)
    struck = process.poll() is None
    for pid in pids:
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
    message = process.communicate(timeout=300)[1]
    return struck, process.returncode, message


def family(main: int) -> list[int]:
    """The processes of a session that are at work, by age."""
    ages = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            facts = stat.read_text().rpartition(")")[2].split()
            if int(facts[3]) == main and facts[0] != "Z":
                ages.append((int(facts[19]), int(stat.parent.name)))
    return [pid for _, pid in sorted(ages)]
