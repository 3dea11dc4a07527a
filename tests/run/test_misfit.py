"""The failure atlas on the command line: what it writes, what it says, and its exit codes."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from pzt_ident.cli.commands import main
from pzt_ident.data.notation import spelled
from pzt_ident.data.signals import read_signals
from pzt_ident.job.example import write_example
from pzt_ident.run.misfit import compare
from pzt_ident.run.results import read_results
from run_folders import make_run

QUICK = """\
model: [bouc_wen]
optimizers:
  - {name: pso, population: 10, generations: 3}
polish: false
"""


def call(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def finished(tmp_path_factory) -> Path:
    """Two records whose model lacks a creep."""
    return make_run(tmp_path_factory.mktemp("finished"), names=("slow", "fast"))


@pytest.fixture
def folder(finished, tmp_path) -> Path:
    return Path(shutil.copytree(finished, tmp_path / "run"))


def test_a_folder_of_results(folder, tmp_path):
    before = {path.name for path in folder.iterdir()}
    answer = json.loads(call("compare", folder, "--out", tmp_path / "there", "--json").stdout)
    found = json.loads((tmp_path / "there" / "residuals.json").read_text())
    assert answer == {"folder": str(tmp_path / "there"), "residuals": found}
    assert (found["run"], found["unit"], list(found["axes"])) == ("pso-0", "um", ["x"])
    axis = found["axes"]["x"]
    assert axis["rmse"] ** 2 == pytest.approx(axis["noise_floor"] ** 2 + axis["misfit"] ** 2)
    assert axis["noise_floor"] == pytest.approx(0.049)
    drawn = {path.name for path in (tmp_path / "there" / "figures").iterdir()}
    stems = {f"misfit-{kind}-x-{width}mm" for kind in ("shares", "map", "worst") for width in (88, 180)}
    assert drawn == {f"{stem}.{form}" for stem in stems for form in ("svg", "pdf")}
    assert {path.name for path in folder.iterdir()} == before


def test_the_rmse_is_that_of_the_scored_residual(tmp_path):
    results = read_results(make_run(tmp_path / "run", axes=("x", "y")))
    found = compare(results.folder, tmp_path)
    for axis in "xy":
        own = [trace.residual[trace.scored] for trace in results.traces if trace.axis == axis]
        assert found["axes"][axis]["rmse"] == pytest.approx(np.sqrt(np.mean(np.concatenate(own) ** 2)))
        assert found["axes"][axis]["samples"] == sum(map(len, own))


def test_signals_come_back_in_si_units(finished):
    records, residuals = read_signals(finished / "signals.nc", ["slow", "fast"])
    traces = read_results(finished).traces
    assert [record.name for record in records] == ["slow", "fast"]
    assert [record.settle for record in records] == [20, 0]
    np.testing.assert_allclose(residuals[0][0], 1e-6 * traces[0].residual)
    np.testing.assert_allclose(records[1].response[0], 1e-6 * traces[1].response)
    np.testing.assert_allclose(records[1].time, traces[1].time)


@pytest.fixture
def without_figures(monkeypatch):
    """None in files of their own."""
    monkeypatch.setattr("pzt_ident.report.figures.write_misfit_figures", lambda results, folder: ())


def test_the_report_shows_it(folder, without_figures):
    (folder / "report.html").touch()
    assert call("compare", folder, "--quiet").output == ""
    page = (folder / "report.html").read_text()
    assert '<section id="misfit">' in page
    assert 'id="misfit-shares-x-caption"' in page and 'class="reveal"' in page
    for sentence in json.loads((folder / "residuals.json").read_text())["axes"]["x"]["sentences"]:
        assert spelled(sentence) in page


def test_a_job_is_run_first(tmp_path, without_figures):
    (job, *_) = write_example(tmp_path / "job")
    kept = job.read_text().partition("# Blocks of the model")[0]
    job.write_text(kept + QUICK)
    result = call("compare", job, "--out", tmp_path / "out")
    assert result.exit_code == 0, result.stderr
    assert (tmp_path / "out" / "result.json").exists()
    assert not (tmp_path / "out" / "report.html").exists()
    axis = json.loads((tmp_path / "out" / "residuals.json").read_text())["axes"]["x"]
    assert axis["misfit"] > 0
    assert {view["name"] for view in axis["views"]} >= {"record", "branch", "amplitude", "rate", "cycle", "position"}
    assert "axis x by" in result.stdout
    for sentence in axis["sentences"]:
        assert f"x: {sentence}" in result.stdout


def test_nothing_above_the_noise(tmp_path):
    folder = make_run(tmp_path / "run", noise_floor=5.0)
    result = call("compare", folder)
    assert result.stdout.endswith("x: Nothing is left above the noise.\n")
    assert not (folder / "figures").exists()


@pytest.mark.parametrize("source", ["nowhere.yaml", "."])
def test_bad_input(tmp_path, monkeypatch, source):
    monkeypatch.chdir(tmp_path)
    result = call("compare", source)
    assert result.exit_code == 2
    assert result.stderr.startswith("Error: ")
    assert not list(tmp_path.iterdir())
