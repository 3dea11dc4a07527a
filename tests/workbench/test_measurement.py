"""What the page sees of a measurement before there is a job."""

import base64

import numpy as np
import pytest

from pzt_ident.workbench.columns import columns_of
from pzt_ident.workbench.measurement import main_frequency, measured

RATE = 200.0
TIME = np.arange(1200) / RATE
DRIVE = np.where(TIME < 4, 30 + 20 * np.sin(2 * np.pi * 1.5 * TIME), 30 + 20 * np.sin(12 * np.pi))
NOISE = np.random.default_rng(2).normal(0, 0.004, TIME.size)
RESPONSE = 0.1 * DRIVE + NOISE


def table(path, columns):
    rows = np.column_stack(list(columns.values()))
    lines = [",".join("" if np.isnan(value) else f"{value:.7g}" for value in row) for row in rows]
    path.write_text("\n".join([",".join(columns), *lines]) + "\n")
    return path


def whole(path):
    return [[(path, None)]]


def decoded(channel):
    return np.frombuffer(base64.b64decode(channel["data"]), "<f4")


def test_it_is_seen_whole_with_what_can_be_guessed(tmp_path):
    path = table(tmp_path / "a.csv", {"time [s]": TIME, "u [V]": DRIVE, "x [um]": RESPONSE})
    found = measured(whole(path))
    (record,) = found["records"]
    assert (record["name"], record["samples"], record["positions"]) == ("a", 1200, None)
    assert record["dt"] == pytest.approx(1 / RATE)
    np.testing.assert_allclose(decoded(record["channels"]["x.response"]), RESPONSE, atol=1e-5)
    guess = found["guess"]
    assert {role: item["name"] for role, item in guess["columns"].items()} == {
        "time": "time",
        "x.drive": "u",
        "x.response": "x",
    }
    assert guess["rate"] == pytest.approx(RATE)
    assert guess["amplitude"]["x"] == {"value": pytest.approx(40, rel=1e-3), "unit": "V"}
    assert guess["frequency"]["x"] == pytest.approx(1.5, rel=0.1)
    ((rest,),) = guess["rests"]
    assert rest == pytest.approx([4, 6], abs=0.02)
    assert guess["noise_floor"]["x"]["value"] == pytest.approx(0.004, rel=0.2)
    assert (guess["noise_floor"]["x"]["unit"], guess["noise_floor"]["x"]["source"]) == ("µm", "rest segments")


def test_what_looks_wrong_with_its_readings_is_said_in_the_words_of_the_page(tmp_path):
    wrong = RESPONSE.copy()
    wrong[300:320] += 9.0
    path = table(tmp_path / "a.csv", {"time [s]": TIME, "u [V]": DRIVE, "x [um]": wrong})
    (fault,) = measured(whole(path))["guess"]["faults"]
    assert fault["record"] == "a"
    assert fault["said"].startswith(f"the readings of x from {TIME[300]:.6g} s to {TIME[319]:.6g} s jump away and back")
    assert fault["said"].endswith("a channel most likely dropped out; divide the record there")


def test_a_long_record_is_thinned_to_its_extremes(tmp_path):
    size = 50_000
    spike = np.zeros(size)
    spike[31_234] = 7.0
    path = tmp_path / "long.npy"
    np.save(path, np.column_stack([np.arange(size) / 1e3, np.sin(np.arange(size) / 99), spike]))
    (record,) = measured(
        whole(path), {"x.drive": {"number": 2, "unit": "V"}, "x.response": {"number": 3, "unit": "um"}}
    )["records"]
    positions = np.frombuffer(base64.b64decode(record["positions"]), "<i4")
    values = decoded(record["channels"]["x.response"])
    assert positions.size == values.size <= 20_000 and record["samples"] == size
    assert values[np.flatnonzero(positions == 31_234)] == [7.0]


def test_columns_with_gaps_are_shown_and_bridged(tmp_path):
    """Every third value of the response is there; JSON has no word for the others."""
    sparse = np.where(np.arange(TIME.size) % 3 == 0, RESPONSE, np.nan)
    sparse[:2] = np.nan
    path = table(tmp_path / "a.csv", {"time [s]": TIME, "u [V]": DRIVE, "x [um]": sparse})
    assert columns_of((path, None))["columns"][2]["first"][:3] == [None, None, None]
    assert measured(whole(path))["guess"]["noise_floor"]["x"]["value"] < 0.02


def test_a_page_gets_null_for_what_is_no_number(client, session):
    sparse = np.full(TIME.size, np.nan)
    sparse[::7] = RESPONSE[::7]
    table(session.root / "a.csv", {"time [s]": TIME, "u [V]": DRIVE, "x [um]": sparse})
    for name in ("look", "measurement"):
        answer = client.post(f"/api/{name}", json={"files": [{"file": "a.csv"}]})
        assert answer.status_code == 200, answer.text
    content = (session.root / "a.csv").read_bytes()
    assert client.post("/api/upload?name=b.csv", content=content).json()["columns"][2]["rough"] is None


def test_a_drive_that_rests_in_the_first_file_is_found_in_the_others(tmp_path):
    names = ("time [s]", "u [V]", "x [um]")
    still = table(tmp_path / "still.csv", dict(zip(names, (TIME, 0 * DRIVE, NOISE), strict=True)))
    moving = table(tmp_path / "moving.csv", dict(zip(names, (TIME, DRIVE, RESPONSE), strict=True)))
    assert [item["role"] for item in columns_of((still, None))["columns"]] == ["time", "x.drive", "x.response"]
    unnamed = {"": TIME, " ": 0 * DRIVE, "  ": NOISE}
    bare = table(tmp_path / "bare.csv", unnamed)
    found = measured([[(bare, None)], [(moving, None)]])
    assert found["guess"]["columns"]["x.drive"]["number"] == 2
    assert [set(record["channels"]) for record in found["records"]] == [{"time", "x.drive", "x.response"}] * 2
    found = measured([[(still, None)], [(moving, None)]])
    assert found["guess"]["amplitude"]["x"]["value"] == pytest.approx(40, rel=1e-3)


@pytest.mark.parametrize(
    ("columns", "roles"),
    [
        ({"n": "count", "u [V]": "drive", "x [um]": "response"}, ["time", "x.drive", "x.response"]),
        ({"time [s]": "time", "sample": "count", "a": "drive", "b": "response"}, ["time", "", "x.drive", "x.response"]),
        ({"time [s]": "time", "u": "count", "a": "drive", "x": "response"}, ["time", "", "x.drive", "x.response"]),
        ({"time [s]": "time", "u [V]": "ramp", "x [um]": "response"}, ["time", "x.drive", "x.response"]),
    ],
)
def test_a_uniform_ramp_is_a_drive_only_in_volts(tmp_path, columns, roles):
    signals = {"count": np.arange(TIME.size), "ramp": 50 * TIME, "time": TIME, "drive": DRIVE, "response": RESPONSE}
    path = table(tmp_path / "a.csv", {header: signals[kind] for header, kind in columns.items()})
    found = [item["role"] for item in columns_of((path, None))["columns"]]
    assert found[1:] == roles[1:] and found[0] in ("", roles[0])


@pytest.mark.parametrize(
    ("drive", "frequency"),
    [
        (np.where(TIME < 2, 0.0, 150 * np.sin(2 * np.pi * 2 * TIME + 0.6)), 2.0),  # rests, then steps into a sine
        (np.abs((5 * TIME) % 2 - 1), 2.5),  # a triangle
        (20 * TIME, 0.0),  # a ramp has no frequency
        (np.full(TIME.size, 50.0), 0.0),
    ],
)
def test_the_main_frequency_is_that_of_the_strongest_line(drive, frequency):
    assert main_frequency(drive, 1 / RATE) == pytest.approx(frequency, rel=0.03)


def test_missing_values_are_counted(tmp_path):
    gap = np.where(TIME == 1, np.nan, RESPONSE)
    path = table(tmp_path / "a.csv", {"time [s]": TIME, "u [V]": DRIVE, "x [um]": gap})
    assert [column["missing"] for column in columns_of((path, None))["columns"]] == [0, 0, 1]
