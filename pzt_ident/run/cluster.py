"""A cluster of Dask's as the place where tasks run."""

from __future__ import annotations

import pickle
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from queue import Empty, SimpleQueue
from threading import Lock
from typing import TYPE_CHECKING, Any, ClassVar
from uuid import uuid4

from pzt_ident.errors import InputError, LostError
from pzt_ident.files import plain, temporary_files_in
from pzt_ident.run.cluster_members import SECONDS_TO_JOIN, joined
from pzt_ident.run.computing import computing
from pzt_ident.run.interrupts import interrupts_deferred
from pzt_ident.run.pool import (
    SECONDS_DEAF,
    Arguments,
    Done,
    Entry,
    Event,
    Failures,
    Tasks,
    Tell,
    attempt_away,
    forget,
)

if TYPE_CHECKING:
    from distributed import Client, Future
    from distributed.deploy import Cluster as DaskCluster

NO_PROFILES = "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED=False"  # a worker's memory would be filled with them
AHEAD = 2
"""Tasks that are on their way to each thread of the cluster."""
ATTEMPTS = 3
"""How often a task is sent whose outcome a living scheduler lost."""
SECONDS_WITHOUT_WORKERS = 60.0
SECONDS_BETWEEN_EVENTS = 1.0
FREQUENT = ("generation", "fitted", "scored", "refitted")
"""Events of which the last one says it all."""


class Cluster:
    """Runs tasks on the workers of a Dask scheduler; `words` name it."""

    shares_disk: ClassVar[bool] = False
    words: str

    @contextmanager
    def client(self) -> Iterator[Client]:
        raise NotImplementedError

    def run_all(self, entry: Entry, common: Arguments, tasks: Tasks, tell: Tell, done: Done = forget) -> Failures:
        """As of `Place`. The data of a task stand in Dask's graph, so that they are sent again where they were lost."""
        from distributed.comm import CommClosedError

        with quiet_dask(), self.client() as client, interrupts_deferred() as check:
            try:
                tell(joined(client, self.words))
                return Session(client, self.words, entry, common, tell, done).run(iter(tasks), check)
            except CommClosedError:
                raise lost(self.words) from None


@dataclass(frozen=True)
class Scheduler(Cluster):
    """A scheduler that runs already, by its address."""

    words: str

    @contextmanager
    def client(self) -> Iterator[Client]:
        from distributed import Client

        try:
            client = Client(self.words, timeout=SECONDS_TO_JOIN, set_as_default=False)
        except (OSError, ValueError) as error:
            remedy = "is it a scheduler of Dask's, of the same version?"
            raise InputError("does not answer as a scheduler", where=f"--on {self.words}", remedy=remedy) from error
        try:
            yield client
        finally:
            client.close(timeout=2)


@dataclass(frozen=True)
class Slurm(Cluster):
    """Jobs of one core each in a partition of SLURM; account, memory and time are those of Dask's `jobqueue.yaml`."""

    words: str
    partition: str
    jobs: int

    def cluster(self) -> DaskCluster:
        import dask
        from dask_jobqueue import SLURMCluster

        memory = dask.config.get("jobqueue.slurm.memory", None) or "2 GB"
        prologue = [*(dask.config.get("jobqueue.slurm.job-script-prologue", None) or []), f"export {NO_PROFILES}"]
        return SLURMCluster(queue=self.partition, cores=1, processes=1, memory=memory, job_script_prologue=prologue)

    @contextmanager
    def client(self) -> Iterator[Client]:
        from distributed import Client

        with self.cluster() as cluster, Client(cluster, set_as_default=False) as client:
            cluster.scale(self.jobs)
            yield client


class Session:
    """One call of `run_all` on a client."""

    def __init__(self, client: Client, words: str, entry: Entry, common: Arguments, tell: Tell, done: Done) -> None:
        self.client, self.words, self.entry, self.tell, self.done = client, words, entry, tell, done
        self.arrived: SimpleQueue[Event | tuple[str, Future]] = SimpleQueue()
        self.topic = f"pzt-ident-{uuid4().hex}"
        self.client.subscribe_topic(self.topic, lambda event: self.arrived.put(event[1]))
        self.data = pickle.dumps(common)
        self.common: Future | None = None
        self.running: dict[str, Future] = {}
        self.sent: dict[str, list[Arguments]] = {}
        self.failed: Failures = {}
        self.threads, self.counted, self.staffed = 0, 0.0, time.monotonic()

    def run(self, tasks: Iterator[tuple[str, Arguments]], check: Callable[[], None]) -> Failures:
        try:
            while True:
                check()
                for name, arguments in islice(tasks, max(self.room(), 0)):
                    self.begin(name, arguments)
                if not self.running:
                    return self.failed
                self.take(SECONDS_DEAF)
        finally:
            self.client.unsubscribe_topic(self.topic)
            if self.client.status == "running":
                self.client.cancel([*self.running.values(), *([self.common] if self.common else [])])

    def room(self) -> int:
        """How many tasks may be sent. Raises LostError where the scheduler is gone, or every worker for long."""
        if self.client.status != "running":
            raise lost(self.words)
        now = time.monotonic()
        if now - self.counted > 1:
            self.threads, self.counted = sum(self.client.nthreads().values()), now
        if self.threads:
            self.staffed = now
        elif now - self.staffed > SECONDS_WITHOUT_WORKERS and self.client.cluster is None:
            raise LostError(f"every worker of {self.words} is gone")
        return AHEAD * max(self.threads, 1) - len(self.running)

    def begin(self, name: str, arguments: Arguments) -> None:
        attempts = self.sent.setdefault(name, [])
        attempts.append(arguments)
        key, raw = f"{self.topic}-{name}-{len(attempts)}", pickle.dumps(arguments)
        if self.common is None or self.common.cancelled():
            self.common = self.client.submit(bytes, self.data, key=f"{key}-common")
        future = self.client.submit(attempt_there, self.entry, self.common, raw, self.topic, key=key, pure=False)
        self.running[name] = future
        future.add_done_callback(lambda future: self.arrived.put((name, future)))

    def take(self, seconds: float) -> None:
        """Deal with what has arrived, and wait for it if nothing has."""
        try:
            arrival = self.arrived.get(timeout=seconds)
            while True:
                if isinstance(arrival, dict):
                    self.tell(arrival)
                else:
                    self.end(*arrival)
                arrival = self.arrived.get_nowait()
        except Empty:
            return

    def end(self, name: str, future: Future) -> None:
        if future.status == "finished":
            kind, content = future.result()
        elif future.status == "error":
            kind, content = "failed", reason_of(future.exception())
        elif len(self.sent[name]) < ATTEMPTS and self.client.status == "running":
            return self.begin(name, self.sent[name][0])
        else:
            raise lost(self.words)
        if kind == "stopped":
            raise content
        del self.running[name], self.sent[name]
        if kind == "done":
            self.done(name, content)
        else:
            self.failed[name] = content
            self.tell({"event": "failed", "run": name, "reason": content})


def lost(words: str) -> LostError:
    return LostError(f"the scheduler {words} is gone")


def reason_of(error: BaseException | None) -> str:
    from distributed.scheduler import KilledWorker

    if isinstance(error, KilledWorker):
        return f"each of the {error.allowed_failures + 1} workers that were at it ended"
    return f"it could not be run there: {error}"


_alone = Lock()


def attempt_there(entry: Entry, common: bytes, arguments: bytes, topic: str) -> tuple[str, Any]:
    """What a thread of a Dask worker does. One at a time in a process: optimizers borrow the random state of theirs.
    Temporary files lie in the worker's own folder, which Dask removes once the worker is gone."""
    from distributed import get_worker

    worker = get_worker()

    def tell(event: Event) -> None:
        worker.log_event(topic, plain(event))

    with _alone, computing(), temporary_files_in(worker.local_directory):
        return attempt_away(entry, (*pickle.loads(common), *pickle.loads(arguments)), thinned(tell))


def thinned(tell: Tell) -> Tell:
    """Tells on; of frequent events one a second."""
    latest = 0.0

    def tell_some(event: Event) -> None:
        nonlocal latest
        now = time.monotonic()
        if event["event"] in FREQUENT:
            if now - latest < SECONDS_BETWEEN_EVENTS:
                return
            latest = now
        tell(event)

    return tell_some


@contextmanager
def quiet_dask() -> Iterator[None]:
    """Dask's logs and warnings are not for a user of this package: what matters is told."""
    import logging
    import warnings

    log = logging.getLogger("distributed")
    level, disabled = log.level, logging.root.manager.disable
    log.setLevel(logging.CRITICAL)
    logging.disable(logging.ERROR)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logging.disable(disabled)
        log.setLevel(level)
