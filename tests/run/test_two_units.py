"""Two axes whose responses are in two units: each number of an axis stands with its own, everywhere."""

import json
import re
import shutil
from html import unescape
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from pzt_ident.cli.commands import main
from pzt_ident.data.units import factor
from pzt_ident.model.registry import blocks
from pzt_ident.report.search_figures import _levels
from pzt_ident.report.sentences import remaining_error
from pzt_ident.report.side_by_side import write_side_by_side
from pzt_ident.report.tables import make_tables
from pzt_ident.run.results import read_folder
from pzt_ident.workbench import page_state as view
from pzt_ident.workbench.session import Session
from pzt_ident.workbench.session_results import gathered
from workbench.conftest import form

TOGETHER = "(x and y together)"
NOISE = {"x": 10e-9, "y": 16e-9}  # m
TESTED = ("quadratic_gain", "creep")
JOB = """\
name: small
records:
  - {file: first.csv, use: identify}
  - {file: second.csv, use: validate}
channels:
  time: "time [s]"
  axes:
    x: {drive: "u_x [V]", response: "x [um]"}
    y: {drive: "u_y [V]", response: "y [UNIT]"}
model: [bouc_wen]
parameters: {bouc_wen.alpha: {value: 0}, bouc_wen.beta: {value: 0.01}, bouc_wen.gamma: {value: 0}}
optimizers:
  - {name: pso, population: 12, generations: 15}
repeats: 1
rule_out: [RULED_OUT]
"""


def drive_of(most, samples=900, rest=150):
    moving = 0.5 * most * (1 - np.cos(2 * np.pi * np.arange(samples) / 300)) * np.linspace(1, 0.5, samples)
    return np.concatenate([np.zeros(rest), moving, np.zeros(rest)])


def write_job(folder: Path, unit: str, second: str | None = None) -> Path:
    """x in um and y in `unit`, of the second record in another one where that is given: both bent in the same way."""
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(5)
    for name, most, own in (("first", 100, unit), ("second", 80, second or unit)):
        drive = {"x": drive_of(most), "y": drive_of(0.9 * most)[::-1].copy()}
        columns = {"time [s]": 5e-3 * np.arange(drive["x"].size)}
        columns |= {f"u_{axis} [V]": values for axis, values in drive.items()}
        for axis, of in (("x", "um"), ("y", own)):
            clean = 0.08e-6 * drive[axis] * (1 + 2e-3 * drive[axis])
            columns[f"{axis} [{of}]"] = (clean + rng.normal(0, NOISE[axis], clean.size)) / factor(of)
        table = np.column_stack([*columns.values()])
        np.savetxt(folder / f"{name}.csv", table, delimiter=",", header=",".join(columns), comments="", fmt="%.12g")
    ruled_out = ", ".join(word for word in blocks.effects() if word not in TESTED)
    text = JOB.replace("UNIT", unit).replace("RULED_OUT", ruled_out)
    if second:
        own = f'channels: {{y.response: "y [{second}]"}}'
        text = text.replace("second.csv, use: validate", f"second.csv, use: validate, {own}")
    (folder / "job.yaml").write_text(text, encoding="utf-8")
    return folder / "job.yaml"


def call(*arguments) -> str:
    answer = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert answer.exit_code == 0, answer.output
    return answer.stdout


def read(path: Path):
    return json.loads(path.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """The same data with y in nm and in um: the folders of a run, a diagnosis and an improvement, what each said."""
    return {unit: finished(tmp_path_factory.mktemp(unit), unit) for unit in ("nm", "um")}


def finished(folder, unit):
    job, said = write_job(folder / "job", unit), {}
    said["run"] = call("run", job, "--out", folder / "run")
    for command in ("diagnose", "improve"):
        said[command] = call(command, job, "--out", folder / command, "--no-report")
    said["compare"] = call("compare", folder / "run", "--no-report")
    return folder, said


@pytest.fixture(params=["nm", "um"])
def made(request, both):
    """The unit of y, and what there is of it."""
    return request.param, *both[request.param]


def physical(result) -> dict[str, float]:
    """RMSE and noise floor of each axis in m, as the units in the file say, by what they are."""
    units = result["units"]
    found = {f"floor {axis}": value * factor(units[axis]) for axis, value in result["noise_floor"].items()}
    for record in result["records"]:
        found |= {f"{record['name']} {axis}": value * factor(units[axis]) for axis, value in record["rmse"].items()}
    found["floor"] = result["floor"] * factor(result["unit"])
    rmse = result["best"]["rmse"] if "best" in result else result["rmse"]
    return found | {use: value * factor(result["unit"]) for use, value in rmse.items()}


@pytest.mark.parametrize("file", ["run/result.json", "diagnose/diagnosis.json"])
def test_the_same_data_in_two_units_are_the_same_physics(both, file):
    nanometres, micrometres = (read(folder / file) for folder, _ in both.values())
    assert (nanometres["unit"], micrometres["unit"]) == ("um", "um")
    assert (nanometres["units"], micrometres["units"]) == ({"x": "um", "y": "nm"}, {"x": "um", "y": "um"})
    assert physical(nanometres) == pytest.approx(physical(micrometres), rel=1e-6)
    for one, other in zip(nanometres["records"], micrometres["records"], strict=True):
        assert one["rmse"]["y"] == pytest.approx(1000 * other["rmse"]["y"], rel=1e-6)


@pytest.mark.parametrize("file", ["run/result.json", "diagnose/diagnosis.json"])
def test_what_is_over_axes_is_the_root_mean_square_of_theirs(made, file):
    found = physical(read(made[1] / file))
    for whole, parts in (("identify", "first"), ("validate", "second"), ("floor", "floor")):
        assert found[whole] == pytest.approx(np.hypot(found[f"{parts} x"], found[f"{parts} y"]) / 2**0.5)
    for axis, noise in NOISE.items():
        assert found[f"floor {axis}"] == pytest.approx(noise, rel=0.2)


def test_every_file_says_the_unit_of_each_axis(made):
    unit, folder, _ = made
    files = ("run/result", "run/residuals", "diagnose/diagnosis", "diagnose/residuals", "improve/improvement")
    for file in files:
        assert read(folder / f"{file}.json")["units"] == {"x": "um", "y": unit}
    for axis, found in read(folder / "run/residuals.json")["axes"].items():
        assert found["noise_floor"] == read(folder / "run/result.json")["noise_floor"][axis]
        assert found["unit"] == {"x": "um", "y": unit}[axis]
    events = map(json.loads, (folder / "improve/events.jsonl").read_text().splitlines())
    stair = next(event for event in events if event["event"] == "stair")
    assert stair["units"] == {"x": "um", "y": unit} and f"RMSE {TOGETHER}" in stair["said"]
    improvement = read(folder / "improve/improvement.json")
    size = {axis: factor(of) for axis, of in improvement["units"].items()}
    for step in improvement["steps"]:
        own = [value * size[axis] for axis, value in step["records"][0]["rmse"].items()]
        assert step["rmse"]["identify"] * 1e-6 == pytest.approx(np.sqrt(np.mean(np.square(own))))


def test_tables_have_it_in_their_headings(made):
    unit, folder, _ = made
    result = read(folder / "run/result.json")
    table = pd.read_csv(folder / "run/tables/records.csv")
    assert table["rmse_x [um]"].tolist() == [record["rmse"]["x"] for record in result["records"]]
    assert table[f"rmse_y [{unit}]"].tolist() == [record["rmse"]["y"] for record in result["records"]]
    printed = make_tables(read_folder(folder / "run"))["records"].text
    assert {"RMSE x [µm]", f"RMSE y [{unit.replace('u', 'µ')}]"} <= set(printed)
    for name in ("league", "runs"):
        headings = pd.read_csv(folder / f"run/tables/{name}.csv").columns
        assert all(TOGETHER in heading for heading in headings if "[um]" in heading)
    for name, table in make_tables(read_folder(folder / "improve")).items():
        pooled = [heading for heading in [*table.data, *table.text] if re.search(r"\[[uµ]m\]", heading)]
        assert all(TOGETHER in heading for heading in pooled) and (pooled or name == "changes")


@pytest.mark.parametrize("command", ["run", "diagnose", "improve"])
def test_the_terminal_says_it(made, command):
    unit, folder, said = made
    name = {"run": "result", "diagnose": "diagnosis", "improve": "improvement"}[command]
    result, text = read(folder / command / f"{name}.json"), said[command]
    assert f"noise floor of x [um]: {result['noise_floor']['x']:.4g}\n" in text
    assert f"noise floor of y [{unit}]: {result['noise_floor']['y']:.4g}\n" in text
    assert f"noise floor {TOGETHER} [um]: {result['floor']:.4g}\n" in text
    assert f"RMSE {TOGETHER}" in text


def test_compare_says_it(made):
    unit, folder, said = made
    for axis, found in read(folder / "run/residuals.json")["axes"].items():
        own = {"x": "um", "y": unit}[axis]
        row = next(line for line in said["compare"].splitlines() if line.startswith(f"{axis}  "))
        assert row.split()[:5] == [axis, *(f"{found[key]:.4g}" for key in ("rmse", "noise_floor", "misfit")), own]


def text_of(page: Path) -> str:
    words = unescape(re.sub(r"<[^>]+>", " ", page.read_text(encoding="utf-8").split("<main>")[1]))
    return re.sub(r"\s+", " ", words)


def test_the_report_says_it(made):
    unit, folder, _ = made
    page, result = text_of(folder / "run/report.html"), read(folder / "run/result.json")
    floors = page[page.index("Noise floor ", page.index("Correlations")) :]
    found = dict(re.findall(r"(axis \w|all axes \(x and y together\)) ([\d.]+ \S+) RMS", floors))
    values = {name: float(text.split()[0]) * factor(text.split()[1]) for name, text in found.items()}
    assert values == pytest.approx(
        {"axis x": physical(result)["floor x"], "axis y": physical(result)["floor y"]}
        | {f"all axes {TOGETHER}": physical(result)["floor"]},
        rel=5e-3,
    )
    for axis in "xy":
        misfit = re.search(rf"Axis {axis}: RMSE ([\d.]+) (\S+), noise floor ([\d.]+) (\S+) ", page)
        size = factor(misfit[2])
        assert misfit[2] == misfit[4] == {"x": "µm", "y": unit.replace("u", "µ")}[axis]
        assert float(misfit[3]) * size == pytest.approx(values[f"axis {axis}"], rel=5e-3)
        assert float(misfit[1]) * size > float(misfit[3]) * size


def test_the_figures_compare_like_with_like(made):
    _, folder, _ = made
    results = read_folder(folder / "run")
    assert {name: level for name, level, _ in _levels(results)} == {
        "best, polished": results.best["rmse"]["identify"],
        "noise floor": results.floor,
    }
    drawn = (folder / "run/figures/convergence-180mm.svg").read_text(encoding="utf-8")
    assert f"best RMSE so far {TOGETHER} [µm]" in drawn


def test_the_sentences_say_it(made):
    _, folder, _ = made
    for name in ("run", "diagnose"):
        results = read_folder(folder / name)
        found = physical(results.facts)
        ratios = sorted(found[f"second {axis}"] / found[f"floor {axis}"] for axis in "xy")
        said = remaining_error(results).replace("\u00a0", " ")
        amount, first, last = re.search(
            r"RMSE is ([\d.]+) µm \(x and y together\) .* ([\d.]+) to ([\d.]+) ", said
        ).groups()
        assert float(amount) * 1e-6 == pytest.approx(found["validate"], rel=5e-3)
        assert [float(first), float(last)] == pytest.approx(ratios, rel=0.05)


def test_side_by_side_draws_no_floor_of_another_unit(both, tmp_path):
    folders = [folder / "run" for folder, _ in both.values()]
    page = write_side_by_side(folders, tmp_path / "both.html").read_text(encoding="utf-8")
    content = json.loads(re.search(r'id="content">(.*?)</script>', page, re.S)[1])
    assert list(content["floors"]) == ["x"]
    rows = pd.read_csv(tmp_path / "both/results.csv")
    floors = [read(folder / "result.json")["floor"] for folder in folders]
    assert rows["noise_floor"].tolist() == pytest.approx(floors) and set(rows["axes"]) == {"x and y together"}
    assert f"µm {TOGETHER}" in page


@pytest.fixture
def step(made, tmp_path, monkeypatch):
    """A workbench whose first step has the run and the diagnosis."""
    unit, folder, _ = made
    monkeypatch.chdir(tmp_path)
    for name in ("first", "second"):
        shutil.copy(folder / f"job/{name}.csv", tmp_path)
    bench = Session(tmp_path, tmp_path / "workbench")
    channels = {
        axis: {
            "drive": {"header": f"u_{axis} [V]", "number": number, "unit": "V"},
            "response": {"header": f"{axis} [{of}]", "number": number + 2, "unit": of},
        }
        for number, (axis, of) in enumerate((("x", "um"), ("y", unit)), 2)
    }
    bench.begin(form(records=[{"file": "first.csv", "use": "identify"}], axes=channels))
    fill(bench, folder)
    return bench, unit, folder


def fill(bench, folder):
    shutil.copytree(folder / "run", bench.step() / "run")
    shutil.copytree(folder / "diagnose", bench.step() / "diagnosis")


def test_the_workbench_says_it(step):
    bench, unit, folder = step
    state, result = view.state(bench), read(folder / "run/result.json")
    shown = {"x": "µm", "y": unit.replace("u", "µ")}
    assert (state["unit"], state["together"]) == ("µm", f" {TOGETHER}")
    for part in ("result", "misfit", "diagnosis"):
        assert state[part]["units"] == shown
    assert state["result"]["floor"] == result["floor"]
    signals = view.signals(bench)
    assert {(record["axis"], record["unit"]) for record in signals["records"]} == set(shown.items())
    assert signals["floors"] == result["noise_floor"]


def test_the_stairs_of_the_workbench_stand_on_the_floor_of_all_axes(step):
    bench, _, folder = step
    bench.add("creep")
    fill(bench, folder)
    found, result = read(gathered(bench) / "improvement.json"), read(folder / "run/result.json")
    for key in ("unit", "units", "noise_floor", "floor"):
        assert found[key] == result[key]


def test_a_record_in_another_unit_is_shown_in_that_of_the_first(tmp_path, both):
    call("run", write_job(tmp_path / "job", "nm", "um"), "--out", tmp_path / "run")
    results = read_folder(tmp_path / "run")
    assert physical(results.result) == pytest.approx(physical(read(both["nm"][0] / "run/result.json")), rel=1e-6)
    assert {(trace.axis, trace.unit) for trace in results.traces} == {("x", "um"), ("y", "nm")}
