"""What a user lives in the workbench, in a browser: from the file drop to the fallen error."""

import json
import os
import re
import signal
import sys
import time
from importlib.resources import files
from pathlib import Path

import pytest
from playwright.sync_api import expect

from pzt_ident.job.schema import load_job
from sheets import write_sheets

SAMPLE = files("pzt_ident.job").joinpath("examples", "demo")
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


def thinned(text):
    """Every fourth row."""
    header, *rows = text.splitlines()
    return "\n".join([header, *rows[::4]]) + "\n"


def roles(page):
    return [box.input_value() for box in page.locator("table.guessed select").all()]


def state_of(folder):
    return json.loads((folder / "workbench" / "state.json").read_text())


def read(path):
    return json.loads(path.read_text(encoding="utf-8"))


def test_from_the_file_drop_to_the_fallen_error(workbench, page, tmp_path):
    page.goto(workbench())
    expect(page.locator("#verdict")).to_contain_text("Drop a measurement")
    names = ["identify.csv", "validate.csv"]
    page.evaluate(DROP, [names, [thinned(text(name)) for name in names]])
    expect(page.locator("table.files tr")).to_have_count(3)
    assert roles(page) == ["time", "x.drive", "x.response"]
    page.click("#confirm")
    expect(page.locator("#convergence canvas")).to_have_count(1)
    expect(page.locator("#verdict")).to_contain_text("Missing: quadratic_gain")
    first = read(tmp_path / "workbench/steps/1/run/result.json")["best"]["rmse"]
    expect(page.locator(".staircase text.value")).to_have_count(2)

    page.click("#advice button[data-effect=quadratic_gain]")
    expect(page.locator(".staircase text.name")).to_have_text(["as given", "+ quadratic_gain"])
    expect(page.locator(".readout")).to_contain_text(re.compile(r"now: RMSE 0\.0.*before: RMSE 0\.0"))
    expect(page.locator(".staircase rect.validate:not(.live)")).to_have_count(2)
    second = read(tmp_path / "workbench/steps/2/run/result.json")["best"]["rmse"]
    assert second["identify"] < 0.6 * first["identify"] and second["validate"] < 0.4 * first["validate"]
    expect(page.locator("#verdict")).to_contain_text("Missing: creep")
    assert "pzt-ident add workbench/steps/1/job.yaml quadratic_gain" in page.text_content("#commands")

    with page.expect_download() as download:
        page.click("#save")
    saved = Path(download.value.path()).read_text(encoding="utf-8")
    assert saved.startswith("# Made in the workbench.") and "effects: [quadratic_gain]" in saved
    page.click("#undo")
    expect(page.locator(".staircase text.name")).to_have_text(["as given"])
    expect(page.locator("#verdict")).to_contain_text("Missing: quadratic_gain")
    assert state_of(tmp_path)["at"] == 1
    expect(page.locator("#others button")).to_have_text(re.compile(r"2: \+ quadratic_gain \(RMSE 0\.0\d+ µm\)"))

    with page.context.expect_page() as opened:
        page.click("#report")
    report = opened.value
    expect(report.locator(".explorer .readout")).to_contain_text("Whole record")
    assert (tmp_path / "workbench/steps/1/run/report.html").exists()


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_reload_a_killed_worker_and_a_killed_workbench_lose_nothing(workbench, page, tmp_path):
    for name in ("identify.csv", "validate.csv"):
        (tmp_path / name).write_text(text(name), encoding="utf-8")
    (tmp_path / "job.yaml").write_text(LONG, encoding="utf-8")
    page.goto(workbench("job.yaml"))
    page.click("#run")
    expect(page.locator("#status")).to_contain_text("best RMSE 0.0")

    page.reload()
    expect(page.locator("#status")).to_contain_text(re.compile(r"Identifying: \d+ s, \d+ %, best RMSE 0\.0"))
    expect(page.locator("#convergence canvas")).to_have_count(1)

    for pid, parents in [(pid, running(tmp_path)) for pid in running(tmp_path)]:
        if depth(pid, parents) == 3:
            os.kill(pid, signal.SIGKILL)
    expect(page.locator("#error")).to_contain_text("killed by signal 9")
    page.click("#run")
    expect(page.locator("#status")).to_contain_text("best RMSE 0.0")
    assert (tmp_path / "workbench" / "commands.txt").read_text().splitlines()[-1].startswith("pzt-ident resume")

    page.goto("about:blank")  # or it would complain
    os.kill(next(pid for pid in running(tmp_path) if depth(pid, running(tmp_path)) == 0), signal.SIGKILL)
    assert ended(tmp_path)  # the command and its workers, too, by themselves
    page.goto(workbench("job.yaml"))
    expect(page.locator("#error")).to_contain_text("interrupted before it finished. Resume continues from here.")
    expect(page.locator("#run")).to_have_text("Resume")
    page.click("#run")
    expect(page.locator("#status")).to_contain_text("best RMSE 0.0")

    page.click("#stop")
    expect(page.locator("#error")).to_contain_text("Stopped. Resume continues from here.")
    assert load_job(tmp_path / "workbench/steps/1/job.yaml").text.startswith("# a search that does not end")
    assert [depth(pid, running(tmp_path)) for pid in running(tmp_path)] == [0]


def running(folder):
    """The processes in a folder, and the parent of each."""
    parents = {}
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and Path(os.readlink(entry / "cwd")) == folder:
                parents[int(entry.name)] = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue
    return parents


def ended(folder):
    """Whether all processes in a folder come to their end."""
    return any(not running(folder) or time.sleep(0.05) for _ in range(400))


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


def test_sheets_axes_and_what_is_left_open(workbench, page, tmp_path):
    rows = [
        ["t [s]", "u1 [V]", "u2 [V]", "p1 [nm]", "p2 [nm]"],
        *([i / 9, i % 5, i % 7, i % 3, i % 4] for i in range(90)),
    ]
    write_sheets(tmp_path / "rig.xlsx", Notes=[["Rig 3"]], Loops=rows, Check=rows)
    page.goto(workbench())
    page.click("#here button")
    expect(page.locator("table.guessed tr")).to_have_count(6)
    assert roles(page) == ["time", "x.drive", "y.drive", "x.response", "y.response"]
    page.click("text=Add another")
    expect(page.locator("table.files tr")).to_have_count(3)
    page.select_option("[aria-label='Role of p1 [nm]']", "y.response")
    assert roles(page) == ["time", "x.drive", "y.drive", "y.response", ""]
    page.select_option("[aria-label='Role of u2 [V]']", "")
    page.click("#confirm")
    expect(page.locator("#error")).to_have_text("Which column is the drive of y?")
    page.select_option("[aria-label='Role of p1 [nm]']", "x.response")
    page.click(".chip:text-is('lumped')")
    page.click("#confirm")
    expect(page.locator("#stop")).to_be_visible()
    page.click("#stop")
    expect(page.locator("#run")).to_be_visible()
    job = load_job(tmp_path / "workbench/steps/1/job.yaml")
    assert [(record.sheet, record.use) for record in job.records] == [("Loops", "identify"), ("Check", "validate")]
    assert (list(job.channels.axes), job.model) == (["x"], ("bouc_wen", "lumped"))
    page.click("#undo")
    expect(page.locator("#verdict")).to_have_text("Check the columns and confirm them.")


def test_signals_in_files_of_their_own_and_a_block_drawn_onto_the_chain(workbench, page):
    page.goto(workbench())
    expect(page.locator("#blocks li")).to_have_count(3)
    signals = ["\n".join(f"{i % period / 3}" for i in range(900)) for period in (30, 50)]
    page.evaluate(DROP, [["drive.csv", "response.csv"], signals])
    expect(page.locator("table.files td").first).to_have_text("drive.csv + response.csv")
    assert roles(page) == ["x.drive", "x.response"]
    expect(page.locator("table.files select")).to_have_value("split")
    for word in ("lumped", "prandtl_ishlinskii"):
        page.drag_and_drop(f".chip:text-is('{word}')", "#blocks")
    expect(page.locator("#blocks li")).to_have_text(["drive", "prandtl_ishlinskii×", "lumped×", "response"])
    page.click("#confirm")
    expect(page.locator("#error")).to_have_text("Which column is the time? Or give the sample rate.")
