"""A step that was run: its parameters, sliders, spectra, downloads and the model put to work."""

import io
import json
import shutil
import zipfile
from types import SimpleNamespace

import numpy as np
import pytest
from starlette.testclient import TestClient

import measured
from pzt_ident.job.schema import load_job
from pzt_ident.run.identify import run
from pzt_ident.run.improve import diagnose
from pzt_ident.run.place import Local
from pzt_ident.run.results import read_results
from pzt_ident.workbench.app import make_app
from pzt_ident.workbench.session import Session
from pzt_ident.workbench.step_commands import better_fit
from pzt_ident.workbench.step_model import POINTS, determined, interval_of, kept_samples, model_of, to_bound

from .conftest import GOOD, HOST, TOKEN, form


@pytest.fixture(scope="module")
def filled(tmp_path_factory):
    """A session whose first step was run and diagnosed: a loop with creep in two records."""
    root = tmp_path_factory.mktemp("filled")
    t = np.arange(1500) / 100
    u = 50 + 45 * np.sin(2 * np.pi * 0.4 * t) * np.where(t % 5 < 3, 1, 0.4)
    x = measured.creeping(u, 0.01, ratio=0.08, tau=1.5, width=2, height=0.2)
    measured.write(root / "data.csv", t, u, x + np.random.default_rng(1).normal(0, 0.005, t.size))
    session = Session(root, root / "workbench")
    session.begin(form(records=[{"file": "data.csv", "use": "split", "rows": 1500, "span": t[-1]}]))
    path = session.step() / "job.yaml"
    quick = path.read_text().replace("generations: 150", "generations: 9")
    path.write_text(quick.replace("  - {name: differential_evolution}\n", ""))
    job = load_job(session.step() / "job.yaml")
    run(job, session.step() / "run", place=Local(1))
    diagnose(job, session.step() / "diagnosis", start=session.step() / "run")
    return session


@pytest.fixture
def client(filled):
    return TestClient(make_app(filled, {HOST}, TOKEN), base_url=f"http://{HOST}", headers=GOOD)


def answered(answer):
    """The header and the floats of a moved slider, by record."""
    line, _, values = answer.content.partition(b"\n")
    header = json.loads(line)
    ends = np.cumsum([record["points"] for record in header["records"]])
    return header, np.split(np.frombuffer(values, "<f4"), ends[:-1])


def test_every_parameter_has_value_interval_bounds_and_verdict(client):
    found = {item["name"]: item for item in client.get("/api/state").json()["parameters"]}
    gain = found["bouc_wen.gain"]
    assert (gain["axis"], gain["block"], gain["symbol"], gain["unit"]) == ("x", "bouc_wen", "gain", "µm/V")
    assert gain["bounds"][0] <= gain["low"] < gain["value"] < gain["high"] <= gain["bounds"][1]
    assert gain["determined"] and gain["physics"] and not gain["fixed"]


def test_a_parameter_on_its_bound_has_the_bound_as_its_value_and_an_interval_within(filled):
    model = model_of(filled.step(), False)
    before = dict(model.best["parameters"])
    name, fit = next(item for item in before.items() if item[0] == "bouc_wen.alpha")
    row = [item["name"] for item in model.parameters].index(name)
    low, high = model.parameters[row]["bounds"]
    ends = {"verdict": "on its lower bound", "interval": [low - 0.1, low + 0.1]}
    theta = model.theta.copy()
    try:
        model.best["parameters"][name] = fit | ends
        model.theta[row] = low + 2.6e-26
        found = model.parameters[row]
    finally:
        model.best["parameters"], model.theta = before, theta
    assert (found["value"], found["low"], found["high"]) == (low, low, low + 0.1)
    assert found["determined"] == "on its lower bound" and high > low


@pytest.mark.parametrize(
    ("value", "bounds", "scale", "shown"),
    [
        (2.6e-26, (0, 0.5), "linear", 0),
        (0.5 - 1e-12, (0, 0.5), "linear", 0.5),
        (0.25, (0, 0.5), "linear", 0.25),
        (2e-12, (1e-12, 1), "log", 2e-12),
        (1.0000000000001e-12, (1e-12, 1), "log", 1e-12),
    ],
)
def test_what_rounding_keeps_from_a_bound_is_the_bound(value, bounds, scale, shown):
    assert to_bound(value, *bounds, scale) == shown


def test_before_a_run_parameters_have_bounds_and_no_value(filled, tmp_path):
    session = Session(filled.root, tmp_path / "other")
    session.begin(form(records=[{"file": "data.csv", "use": "identify"}]))
    gain = next(item for item in model_of(session.step(), False).parameters if item["symbol"] == "gain")
    assert gain["value"] is None and gain["bounds"][0] < gain["bounds"][1]


def test_sliders_where_the_fit_is_give_its_error(client, filled):
    best = json.loads((filled.step() / "run/result.json").read_text())["best"]
    values = {name: item["value"] for name, item in best["parameters"].items()}
    for moved in ({}, values):
        header, signals = answered(client.post("/api/simulate", json={"values": moved}))
        assert header["rmse"] == pytest.approx(best["rmse"], rel=1e-6)
        assert [record["points"] for record in header["records"]] == [1000, 1500] == [len(s) for s in signals]


def test_the_model_that_is_sent_is_that_of_the_signals(client, filled):
    header, signals = answered(client.post("/api/simulate", json={"positions": True}))
    for record, values, trace in zip(
        header["records"], signals, read_results(filled.step() / "run").traces, strict=True
    ):
        assert (record["name"], record["use"], record["axis"]) == (trace.record, trace.use, trace.axis)
        np.testing.assert_allclose(values, trace.model[record["positions"]], atol=1e-5)


def test_a_moved_parameter_changes_error_and_model(client):
    (before, first), (after, second) = (
        answered(client.post("/api/simulate", json={"values": values})) for values in ({}, {"bouc_wen.gain": 0.08})
    )
    assert after["rmse"]["identify"] > 2 * before["rmse"]["identify"]
    assert np.ptp(second[0]) < np.ptp(first[0])
    assert "bouc_wen.gain" in client.post("/api/simulate", json={"values": {"bouc_wen.gian": 1}}).json()["error"]


def test_a_proposed_effect_does_nothing_at_its_null(client):
    found = client.get("/api/proposal?effect=creep").json()["parameters"]
    assert {item["symbol"]: item["value"] for item in found}["ratio"] == 0 and len(found) == 3
    header, signals = answered(client.post("/api/simulate", json={"effect": "creep"}))
    same, given = answered(client.post("/api/simulate", json={}))
    assert header["rmse"] == pytest.approx(same["rmse"]) and np.allclose(signals[0], given[0], atol=1e-6)
    tried = {"creep.ratio": 0.08, "creep.tau": 1.5}
    moved, _ = answered(client.post("/api/simulate", json={"effect": "creep", "values": tried}))
    assert moved["rmse"]["identify"] != pytest.approx(same["rmse"]["identify"], rel=0.01)
    assert "unknown effect" in client.get("/api/proposal?effect=crep").json()["error"]


def test_long_records_are_thinned_where_they_turn():
    response = np.sin(np.arange(60_000) / 50)
    response[12_345] = 9
    record = SimpleNamespace(samples=60_000, response=response[None], drive=response[None], measured=(0,))
    kept = kept_samples(SimpleNamespace(record=record))
    assert 12_345 in kept and POINTS / 3 < kept.size <= POINTS


def test_intervals_of_older_results_are_those_of_the_standard_error():
    assert interval_of({"value": 2.0, "standard_error": 0.1}) == pytest.approx([1.804, 2.196])
    assert interval_of({"value": 2.0, "standard_error": None}) is None


def test_spectra_show_a_gain_and_what_the_drive_does_not_move(client):
    first, _ = client.get("/api/spectrum").json()["records"]
    assert (first["axis"], first["use"], first["unit"]) == ("x", "identify", "µm")
    near = int(np.argmin(np.abs(np.array(first["frequency"]) - 0.4)))
    assert first["measured"]["amplitude"][near] == pytest.approx(0.1, rel=0.2)
    assert first["model"]["amplitude"][near] == pytest.approx(first["measured"]["amplitude"][near], rel=0.1)
    assert first["measured"]["phase"][near] < 0
    assert len(first["residual"]) == len(first["frequency"])


def test_two_steps_are_compared(client):
    shown = client.get("/api/signals?steps=1,1").json()["records"]
    assert [model["name"] for model in shown[0]["models"]] == ["now", "before"]


def test_the_head_says_the_verdict_and_the_one_thing_to_do(client):
    state = client.get("/api/state").json()
    head = state["headline"]
    assert head["verdict"] == state["diagnosis"]["reason"] and "`" not in head["verdict"]
    missing = [item["item"] for item in state["diagnosis"]["candidates"] if item["decision"] == "missing"]
    assert head["action"] == {"name": "add", "body": {"effect": missing[0]}, "label": f"Add {missing[0]}"}
    assert state["steps"][0]["floors"] == pytest.approx(state["steps"][0]["identify"] / state["result"]["floor"])


def test_only_listed_files_can_be_had(client, filled):
    names = client.get("/api/state").json()["downloads"]
    assert {"job.yaml", "result.json", "history.csv", "tables.zip", "figures.zip"} <= set(names)
    assert "control.csv" not in names
    for name in ("control.csv", "../../data.csv", "state.json"):
        assert client.get("/api/download", params={"name": name}).status_code == 400
    assert client.get("/api/download?name=job.yaml").text.startswith("# Made in the workbench.")
    archive = zipfile.ZipFile(io.BytesIO(client.get("/api/download?name=tables.zip").content))
    assert {"parameters.csv", "parameters.tex"} <= set(archive.namelist())


def test_the_model_is_given_to_other_programs(client):
    answer = client.post("/api/export", json={"to": "c"}).json()
    assert answer["url"].startswith("/file/")
    given = client.get(answer["url"], headers={"x-pzt-token": ""})
    assert {"small.c", "small.h"} <= set(zipfile.ZipFile(io.BytesIO(given.content)).namelist())
    assert client.get("/file/guessed").status_code == 404
    assert "unknown format" in client.post("/api/export", json={"to": "word"}).json()["error"]


def test_a_reference_is_read_for_the_model(client):
    rows = "\n".join(f"{i / 100},{3 + np.sin(i / 30):.4f}" for i in range(300))
    answer = client.post("/api/reference?name=ramp.csv", content=f"time [s],x [um]\n{rows}\n".encode()).json()
    assert answer["axes"] == {"x": {"unit": "um"}} and answer["samples"] == 300
    assert answer["rate"] == pytest.approx(100)
    refused = client.post("/api/reference?name=other.csv", content=f"time [s],x [V]\n{rows}\n".encode())
    assert "is in V, not in um" in refused.json()["error"]
    assert client.get("/api/tracking").json()["error"].startswith("nothing follows a reference yet")


def test_an_added_effect_starts_where_it_was_tried(filled, tmp_path):
    root = tmp_path / "copy"
    shutil.copytree(filled.root, root)
    session = Session(root, root / "workbench")
    diagnosis = json.loads((session.step() / "diagnosis/diagnosis.json").read_text())
    tried = next(item for item in diagnosis["candidates"] if item.get("parameters"))
    session.add(tried["item"])
    entry = session.entry()
    assert entry["promised"] == tried["rmse"] and entry["from"] == "steps/1/diagnosis"
    (command, _) = session.commands(session.step())
    assert command.arguments[4:7] == ["--from", "workbench/steps/1/diagnosis", "--no-search"]


@pytest.mark.parametrize(("found", "better"), [(0.9, True), (0.9995, False), (None, False)])
def test_a_better_fit_of_the_diagnosis_goes_back_to_the_run(tmp_path, found, better):
    contents = {
        "run/result.json": {"best": {"rmse": {"identify": 1.0}}},
        "diagnosis/diagnosis.json": {"rmse": {"identify": found}, "parameters": {"a": {}}},
    }
    for name, content in contents.items():
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_text(json.dumps(content))
    assert better_fit(tmp_path) == better


@pytest.mark.parametrize(
    ("found", "said"),
    [
        ({"verdict": "determined", "note": ""}, "yes"),
        (
            {"verdict": "determined", "note": "zero lies within two standard errors"},
            "zero lies within two standard errors",
        ),
        ({"verdict": "not determined", "note": "runs of the same RMSE put it elsewhere"}, "no"),
        ({"verdict": "on its upper bound", "note": "widen the bounds"}, "on its upper bound"),
        ({}, ""),
    ],
)
def test_a_reservation_is_not_a_yes(found, said):
    assert determined(found) == said
