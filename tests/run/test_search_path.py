"""Files beside the data that are named like modules: none of them is run."""

import os
import subprocess
import sys
import sysconfig
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from pzt_ident.run.pool import without_working_folder
from pzt_ident.workbench.runner import Runner
from workbench.conftest import alone

JOB = """\
records: [{file: data.csv, use: identify}]
channels:
  time: time [s]
  axes: {x: {drive: "u [V]", response: "x [um]"}}
model: [bouc_wen]
optimizers: [{name: pso, population: 4, generations: 3}, {name: cma_es, budget: 40}]
polish: false
"""
ARGUMENTS = ["run", "job.yaml", "--out", "out", "--no-report", "--quiet"]
NOTEBOOK = """\
import sys
from pathlib import Path

import h5py, multiprocessing.popen_forkserver, multiprocessing.resource_tracker, pandas
from pzt_ident.job.schema import load_job
from pzt_ident.run.identify import run
from pzt_ident.run.summary import summary_of

job = load_job(Path("job.yaml"))
summary_of(job)  # imports what the notebook's own process takes
sys.path.insert(0, "")
run(job, Path("out"))
assert sys.path[0] == ""
"""
SCRIPT = [str(Path(sysconfig.get_path("scripts")) / "pzt-ident"), *ARGUMENTS]


@pytest.fixture
def baited(tmp_path):
    """A job beside its data and a file for every module that there is, each of which leaves its name in `ran`."""
    (tmp_path / "job.yaml").write_text(JOB, encoding="utf-8")
    rows = [f"{i / 100},{50 - abs(50 - i % 100)},{4 - abs(4 - i / 12.5 % 8):.3f}" for i in range(300)]
    (tmp_path / "data.csv").write_text("time [s],u [V],x [um]\n" + "\n".join(rows) + "\n", encoding="utf-8")
    for name in {*sys.stdlib_module_names, *packages_distributions(), "sitecustomize", "usercustomize"}:
        if name.isidentifier():
            text = f"with open({str(tmp_path / 'ran')!r}, 'a') as ran: ran.write({name + ' '!r})\n"
            (tmp_path / f"{name}.py").write_text(text, encoding="utf-8")
    return tmp_path


def ran(folder):
    return (folder / "ran").read_text().split() if (folder / "ran").exists() else []


@pytest.mark.parametrize("line", [SCRIPT, [sys.executable, "-P", "-c", NOTEBOOK]], ids=["script", "notebook"])
def test_no_file_beside_the_data_is_run(baited, line):
    done = subprocess.run(line, cwd=baited, capture_output=True, text=True, timeout=60)
    assert (ran(baited), done.returncode) == ([], 0), done.stderr
    assert (baited / "out" / "result.json").exists()


def test_nor_by_a_command_of_the_workbench(baited):
    async def story():
        runner = Runner(baited, lambda: None)
        await runner.run("run", ARGUMENTS)
        await runner.close()

    alone(story())
    assert ran(baited) == []
    assert (baited / "out" / "result.json").exists()


def test_nor_as_a_module_once_python_has_found_it(baited):
    for path in baited.glob("*.py"):
        if path.stem not in ("json", "numpy", "click", "pydantic"):
            path.unlink()
    subprocess.run([sys.executable, "-m", "pzt_ident", "check", "job.yaml", "--json"], cwd=baited, check=True)
    assert ran(baited) == []


def test_each_of_the_two_guards_holds_and_is_taken_down(monkeypatch):
    """One is for processes that are forked, the other for those that are started anew."""
    for flag in (None, "1"):
        monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
        if flag:
            monkeypatch.setenv("PYTHONSAFEPATH", flag)
        monkeypatch.setattr(sys, "path", before := ["", *sys.path])
        with without_working_folder():
            assert "" not in sys.path
            assert os.environ["PYTHONSAFEPATH"] == "1"
        assert sys.path is before
        assert os.environ.get("PYTHONSAFEPATH") == flag
