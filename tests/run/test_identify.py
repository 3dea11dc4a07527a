"""From a job to results on the disk, interrupted and killed on the way."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import measured
from pzt_ident.errors import InputError, RunError
from pzt_ident.job.schema import Job, load_job
from pzt_ident.model.chain import Chain
from pzt_ident.run.checkpoint import Checkpoint, Generation, read_losses
from pzt_ident.run.identify import resume, run, tasks_of
from pzt_ident.run.misfit import compare
from pzt_ident.run.place import Local
from pzt_ident.run.statement import Statement
from pzt_ident.run.task import search

JOB = """\
name: small
records:
  - {file: identify.csv, use: identify}
  - {file: validate.csv, use: validate, settle: 0.1 s}
channels:
  time: "time [s]"
  axes:
    x: {drive: "u_x [V]", response: "x [um]"}
model: [bouc_wen]
optimizers:
  - {name: pso, population: 20, generations: 40}
  - {name: pso_vmax, population: 20, generations: 40}
repeats: 2
seed: 3
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("job")
    t = np.arange(1000) / 1000
    rng = np.random.default_rng(0)
    for name, u in {"identify": 50 * (1 - np.cos(6 * np.pi * t)), "validate": 80 * np.abs(np.sin(9 * t)) * t}.items():
        measured.write(folder / f"{name}.csv", t, u, measured.lagging(u, rng))
    (folder / "job.yaml").write_text(JOB)
    return folder


@pytest.fixture(scope="module")
def finished(folder):
    events = []
    out = run(load_job(folder / "job.yaml"), folder / "out", place=Local(2), listen=events.append)
    return out, events


def numbers(out: Path) -> list:
    """All that must not differ between two runs of a job: everything but the clock."""
    result = json.loads((out / "result.json").read_text())
    clock = ("seconds", "cpu_seconds", "polish_seconds")
    return [{key: value for key, value in item.items() if key not in clock} for item in result["runs"]]


def test_everything_is_on_the_disk(finished):
    out, _ = finished
    names = (
        "job.yaml",
        "result.json",
        "residuals.json",
        "history.csv",
        "signals.nc",
        "events.jsonl",
        "environment.json",
    )
    for name in names:
        assert (out / name).stat().st_size > 0
    assert (out / "job.yaml").read_text() == JOB
    residuals = (out / "residuals.json").read_text()
    compare(out, out)
    assert (out / "residuals.json").read_text() == residuals
    assert not list(out.rglob("*.tmp"))


def test_result_says_what_the_contract_promises(finished):
    result = json.loads((finished[0] / "result.json").read_text())
    assert result["unit"] == "um"
    assert {(r["optimizer"], r["repeat"]) for r in result["runs"]} == {
        (o, r) for o in ("pso", "pso_vmax") for r in (0, 1)
    }
    for item in result["runs"]:
        assert item["rmse"]["identify"] <= item["rmse_before_polish"]["identify"]
        assert item["evaluations"] == 800
        assert set(item["parameters"]["bouc_wen.gain"]) >= {"value", "unit", "standard_error", "verdict"}
    assert result["best"]["rmse"]["identify"] == min(r["rmse"]["identify"] for r in result["runs"])
    assert result["noise_floor"]["x"] == pytest.approx(0.01, rel=0.2)
    assert [row["optimizer"] for row in result["league"]]
    for record, settle in zip(result["records"], (0.0, 0.1), strict=True):
        assert (record["samples"], record["axes"], record["notes"]) == (1000, ["x"], [])
        assert (record["sample_rate"], record["settle"]) == (pytest.approx(1000), pytest.approx(settle))
        assert record["rmse"] == {"x": pytest.approx(result["best"]["rmse"][record["use"]], rel=1e-6)}


@pytest.mark.parametrize(
    ("stop", "target", "evaluations"),
    [
        ("", None, 800),
        ("stop: {target: 20 nm}", 20e-9, 800),
        ("stop: {target: 0.03, evaluations: 70}", 30e-9, 70),
    ],
)
def test_every_search_ends_at_the_same_error_and_with_the_budget_of_the_first(folder, stop, target, evaluations):
    """A target without a unit is in that of the response, um."""
    larger = JOB.replace("pso_vmax, population: 20", "pso_vmax, population: 30")
    tasks = tasks_of(Statement(Job.from_text(larger + stop, folder)), folder)
    assert [task.run for task in tasks] == ["pso-0", "pso-1", "pso_vmax-0", "pso_vmax-1"]
    for task in tasks:
        assert task.stop["evaluations"] == evaluations
        assert task.stop["target"] == (None if target is None else pytest.approx(target))


def test_signals_give_back_the_rmse(finished):
    import h5netcdf

    result = json.loads((finished[0] / "result.json").read_text())
    with h5netcdf.File(finished[0] / "signals.nc") as file:
        for use, skip in (("identify", 0), ("validate", 100)):
            group = file[use]
            residual = group["residual_x"][skip:]
            assert np.sqrt(np.mean(residual**2)) == pytest.approx(result["best"]["rmse"][use], rel=1e-6)
            np.testing.assert_allclose(group["model_x"][:] - group["response_x"][:], group["residual_x"][:], atol=1e-9)
            assert group["response_x"].attrs["units"] == "um"


def test_events_tell_the_story_in_the_users_unit(finished):
    out, events = finished
    lines = [json.loads(line) for line in (out / "events.jsonl").read_text().splitlines()]
    assert lines == events
    assert events[0]["event"] == "start" and events[-1]["event"] == "done"
    assert events[0]["budget"] == 4 * 800
    last = [e for e in events if e["event"] == "generation" and e["run"] == "pso-0"][-1]
    result = json.loads((out / "result.json").read_text())
    own = next(r for r in result["runs"] if r["run"] == "pso-0")["rmse_before_polish"]["identify"]
    assert (last["evaluations"], last["best"]) == (800, pytest.approx(own))


def test_a_run_killed_hard_goes_on_to_the_same_result(folder, finished, tmp_path):
    out = tmp_path / "killed"
    job = f"load_job(Path({str(folder / 'job.yaml')!r}))"
    script = (
        "from pathlib import Path; from pzt_ident.job.schema import load_job; from pzt_ident.run.identify import run\n"
        "from pzt_ident.run.place import Local\n"
        f"if __name__ == '__main__': run({job}, Path({str(out)!r}), place=Local(1))"
    )
    process = subprocess.Popen([sys.executable, "-c", script], start_new_session=True)
    deadline = time.monotonic() + 60
    told = out / "runs" / "pso-1.losses"
    while time.monotonic() < deadline and not (told.exists() and len(list(read_losses(told))) > 5):
        time.sleep(0.002)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    assert not (out / "result.json").exists()
    with told.open("ab") as file:
        file.write(b"torn")
    resume(out, place=Local(2))
    assert numbers(out) == numbers(finished[0])


def heed_ctrl_c():
    """A shell lets what it runs in the background ignore it, and so would all that a test run there starts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.parametrize("searching", [False, True])
def test_ctrl_c_ends_all_processes_and_says_how_to_go_on(folder, tmp_path, searching):
    out = tmp_path / "out"
    (tmp_path / "job.yaml").write_text((folder / "job.yaml").read_text().replace("{file: ", f"{{file: {folder}/"))
    edit(tmp_path / "job.yaml", "generations: 40", "generations: 1000000")
    command = [sys.executable, "-m", "pzt_ident", "run", str(tmp_path / "job.yaml"), "--out", str(out)]
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, start_new_session=True, preexec_fn=heed_ctrl_c
    )
    first = out / "runs" / "pso-0.losses" if searching else out / "events.jsonl"
    while not (first.exists() and first.stat().st_size):
        assert process.poll() is None
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGINT)
    said = process.communicate(timeout=60)[1]  # returns when the last process that could say something has ended
    assert process.returncode == 130
    assert said.endswith(f"`pzt-ident resume {out}` goes on from here\nError: interrupted\n")
    assert "Traceback" not in said


def test_a_search_that_goes_on_counts_the_seconds_that_it_had(folder, tmp_path):
    """Half its generations are on the disk, the last of them after 1000 s."""
    statement, told = Statement(load_job(folder / "job.yaml")), []
    task = tasks_of(statement, tmp_path)[0]
    search(task, statement, told.append)
    whole = json.loads(task.result.read_text())
    half = Checkpoint()
    half.generations = [Generation(1000.0, losses) for _, losses in [*read_losses(task.losses)][:20]]
    half.save(task.losses)
    search(task, statement, told.append)
    result = json.loads(task.result.read_text())
    assert 1000 < result["seconds"] < 1100
    assert len([*read_losses(task.losses)]) == 40
    assert all(seconds >= 1000 for seconds, _ in read_losses(task.losses))
    assert (result["evaluations"], result["rmse"]) == (whole["evaluations"], whole["rmse"])


def test_bad_data_leave_nothing_behind(folder, tmp_path):
    (tmp_path / "job.yaml").write_text(JOB)
    with pytest.raises(InputError, match=r"identify\.csv"):
        run(load_job(tmp_path / "job.yaml"), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_full_folder_is_not_written_into(folder, finished):
    with pytest.raises(InputError, match="not empty") as caught:
        run(load_job(folder / "job.yaml"), finished[0])
    assert "resume" in caught.value.remedy


def test_a_folder_that_may_not_be_written_into_is_told_with_a_remedy(folder, tmp_path, monkeypatch):
    monkeypatch.setattr("os.access", lambda path, mode: Path(path) != tmp_path)
    with pytest.raises(InputError, match=f"{tmp_path}: Permission denied") as caught:
        run(load_job(folder / "job.yaml"), tmp_path)
    assert "--out" in caught.value.remedy


def test_what_another_program_left_is_not_resumed(folder, tmp_path):
    (tmp_path / "job.yaml").write_text("of another program")
    with pytest.raises(InputError, match="not empty") as caught:
        run(load_job(folder / "job.yaml"), tmp_path)
    assert "resume" not in caught.value.remedy


def test_resume_needs_a_run(tmp_path):
    with pytest.raises(InputError, match="holds no run"):
        resume(tmp_path)


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


def test_resume_of_a_finished_run_searches_nothing(finished, tmp_path):
    out, events = shutil.copytree(finished[0], tmp_path / "out"), []
    resume(out, listen=events.append)
    assert [event["event"] for event in events] == ["finished", "done"]
    assert (out / "result.json").read_bytes() == (finished[0] / "result.json").read_bytes()


def test_resume_counts_only_what_is_missing(finished, tmp_path):
    out, events = shutil.copytree(finished[0], tmp_path / "out"), []
    (out / "runs" / "pso-1.json").unlink()
    resume(out, place=Local(1), listen=events.append)
    assert (events[0]["runs"], events[0]["budget"]) == (["pso-1"], 800)
    assert numbers(out) == numbers(finished[0])


@pytest.mark.parametrize(
    ("file", "old", "new"), [("identify.csv", "\n0.001,", "\n0.0010001,"), ("out/job.yaml", "seed: 3", "seed: 4")]
)
def test_resume_refuses_another_job_or_other_data(folder, finished, tmp_path, file, old, new):
    made = shutil.copytree(folder, tmp_path / "job")
    edit(made / "out" / "environment.json", str(folder), str(made))
    assert resume(made / "out")
    edit(made / file, old, new)
    with pytest.raises(InputError) as caught:
        resume(made / "out")
    assert caught.value.where == str(made / file)
    assert "began with" in caught.value.message or "since this run began" in caught.value.message


def hopeless(folder: Path, polish: str) -> Job:
    """A job in which all but very few of the candidates overflow."""
    bounds = "parameters:\n  bouc_wen.beta: {bounds: [-60, 1]}\n  bouc_wen.gamma: {bounds: [-60, 60]}\n"
    text = JOB.replace("model: [bouc_wen]", "model: [bouc_wen]\n" + bounds).replace("pso_vmax", "rga")
    return Job.from_text(text + f"polish: {polish}\n", folder)


@pytest.mark.parametrize("polish", ["true", "false"])
def test_candidates_that_overflow_are_infinite_and_counted(folder, tmp_path, polish):
    out = run(hopeless(folder, polish), tmp_path / "out", place=Local(1))
    result = json.loads((out / "result.json").read_text())
    assert result["failed_runs"] == []
    for item in result["runs"]:
        told = np.concatenate([losses for _, losses in read_losses(out / "runs" / f"{item['run']}.losses")])
        assert item["failed_simulations"] >= np.isinf(told).sum() > 100
        assert item["rmse_before_polish"]["identify"] == pytest.approx(told.min() * 1e6)
        assert item["rmse"]["identify"] <= item["rmse_before_polish"]["identify"]
    for line in (out / "events.jsonl").read_text().splitlines():
        json.loads(line, parse_constant=pytest.fail)


def test_where_every_candidate_overflows_the_run_says_so(folder, tmp_path):
    bounds = "parameters:\n  bouc_wen.beta: {bounds: [-400, -300]}\n  bouc_wen.gamma: {bounds: [-1, 1]}\n"
    job = Job.from_text(JOB.replace("model: [bouc_wen]", "model: [bouc_wen]\n" + bounds), folder)
    with pytest.raises(RunError) as caught:
        run(job, tmp_path / "out", place=Local(1))
    said = "every run failed: the simulation of each of its 800 candidates failed: narrow the bounds"
    assert str(caught.value) == said


def test_a_model_is_made_once_a_process(folder, tmp_path, monkeypatch):
    """By the checks of the job; the run, its search and what is collected go on with it."""
    made = []
    init = Chain.__init__
    monkeypatch.setattr(Chain, "__init__", lambda self, *parts: (made.append(parts), init(self, *parts))[1])
    job = load_job(folder / "job.yaml")
    run(job, tmp_path / "out", place=Local(1))
    assert len(made) == 1
    statement = Statement(Job.from_text(job.text, folder), Statement(job).records)
    search(tasks_of(statement, tmp_path / "worker")[0], statement, lambda event: None)
    assert len(made) == 2
