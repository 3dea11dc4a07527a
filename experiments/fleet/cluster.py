"""A scheduler of Dask's and its workers, each a process of its own."""

import os
import socket
import subprocess
import sys
import time

from pzt_ident.run.cluster import NO_PROFILES


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class TCP:
    """A scheduler on TCP and its workers; they have no nannies: a worker that is killed stays away."""

    def __init__(self, workers: int) -> None:
        port = free_port()
        self.address = f"tcp://127.0.0.1:{port}"
        self.scheduler = self.start("dask_scheduler", "--port", str(port), "--host", "127.0.0.1", "--no-dashboard")
        self.workers = [self.worker() for _ in range(workers)]
        while not self.answers(port):
            assert self.scheduler.poll() is None
            time.sleep(0.05)

    def __enter__(self) -> "TCP":
        return self

    def __exit__(self, *error: object) -> None:
        self.end()

    def worker(self) -> subprocess.Popen:
        return self.start("dask_worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard")

    @staticmethod
    def start(program: str, *options: str) -> subprocess.Popen:
        line = [sys.executable, "-m", f"distributed.cli.{program}", *options]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(place for place in sys.path if place)}
        environment |= dict([NO_PROFILES.split("=")])
        return subprocess.Popen(line, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    @staticmethod
    def answers(port: int) -> bool:
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", port)) == 0

    def end(self) -> None:
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()
