"""Tasks on a cluster of Dask's: a scheduler in a process of its own, workers that are killed, a scheduler that is."""

import errno
import json
import os
import signal
import tempfile
import time
from pathlib import Path
from threading import Thread

import numpy as np
import pytest

import measured
from experiments.fleet.cluster import TCP
from pzt_ident.errors import InputError, LostError
from pzt_ident.job.schema import load_job
from pzt_ident.run.cluster import Session
from pzt_ident.run.identify import resume, run
from pzt_ident.run.place import Local, place_of

distributed = pytest.importorskip("distributed")
JOB = """\
name: small
records:
  - {file: identify.csv}
channels:
  time: "time [s]"
  axes:
    x: {drive: "u_x [V]", response: "x [um]"}
model: [bouc_wen]
optimizers:
  - {name: pso, population: 20, generations: 40}
repeats: 4
seed: 3
"""


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    folder = tmp_path_factory.mktemp("job")
    t = np.arange(1000) / 1000
    u = 50 * (1 - np.cos(6 * np.pi * t))
    measured.write(folder / "identify.csv", t, u, measured.lagging(u, np.random.default_rng(0)))
    (folder / "job.yaml").write_text(JOB)
    return load_job(folder / "job.yaml")


@pytest.fixture(scope="module")
def cluster():
    cluster = TCP(workers=2)
    yield cluster
    cluster.end()


def numbers(out: Path) -> list:
    """All that must not differ between two runs of a job: everything but the clock."""
    result = json.loads((out / "result.json").read_text())
    clock = ("seconds", "cpu_seconds", "polish_seconds")
    return [{key: value for key, value in row.items() if key not in clock} for row in result["runs"]]


def test_the_same_result_bit_for_bit_on_a_cluster(job, cluster, tmp_path):
    events = []
    here = run(job, tmp_path / "here", place=Local(1))
    away = run(job, tmp_path / "there", place=place_of(cluster.address), listen=events.append)
    assert numbers(away) == numbers(here)
    assert "2 workers at " + cluster.address in next(e["said"] for e in events if e["event"] == "cluster")
    assert {event["run"] for event in events if event["event"] == "run"} == {f"pso-{i}" for i in range(4)}
    assert len(list((away / "runs").glob("*.losses"))) == 4


def slow_once(tell, folder, number):
    """Task 0 names its process and waits to be killed."""
    note = folder / "begun"
    if number == 0 and not note.exists():
        (folder / "scratch").write_text(tempfile.mkdtemp())
        note.write_text(str(os.getpid()))
        time.sleep(600)
    return number**2


def test_what_a_killed_worker_was_at_is_done_again(tmp_path):
    """By the other worker, and by the one that Dask's nanny puts in its place."""
    from distributed import LocalCluster

    def kill():
        while not ((tmp_path / "begun").exists() and (tmp_path / "begun").read_text()):
            time.sleep(0.02)
        os.kill(int((tmp_path / "begun").read_text()), signal.SIGKILL)

    results: dict = {}
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        Thread(target=kill, daemon=True).start()
        tasks = ((str(i), (i,)) for i in range(12))
        failed = place_of(cluster.scheduler_address).run_all(
            slow_once, (tmp_path,), tasks, lambda event: None, results.__setitem__
        )
    assert failed == {}
    assert results == {str(i): i**2 for i in range(12)}
    assert not Path((tmp_path / "scratch").read_text()).exists()


def test_a_task_whose_outcome_a_living_scheduler_lost_is_sent_again(cluster, tmp_path):
    class Forgetful(Session):
        def end(self, name, future):
            if name == "1" and len(self.sent[name]) == 1:
                future.cancel()
            super().end(name, future)

    results: dict = {}
    (tmp_path / "begun").write_text("by another")
    with distributed.Client(cluster.address, set_as_default=False) as client:
        session = Forgetful(client, "here", slow_once, (tmp_path,), lambda event: None, results.__setitem__)
        assert session.run(iter([(str(i), (i,)) for i in range(3)]), lambda: None) == {}
    assert results == {"0": 0, "1": 1, "2": 4}


def full(tell, number):
    raise OSError(errno.ENOSPC, "No space left on device", "losses")


def test_a_full_disk_of_a_worker_is_no_fault_of_the_task_but_ends_all(cluster):
    with pytest.raises(OSError, match="No space left on device: 'losses'"):
        place_of(cluster.address).run_all(full, (), [("1", (1,))], lambda event: None, lambda name, result: None)


def test_a_lost_scheduler_ends_in_a_folder_that_resume_goes_on_with(job, tmp_path):
    cluster, out = TCP(workers=1), tmp_path / "out"
    try:

        def kill_scheduler(event):
            if event["event"] == "run":
                cluster.scheduler.kill()

        with pytest.raises(LostError, match=f"the scheduler {cluster.address} is gone"):
            run(job, out, place=place_of(cluster.address), listen=kill_scheduler)
    finally:
        cluster.end()
    assert not (out / "result.json").exists()
    resume(out, place=Local(1))
    assert numbers(out) == numbers(run(job, tmp_path / "here", place=Local(1)))


def test_slurm_is_asked_for_jobs_of_one_core(monkeypatch):
    pytest.importorskip("dask_jobqueue")
    monkeypatch.setattr("pzt_ident.run.place.which", lambda name: f"/usr/bin/{name}")
    place = place_of("slurm:long.q:8")
    with place.cluster() as cluster:
        script = cluster.job_script()
    assert place.jobs == 8
    assert "#SBATCH -p long.q" in script
    assert "--nthreads 1" in script
    assert script.index("PROFILE__ENABLED=False") < script.index("--nthreads 1")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("lokal:2", "is no place to run at"),
        ("local:0", "is no place to run at"),
        ("tcp://host", "is no place to run at"),
        ("slurm:long", "is no place to run at"),
        ("slurm:long:8", "there is no SLURM here"),
        ("tcp://127.0.0.1:1", "no scheduler answers"),
        ("tcp://nowhere.invalid:8786", "no scheduler answers"),
    ],
)
def test_wrong_words_are_told_with_a_remedy(words, sentence, monkeypatch):
    monkeypatch.setattr("pzt_ident.run.place.which", lambda name: None)
    with pytest.raises(InputError, match=sentence) as caught:
        place_of(words)
    assert caught.value.where == f"--on {words}"
    assert caught.value.remedy


def test_a_missing_extra_is_named(monkeypatch):
    monkeypatch.setattr("pzt_ident.run.place.find_spec", lambda name: None)
    with pytest.raises(InputError, match="needs Dask") as caught:
        place_of("tcp://127.0.0.1:8786")
    assert "pip install 'pzt-ident[cluster]'" in caught.value.remedy
