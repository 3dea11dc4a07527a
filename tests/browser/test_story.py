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

from browser.conftest import faults_of
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
  window.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true }));
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


def tab_to(page, target):
    """Go to an element by the tabulator."""
    for _ in range(60):
        page.keyboard.press("Tab")
        if page.evaluate("target => document.activeElement.matches(target)", target):
            return
    raise AssertionError(f"{target} is not reached")


def idle(page):
    expect(page.locator("body.busy")).to_have_count(0)


def test_from_the_file_drop_to_the_fallen_error(workbench, page, tmp_path):
    page.goto(workbench())
    expect(page.locator("#verdict")).to_contain_text("Drop a measurement")
    assert faults_of(page) == []
    names = ["identify.csv", "validate.csv"]
    page.evaluate(DROP, [names, [thinned(text(name)) for name in names]])
    expect(page.locator("#loop canvas.drawn")).to_be_visible()  # the loop, before any choice
    expect(page.locator(".files .record")).to_have_count(2)
    assert roles(page) == ["time", "x.drive", "x.response"]
    expect(page.locator("#guess")).to_contain_text(re.compile(r"sample rate50 Hz.*noise floor of x0\.00\d+ µm"))
    assert faults_of(page) == []
    page.locator("#confirm").dblclick()
    expect(page.locator("#convergence canvas").first).to_be_attached()
    expect(page.locator("#action")).to_have_text("Add quadratic_gain")
    idle(page)
    first = read(tmp_path / "workbench/steps/1/run/result.json")["best"]["rmse"]
    expect(page.locator(".stairs text.value")).to_have_count(2)

    page.locator("#action").dblclick()
    expect(page.locator("#action")).to_have_text("Add creep")
    idle(page)
    expect(page.locator(".stairs text.name")).to_have_text(["as given", "+ quadratic_gain"])
    expect(page.locator(".readout")).to_contain_text(re.compile(r"model: RMSE 0\.0.*model before: RMSE 0\.0"))
    second = read(tmp_path / "workbench/steps/2/run/result.json")["best"]["rmse"]
    assert second["identify"] < 0.6 * first["identify"] and second["validate"] < 0.4 * first["validate"]
    assert len(state_of(tmp_path)["steps"]) == 2

    page.click("#tab-commands")
    with page.expect_download() as download:
        page.click("text=job.yaml")
    saved = Path(download.value.path()).read_text(encoding="utf-8")
    assert saved.startswith("# Made in the workbench.") and "effects: [quadratic_gain]" in saved
    page.locator("#undo").dblclick()
    expect(page.locator(".stairs text.name")).to_have_text(["as given"])
    expect(page.locator("#action")).to_have_text("Add quadratic_gain")
    idle(page)
    assert state_of(tmp_path)["at"] == 1
    page.click("#tab-steps")
    expect(page.locator("#step-2")).to_contain_text(re.compile(r"2: \+ quadratic_gain.*RMSE 0\.0\d+ µm"))

    with page.context.expect_page() as opened:
        page.click("#report")
    report = opened.value
    expect(report.locator(".readout")).to_contain_text("Whole record")
    expect(report.locator("#word-bouc_wen a").last).to_have_attribute("href", "/atlas#word-bouc_wen")
    assert (tmp_path / "workbench/steps/1/run/report.html").exists()


def test_a_reload_at_the_columns_loses_no_choice(workbench_here, page):
    page.goto(workbench_here())
    page.evaluate(DROP, [["identify.csv"], [text("identify.csv")]])
    expect(page.locator(".handle.split")).to_be_visible()
    page.select_option("[aria-label='Role of u_x [V]']", "y.drive")
    page.get_by_label("Name of the job").fill("bench-7")
    page.keyboard.press("Tab")
    page.select_option("[aria-label='Role of u_x [V]']", "x.drive")
    page.locator(".handle.settle").focus()
    page.keyboard.press("ArrowRight")
    field = page.locator("[aria-label$='not scored for, in seconds']")
    expect(field).not_to_have_value("0")
    settle = field.input_value()
    page.reload()  # at once
    expect(page.locator("[aria-label$='not scored for, in seconds']")).to_have_value(settle)
    assert roles(page) == ["time", "x.drive", "x.response"]
    assert page.get_by_label("Name of the job").input_value() == "bench-7"


def test_a_handle_keeps_the_focus_when_the_measurement_is_drawn_again(workbench_here, page):
    page.goto(workbench_here())
    page.evaluate(DROP, [["identify.csv"], [text("identify.csv")]])
    expect(page.locator("#guess")).to_contain_text("sample rate")
    page.route("**/measurement", lambda route: (time.sleep(0.3), route.continue_()))
    with page.expect_response("**/measurement"):
        page.select_option("[aria-label='Role of u_x [V]']", "y.drive")
        page.select_option("[aria-label='Role of u_x [V]']", "x.drive")
        settle = page.locator(".handle.settle")
        settle.focus()
    page.wait_for_timeout(300)
    expect(settle).to_be_focused()


def test_a_crop_past_the_part_for_validation_leaves_a_job_that_can_be_read(workbench_here, page, tmp_path):
    page.goto(workbench_here())
    header, *rows = text("identify.csv").splitlines()
    cells = rows[70].split(",")
    rows[70] = ",".join([*cells[:-1], ""])
    still = [
        ",".join([time, "50", x])
        for time, _, x in (row.split(",") for row in thinned(text("identify.csv")).splitlines()[1:])
    ]
    page.evaluate(DROP, [["still.csv"], ["\n".join([header, *still]) + "\n"]])
    constant = "u_x [V] is constant at 50 V: give the drive of x another column, or drop a record in which it moves."
    expect(page.locator("#next")).to_have_text(constant)
    expect(page.locator("#action")).to_be_hidden()
    expect(page.locator("#loop canvas.drawn")).to_be_visible()
    expect(page.locator("#time .legend")).to_have_text(["measured", "drive"])
    assert "drive of x" not in page.locator("[aria-label='Role of u_x [V]']").text_content()
    page.click("#confirm")
    expect(page.locator("#error p")).to_have_text(constant)
    page.evaluate(DROP, [["identify.csv"], ["\n".join([header, *rows]) + "\n"]])
    expect(page.locator("#next")).to_contain_text("choose a record in which it moves for identification")
    page.click("[aria-label='Remove still.csv']")
    expect(page.locator("#action")).to_have_text("Confirm and identify")
    expect(page.locator("#guess")).to_contain_text("1 of x [um]: crop the record, or fill the gaps in the file")
    start, end, settle = (page.get_by_label(f"identify.csv: {name}") for name in ("From", "to,", "not scored for"))
    for field, typed in (start, str(0.8 * float(end.input_value()))), (settle, "1e6"), (start, ""):
        field.fill(typed)
        field.press("Tab")
    expect(start).not_to_have_value("")
    expect(settle).not_to_have_value("1e6")
    assert float(start.input_value()) > 0 and 0 < float(settle.input_value()) < float(end.input_value())
    page.click("#confirm")
    expect(page.locator("#stop")).to_be_visible()
    first, second = load_job(tmp_path / "workbench/steps/1/job.yaml").records
    assert first.rows[0] == second.rows[0] < first.rows[1] < second.rows[1]


def test_nothing_is_said_of_a_session_before_it_is_known(workbench_here, page):
    address, held = workbench_here(), []
    page.route("**/api/state*", lambda route: held.append(route))
    page.goto(address)
    expect(page.locator("#verdict")).to_have_text("The session is being opened.")
    expect(page.locator("#welcome")).to_be_hidden()
    for route in held:
        route.continue_()
    expect(page.locator("#verdict")).to_contain_text("Drop a measurement")
    expect(page.locator("#welcome")).to_be_visible()


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_reload_a_killed_worker_and_a_killed_workbench_lose_nothing(workbench, page, tmp_path):
    for name in ("identify.csv", "validate.csv"):
        (tmp_path / name).write_text(text(name), encoding="utf-8")
    (tmp_path / "job.yaml").write_text(LONG, encoding="utf-8")
    page.goto(workbench("job.yaml"))
    page.click("#action")
    expect(page.locator("#status")).to_contain_text("best RMSE 0.0")

    page.reload()
    expect(page.locator("#status")).to_contain_text(re.compile(r"Identifying: \d+ s, \d+ %, best RMSE 0\.0\d+ µm"))
    expect(page.locator("#convergence canvas").first).to_be_attached()

    for pid, parents in [(pid, running(tmp_path)) for pid in running(tmp_path)]:
        if depth(pid, parents) == 3:
            os.kill(pid, signal.SIGKILL)  # its search is begun again from what it was told
    page.reload()
    expect(page.locator("#status")).to_contain_text("best RMSE 0.0")
    expect(page.locator("#error")).to_be_hidden()

    page.goto("about:blank")  # or it would complain
    os.kill(next(pid for pid in running(tmp_path) if depth(pid, running(tmp_path)) == 0), signal.SIGKILL)
    assert ended(tmp_path)  # the command and its workers, too, by themselves
    page.goto(workbench("job.yaml"))
    expect(page.locator("#verdict")).to_have_text("The run was interrupted before it finished.")
    expect(page.get_by_text("Resume continues from here.")).to_have_count(1)
    expect(page.locator("#action")).to_have_text("Resume")
    page.click("#action")
    expect(page.locator("#status")).to_contain_text("best RMSE 0.0")

    page.click("#stop")
    expect(page.locator("#verdict")).to_have_text("Stopped.")
    expect(page.get_by_text("Resume continues from here.")).to_have_count(1)
    expect(page.locator("#error")).to_be_hidden()
    assert load_job(tmp_path / "workbench/steps/1/job.yaml").text.startswith("# a search that does not end")
    assert {depth(pid, running(tmp_path)) for pid in running(tmp_path)} <= {0, 1}  # one waits to be asked


def test_a_session_whose_last_step_is_gone_opens_at_the_one_before(workbench_here, page, tmp_path):
    for name in ("identify.csv", "validate.csv"):
        (tmp_path / name).write_text(thinned(text(name)), encoding="utf-8")
    (tmp_path / "job.yaml").write_text(LONG, encoding="utf-8")
    workbench_here("job.yaml")
    state = state_of(tmp_path)
    state["steps"].append({"number": 2, "parent": 1, "change": "+ creep"})
    (tmp_path / "workbench" / "state.json").write_text(json.dumps(state | {"at": 2}))
    page.goto(workbench_here("job.yaml"))
    expect(page.locator("#error p")).to_contain_text("Step 2 cannot be opened")
    expect(page.locator("#action")).to_be_enabled()
    expect(page.locator(".stairs text.name")).to_have_text("as given")


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


def test_a_file_of_markup_is_shown_as_text(workbench_here, page):
    page.goto(workbench_here())
    header = '<img src=x onerror=document.title="owned"> [V],"<script>document.title=1</script> [um]"'
    rows = "\n".join(f"{i % 30},{i % 30 / 9}" for i in range(90))
    page.evaluate(DROP, [["a.csv"], [f"{header}\n{rows}\n"]])
    expect(page.locator("table.guessed td").first).to_contain_text("<img src=x")
    assert page.title() == "pzt-ident workbench"
    assert page.locator("#columns img, #columns script").count() == 0


def test_sheets_axes_and_what_is_left_open(workbench_here, page, tmp_path):
    rows = [
        ["t [s]", "u1 [V]", "u2 [V]", "p1 [nm]", "p2 [nm]"],
        *([i / 9, i % 5, i % 7, i % 3, i % 4] for i in range(90)),
    ]
    write_sheets(tmp_path / "rig.xlsx", Notes=[["Rig 3"]], Loops=rows, Check=rows)
    page.goto(workbench_here())
    page.click("#here button")
    expect(page.locator("table.guessed tr")).to_have_count(6)
    assert roles(page) == ["time", "x.drive", "y.drive", "x.response", "y.response"]
    page.click("text=Add another")
    expect(page.locator(".files .record")).to_have_count(2)
    page.select_option("[aria-label='Role of p1 [nm]']", "y.response")
    assert roles(page) == ["time", "x.drive", "y.drive", "y.response", ""]
    page.select_option("[aria-label='Role of u2 [V]']", "")
    page.click("#confirm")
    expect(page.locator("#error p")).to_have_text("Which column is the drive of y?")
    page.select_option("[aria-label='Role of p1 [nm]']", "x.response")
    page.click("#more summary")
    page.click(".chip:text-is('lumped')")
    page.click("#confirm")
    expect(page.locator("#stop")).to_be_visible()
    page.click("#stop")
    idle(page)
    job = load_job(tmp_path / "workbench/steps/1/job.yaml")
    assert [(record.sheet, record.use) for record in job.records] == [("Loops", "identify"), ("Check", "validate")]
    assert (list(job.channels.axes), job.model) == (["x"], ("bouc_wen", "lumped"))
    page.reload()
    page.click("#undo")
    expect(page.locator("#confirm")).to_be_visible()
    assert roles(page) == ["time", "x.drive", "", "x.response", ""]


def test_signals_in_files_of_their_own_and_a_block_drawn_onto_the_chain(workbench_here, page):
    page.goto(workbench_here())
    expect(page.locator("#blocks li")).to_have_count(3)
    signals = ["\n".join(f"{i % period / 3}" for i in range(900)) for period in (30, 50)]
    drive, response = (
        {"name": f"{name}.csv", "mimeType": "text/csv", "buffer": signal.encode()}
        for name, signal in zip(("drive", "response"), signals, strict=True)
    )
    with page.expect_file_chooser() as opened:
        tab_to(page, "#choose")  # asks the page, which hears by then that its dialogs are waited for
        page.keyboard.press("Enter")
    opened.value.set_files([drive])
    expect(page.locator("#time canvas.drawn").first).to_be_visible()  # the one signal that is there
    expect(page.locator("#loop")).to_contain_text("The loop is drawn when there are a drive and a response.")
    page.set_input_files("#choose", [response])
    tab_to(page, "#confirm")  # from where the focus was left
    expect(page.locator(".files h3").first).to_contain_text("drive.csv + response.csv")
    assert roles(page) == ["x.drive", "x.response"]
    expect(page.locator(".files select").first).to_have_value("split")
    page.click("#more summary")
    for word in ("lumped", "prandtl_ishlinskii"):
        page.drag_and_drop(f".chip:text-is('{word}')", "#blocks")
    expect(page.locator("#blocks li")).to_have_text(["drive", "prandtl_ishlinskii×", "lumped×", "response"])
    page.click("#confirm")
    expect(page.locator("#error p")).to_have_text("Which column is the time? Or give the sample rate, such as 5 kHz.")
    fields = {"Sample rate": "5 kHz", "Name of the job": "bench 7", "Unit of response.csv": "nm/mm"}
    for name, typed in fields.items():
        page.get_by_label(name).click()
        page.keyboard.press("Control+A")
        page.keyboard.type(typed, delay=30)  # while the measurement is drawn again
    page.keyboard.press("Tab")
    for name, typed in fields.items():
        expect(page.get_by_label(name)).to_have_value(typed)
    expect(page.locator("#next")).to_have_text("Then identify a model of it.")
