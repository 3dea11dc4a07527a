"""What the diagnoses of single devices say is said of the lot, wherever it is told."""

from dataclasses import replace

import numpy as np
import pytest

import stage
from lot.test_table import row_of
from pzt_ident.data.faults import fault_phrases
from pzt_ident.lot.device import missing_of, wrong_readings
from pzt_ident.lot.measured import measured
from pzt_ident.lot.outcome import Lot
from pzt_ident.lot.report import device_lines, header
from pzt_ident.lot.sentences import far, findings
from pzt_ident.lot.table import frame_of
from rig import path, record

EITHER, MEND = "slew_limit or amplifier_lag", "Tighten the linkage."


def step(added, *of):
    return {"added": added, "class": list(of)}


@pytest.mark.parametrize(
    ("steps", "missing"),
    [
        ([step(None)], []),
        ([step(None), step("creep", "creep")], ["creep"]),
        ([step(None), step("slew_limit", "slew_limit", "amplifier_lag")], [EITHER]),
        ([step("creep", "creep", "drift"), step(None), step("slew_limit", "slew_limit", "amplifier_lag")], [EITHER]),
    ],
)
def test_effects_that_data_cannot_tell_apart_are_named_together(steps, missing):
    effects = [item["added"] for item in steps if item["added"]][-1:]
    assert missing_of({"steps": steps, "effects": effects}) == missing


@pytest.fixture
def lot(tmp_path):
    """Twenty devices, of which one may miss either of two effects, and one has a fault of its set-up."""
    rows = [row_of(f"d{place}") | {"effects": [], "step_change": 0.0, "sha256": f"{place}"} for place in range(20)]
    rows[3] |= {"effects": ["slew_limit"], "missing": [EITHER], "rmse": {"identify": 9.0, "validate": None}}
    rows[5] |= {"verdict": "unexplained", "suspects": ["backlash", "friction"], "faults": {"backlash": MEND}}
    for place, row in enumerate(rows):
        row["rmse"] = {"identify": 5.0 if place in (3, 5) else 0.1 + 0.001 * place, "validate": None}
    rows[3]["verdict"] = "above the noise"
    return Lot(tmp_path, {"improve": True}, rows)


def test_what_a_device_misses_and_what_is_wrong_with_its_set_up_is_told_everywhere(lot):
    said = "\n".join([*lot.sentences(), *findings(lot)])
    assert f"Missing in 1: {EITHER} (d3)." in said
    assert f"{EITHER} is missing in 1 of 20 devices" in said
    assert f"Fault of the set-up in 1 (d5): backlash. {MEND}" in said
    assert f"A fault of the set-up accounts for the misfit of 1 of 20 devices (d5): backlash. {MEND}" in said
    told = {device: (kind, why) for device, kind, why in far(lot)}
    assert told["d3"][0] == f"misses {EITHER}"
    assert told["d5"][0] == "backlash in the set-up" and told["d5"][1].endswith(MEND)
    cells = {line["device"]: line["words"] for line in device_lines(lot)}
    assert (cells["d3"][1], cells["d5"][1]) == (EITHER, "backlash in the set-up")
    frame = frame_of(iter(lot.rows)).set_index("device")
    assert (frame.loc["d3", "effects"], frame.loc["d3", "missing"]) == ("slew_limit", EITHER)
    assert [*frame.loc["d5", ["faults of the set-up", "remedy of the set-up"]]] == ["backlash", MEND]
    summary = lot.summary()
    assert summary["missing"] == {EITHER: ["d3"]}
    assert summary["faults"] == [{"device": "d5", "fault": "backlash", "remedy": MEND}]


def test_readings_that_look_wrong_are_told_everywhere(lot):
    lot.rows[5] |= {"readings": ["loops: 3 readings of x are exactly 6 um"]}
    said = "\n".join([*lot.sentences(), *findings(lot)])
    assert said.count("The readings of d5 look wrong: loops: 3 readings of x are exactly 6 ") == 2
    assert {device: kind for device, kind, _ in far(lot)}["d5"] == "readings look wrong, backlash in the set-up"
    frame = frame_of(iter(lot.rows)).set_index("device")
    assert (frame.loc["d5", "readings"], frame.loc["d4", "readings"]) == (lot.rows[5]["readings"][0], "")
    assert lot.summary()["readings"] == {"d5": lot.rows[5]["readings"]}
    for row in lot.rows:
        row |= {"readings": ["loops: odd"]}
    assert len(lot.of_readings()) == 6
    assert lot.of_readings()[-1] == "So do those of 15 more: see `readings` in the table."


def test_a_device_that_was_measured_unlike_the_others_is_told(lot):
    """Time in ms, and a response in nm under a heading of um: a thousandth of the rate, a thousand times the range."""
    usual = stage.records({})
    others = {
        "d2": [replace(record, dt=1e3 * record.dt) for record in usual],
        "d7": [replace(record, response=1e3 * record.response) for record in usual],
        "d9": [replace(record, response=2 * record.response) for record in usual],
    }
    for row in lot.rows:
        row |= {"measured": measured(others.get(row["device"], usual))}
    assert [*lot.unlike] == ["d2", "d7"] and lot.summary()["unlike"] == lot.unlike
    rate, time = lot.unlike["d2"]
    assert rate.startswith("sample rate 0.2") and time.startswith("time measured ")
    (response,) = lot.unlike["d7"]
    assert response.startswith("range of the response of x ") and ", usually " in response
    for said in (lot.sentences(), [*findings(lot)]):
        assert any("d7 was measured unlike the others: range of the response" in line for line in said)


def test_a_device_is_told_what_check_tells_of_its_readings():
    """The end of a sensor's range."""
    drive = np.tile(path(0, 100, 0, points=200), 3)
    clipped = record(
        drive, response=[np.minimum(0.1 * drive + 1e-3 * np.random.default_rng(1).normal(size=drive.size), 8)]
    )
    assert wrong_readings([clipped]) == [f"{clipped.name}: {phrase}" for phrase in fault_phrases(clipped)]
    assert "the end of the range of a sensor" in wrong_readings([clipped])[0]


def test_parameters_of_the_model_come_first_then_those_of_effects_by_how_many_have_them(lot):
    for place, names in ((0, ["slew_limit.tau"]), (1, ["creep.tau"]), (2, ["creep.tau"])):
        interval = {"value": 0.1, "unit": "um/V", "low": 0.0, "high": 0.2}
        lot.rows[place]["improved"] = dict.fromkeys([*names, "gain"], interval)
    assert [quantity.name for quantity in lot.quantities][:3] == ["gain", "creep.tau", "slew_limit.tau"]


def test_columns_of_words_are_above_words(lot):
    for place, row in enumerate(lot.rows):
        row["columns"] = {"batch": "AB"[place % 2], "T": float(place)}
    assert header(lot)[:4] == [("device", True), ("batch", True), ("T", False), ("verdict", True)]
    assert next(device_lines(lot))["known"] == [("A", True), ("0", False)]
