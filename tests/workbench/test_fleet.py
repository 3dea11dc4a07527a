"""A lot beside a session: what its page may be asked for, and a device's results as steps."""

import shutil

import pytest

from experiments.fleet.lot import write_lot
from pzt_ident.errors import InputError
from pzt_ident.job.schema import load_job
from pzt_ident.lot.identify import fleet
from pzt_ident.model.registry import blocks
from pzt_ident.run.place import Local
from pzt_ident.workbench.app import make_app
from pzt_ident.workbench.fleet import Fleet
from pzt_ident.workbench.guard import below
from pzt_ident.workbench.session import Session

from .conftest import HOST, TOKEN, alone


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Two devices with effects that the job lacks, improved."""
    folder = tmp_path_factory.mktemp("lot")
    job = write_lot(folder, 2, 1, hidden=1.0, samples=300, swarm=(12, 15))
    others = ", ".join(word for word in blocks.effects() if word not in ("creep", "quadratic_gain"))
    job.write_text(f"{job.read_text(encoding='utf-8')}rule_out: [{others}]\n", encoding="utf-8")
    return fleet(load_job(job), [str(folder / "lot.csv")], folder / "out", improve=True, place=Local(2))


@pytest.fixture
def opened(made, tmp_path):
    """A workbench on the lot, which may be changed."""
    root = made.parent
    shutil.rmtree(root / "workbench", ignore_errors=True)
    return make_app(Session(root, root / "workbench"), {HOST}, TOKEN, Fleet(made))


def test_the_page_needs_its_key_and_its_facts_the_token(opened):
    from starlette.testclient import TestClient

    bench = opened.app.state.bench
    stranger = TestClient(opened, base_url=f"http://{HOST}", headers={"host": HOST})
    assert stranger.get("/lot/guessed").status_code == 404
    assert stranger.get("/api/lot").status_code == stranger.get("/api/lot_file?name=devices.csv").status_code == 403
    page = stranger.get(bench.fleet.url)
    assert page.status_code == 200 and "data-device" in page.text
    knowing = TestClient(opened, base_url=f"http://{HOST}", headers={"host": HOST, "x-pzt-token": TOKEN})
    assert knowing.get("/api/lot").json()["done"] == 2
    assert knowing.get("/api/lot_file?name=devices.csv").status_code == 200
    assert knowing.get("/api/lot_file?name=../job.yaml").status_code == 400


def test_an_improved_device_has_the_steps_of_its_improvement(opened, made):
    bench = opened.app.state.bench
    row = next(row for row in bench.fleet.lot.done if row["effects"] == ["creep"])
    name = row["device"]

    async def story():
        await bench.open_device(name)
        await bench.runner.task
        state = bench.state()
        await bench.close()
        return state

    state = alone(story())
    assert state["failure"] == "" and state["lot"]["device"] == name
    assert [step["change"] for step in state["steps"]] == ["as given", "+ creep"]
    assert state["steps"][0]["identify"] == row["rmse"]["identify"]
    assert state["steps"][-1]["identify"] == pytest.approx(row["rmse_improved"]["identify"], rel=0.01)
    assert state["diagnosis"]["verdict"] == row["verdict"]
    again = bench.fleet.session(name, bench.session.root, bench.folder / "devices", False)
    assert len(again.steps) == len(state["steps"]) and not again.interrupted


def test_figures_are_drawn_once_for_what_the_folder_holds(made):
    lot = Fleet(made)
    before = lot.version
    lot.draw()
    drawn = lot.version
    lot.draw()
    assert before != drawn == lot.version
    assert "<svg" in lot.page


@pytest.mark.parametrize("pattern", ["../*/", "/tmp/*", "lot/../../x/*", ""])
def test_devices_are_in_the_folder_of_the_workbench(tmp_path, pattern):
    with pytest.raises(InputError, match="not in the workbench's folder"):
        below(tmp_path, pattern)
    below(tmp_path, "lot/*/")


def test_a_device_that_was_not_identified_says_why(made, tmp_path):
    with pytest.raises(InputError, match="unknown device 'nobody'"):
        Fleet(made).session("nobody", tmp_path, tmp_path / "devices", False)
