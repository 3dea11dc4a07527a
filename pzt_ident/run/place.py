"""Where tasks run: in processes of this machine, or on a cluster. Which of them is said by words such as `local:4`."""

from __future__ import annotations

import re
import socket
from dataclasses import dataclass
from importlib.util import find_spec
from shutil import which
from typing import ClassVar, Protocol

from pzt_ident.errors import InputError
from pzt_ident.run.pool import Arguments, Done, Entry, Failures, Tasks, Tell, forget, run_all

WORDS = "write local, local:4, tcp://scheduler:8786 or slurm:PARTITION:8"
SECONDS_TO_ANSWER = 10.0


class Place(Protocol):
    """Runs tasks and tells what they tell. shares_disk: whether they can use the files of this process."""

    shares_disk: ClassVar[bool]

    def run_all(self, entry: Entry, common: Arguments, tasks: Tasks, tell: Tell, done: Done = forget) -> Failures:
        """Call entry(tell, *common, *arguments) for each named task, give what it returns to done(name, result), and
        return the reason for each that failed. `common` goes to a worker once. What a worker that was killed was at is
        done again. Tasks are taken as there is room, so that a million of them need no more memory than a few.

        Raises LostError where the place itself is gone, OSError where a disk there has no room.
        """


@dataclass(frozen=True)
class Local:
    """Processes of this machine; as many as it has cores unless their number is given. Without a number what is soon
    done may as well be done in the process that asks for it."""

    shares_disk: ClassVar[bool] = True
    workers: int | None = None

    def run_all(self, entry: Entry, common: Arguments, tasks: Tasks, tell: Tell, done: Done = forget) -> Failures:
        return run_all(entry, common, tasks, self.workers, tell, done)


HERE = Local()


def place_of(words: str) -> Place:
    """The place that words name. Raises InputError where they name none, nobody answers there, or Dask is missing."""
    if match := re.fullmatch(r"local(?::([1-9]\d*))?", words):
        return Local(int(match[1]) if match[1] else None)
    if match := re.fullmatch(r"(?:tcp|tls)://(\[[^\]]+\]|[^\s/:]+):(\d+)", words):
        _check_dask(words, "distributed")
        _check_answers(words, match[1].strip("[]"), int(match[2]))
        from pzt_ident.run.cluster import Scheduler

        return Scheduler(words)
    if match := re.fullmatch(r"slurm:([\w.,-]+):([1-9]\d*)", words):
        _check_dask(words, "dask_jobqueue")
        if not which("sbatch"):
            remedy = "run it on a machine that jobs are submitted from"
            raise InputError("there is no SLURM here (no command sbatch)", where=f"--on {words}", remedy=remedy)
        from pzt_ident.run.cluster import Slurm

        return Slurm(words, match[1], int(match[2]))
    raise InputError("is no place to run at", where=f"--on {words}", remedy=WORDS)


def _check_dask(words: str, module: str) -> None:
    if not find_spec(module):
        raise InputError("needs Dask", where=f"--on {words}", remedy="pip install 'pzt-ident[cluster]'")


def _check_answers(words: str, host: str, port: int) -> None:
    try:
        socket.create_connection((host, port), SECONDS_TO_ANSWER).close()
    except (OSError, OverflowError) as error:
        problem = f"no scheduler answers: {getattr(error, 'strerror', None) or error}"
        remedy = f"is it the right address? `dask scheduler --port {port}` starts one, `dask worker {words}` a worker"
        raise InputError(problem, where=f"--on {words}", remedy=remedy) from None
