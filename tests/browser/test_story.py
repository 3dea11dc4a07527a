"""What a user lives in the workbench, in a browser: from the file drop to the fallen error."""

import json
import os
import re
import signal
import sys
from importlib.resources import files
from pathlib import Path

import pytest
from playwright.sync_api import expect

from pzt_ident.job import load_job

SAMPLE = files("pzt_ident").joinpath("sample")
LONG = """\
# a search that does not end by itself
name: long
records: [{file: identify.csv, use: identify}, {file: validate.csv, use: validate}]
channels:
  time: "time [s]"
  axes: {x: {drive: "u_x [V]", response: "x [um]"}}
model: [bouc_wen]
optimizers:
  - {name: pso, population: 20, generations: 1000000}
"""
DROP = """([names, texts]) => {
  const transfer = new DataTransfer();
  names.forEach((name, place) => transfer.items.add(new File([texts[place]], name)));
  document.getElementById("drop").dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true }));
}"""


def text(name):
    return SAMPLE.joinpath(name).read_text(encoding="utf-8")


def state_of(folder):
    return json.loads((folder / "workbench" / "state.json").read_text())


def read(path):
    return json.loads(path.read_text(encoding="utf-8"))


def test_from_the_file_drop_to_the_fallen_error(workbench, page, tmp_path):
    page.goto(workbench())
    expect(page.locator("#verdict")).to_contain_text("Drop a measurement")
    names = ["identify.csv", "validate.csv"]
    page.evaluate(DROP, [names, [text(name) for name in names]])
    expect(page.locator("table.files tr")).to_have_count(3)
    assert [page.locator("table.guessed select").nth(i).input_value() for i in range(3)] == [
        "time",
        "drive",
        "response",
    ]
    page.click("#confirm")
    expect(page.locator("#convergence canvas")).to_have_count(1)
    expect(page.locator("#verdict")).to_contain_text("Missing: quadratic_gain")
    first = read(tmp_path / "workbench/steps/1/run/result.json")["best"]["rmse"]
    expect(page.locator(".staircase text.value")).to_have_count(2)

    page.click("#advice button[data-effect=quadratic_gain]")
    expect(page.locator(".staircase text.name")).to_have_text(["as given", "+ quadratic_gain"])
    expect(page.locator("#verdict")).to_contain_text("Missing: creep")
    second = read(tmp_path / "workbench/steps/2/run/result.json")["best"]["rmse"]
    assert second["identify"] < 0.6 * first["identify"] and second["validate"] < 0.4 * first["validate"]
    expect(page.locator(".readout")).to_contain_text(re.compile(r"now: RMSE 0\.0.*before: RMSE 0\.0"))
    assert "pzt-ident add workbench/steps/1/job.yaml quadratic_gain" in page.text_content("#commands")

    with page.expect_download() as download:
        page.click("#save")
    saved = Path(download.value.path()).read_text(encoding="utf-8")
    assert saved.startswith("# Made in the workbench.") and "effects: [quadratic_gain]" in saved
    page.click("#undo")
    expect(page.locator(".staircase text.name")).to_have_text(["as given"])
    expect(page.locator("#verdict")).to_contain_text("Missing: quadratic_gain")
    assert state_of(tmp_path)["at"] == 1

    with page.context.expect_page() as opened:
        page.click("#report")
    report = opened.value
    expect(report.locator(".explorer .readout")).to_contain_text("Whole record")
    assert (tmp_path / "workbench/steps/1/run/report.html").exists()


@pytest.fixture
def searching(workbench, page, tmp_path):
    """A page that looks at a search without end."""
    for name in ("identify.csv", "validate.csv"):
        (tmp_path / name).write_text(text(name), encoding="utf-8")
    (tmp_path / "job.yaml").write_text(LONG, encoding="utf-8")
    page.goto(workbench("job.yaml"))
    page.click("#run")
    expect(page.locator("#status")).to_contain_text("best RMSE 0.0")
    return page


def test_a_reload_in_the_middle_of_a_run_loses_nothing(searching, tmp_path):
    searching.reload()
    expect(searching.locator("#status")).to_contain_text(re.compile(r"Identifying: \d+ s, \d+ %, best RMSE 0\.0"))
    expect(searching.locator("#convergence canvas")).to_have_count(1)
    searching.click("#stop")
    expect(searching.locator("#error")).to_contain_text("Stopped. Run goes on from here.")
    expect(searching.locator("#run")).to_have_text("Run on")
    assert load_job(tmp_path / "workbench/steps/1/job.yaml").text.startswith("# a search that does not end")
    assert not worker_pids(tmp_path)


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_killed_worker_is_named_and_the_page_lives_on(searching, tmp_path):
    for pid in worker_pids(tmp_path):
        os.kill(pid, signal.SIGKILL)
    expect(searching.locator("#error")).to_contain_text("killed by signal 9")
    expect(searching.locator("#run")).to_be_visible()
    searching.click("#run")
    expect(searching.locator("#status")).to_contain_text("best RMSE 0.0")
    assert (tmp_path / "workbench" / "commands.txt").read_text().splitlines()[-1].startswith("pzt-ident resume")
    searching.click("#stop")
    expect(searching.locator("#error")).to_contain_text("Stopped")


def worker_pids(folder):
    """The processes that search, by their place below the workbench of this folder."""
    if sys.platform != "linux":
        return []
    parents = {}
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and Path(os.readlink(entry / "cwd")) == folder:
                stat = (entry / "stat").read_text().rpartition(")")[2].split()
                parents[int(entry.name)] = int(stat[1])
        except OSError:
            continue
    return [pid for pid in parents if depth(pid, parents) == 3]


def depth(pid, parents):
    """0 for the workbench, 1 for its command, 2 for the server of processes, 3 for what that forks."""
    return 1 + depth(parents[pid], parents) if parents.get(pid) in parents else 0


def test_a_file_of_markup_is_shown_as_text(workbench, page):
    page.goto(workbench())
    header = '<img src=x onerror=document.title="owned"> [V],"<script>document.title=1</script> [um]"'
    rows = "\n".join(f"{i % 30},{i % 30 / 9}" for i in range(90))
    page.evaluate(DROP, [["a.csv"], [f"{header}\n{rows}\n"]])
    expect(page.locator("table.guessed td").first).to_contain_text("<img src=x")
    assert page.title() == "pzt-ident workbench"
    assert page.locator("#columns img, #columns script").count() == 0
