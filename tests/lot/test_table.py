"""The folder of a device, whatever its name, and the table, whatever is known of a device."""

from collections import Counter
from io import BytesIO
from itertools import permutations
from pathlib import Path

import pandas as pd
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from pzt_ident.lot.table import folder_of, frame_of, line_of, with_dates

NAMES = st.text(max_size=300) | st.text(st.sampled_from("./\\%~ \0\n\x1b"), max_size=8) | st.text(min_size=200)
FLEET = Path("/fleet")


@given(NAMES, NAMES)
@example("", "%")
@example(".", "..")
@example("/", "//")
@example(".new", "%2Enew")
@example("\udcff", "\\udcff")
@example("é" * 4000, "é" * 4001)
def test_each_name_leads_to_a_folder_of_its_own_below_devices(name, other):
    home = folder_of(FLEET, name)
    assert home.parent == FLEET / "devices" and home.resolve() == home
    assert home.name.isascii() and home.name.isprintable() and not home.name.startswith(".")
    assert 0 < len(home.name) < 200 and not set('/\\:*?"<>|') & set(home.name)
    assert (home == folder_of(FLEET, other)) == (name == other)


def row_of(device, state="done", columns=None):
    row = {"device": device, "state": state, "reason": "", "columns": columns or {}}
    found = {
        "verdict": "adequate",
        "effects": ["creep"],
        "suspects": [],
        "unit": "um",
        "cpu_seconds": 1.5,
        "sha256": "0",
    }
    gain = {"value": 0.1, "low": 0.0, "high": 0.2, "unit": "um/V", "verdict": "determined"}
    found |= {"rmse": {"identify": 0.1}, "rmse_improved": None, "noise_floor": 0.01, "parameters": {"gain": gain}}
    return row | found if state == "done" else row


def test_what_an_effect_adds_to_a_record_is_a_column():
    """In the unit of the first device that has it."""
    drift = {"effect": "drift", "axis": "x", "record": "loops", "rms": 0.3, "unit": "um"}
    rows = [
        row_of("a"),
        row_of("b") | {"amounts": [drift]},
        row_of("c") | {"amounts": [drift | {"rms": 500, "unit": "nm"}]},
    ]
    column = frame_of(iter(rows))["improved x drift rms [um]"]
    assert column.isna().tolist() == [True, False, False] and column.tolist()[1:] == [0.3, pytest.approx(0.5)]


def improved(device, **values):
    """A device whose improved model has these parameters beside its own, each with an interval."""
    own = {"value": 0.1, "low": 0.0, "high": 0.2, "unit": "um/V", "verdict": "determined"}
    return row_of(device) | {
        "rmse_improved": {"identify": 0.05},
        "improved": {"gain": own} | {name: own | {"value": value} for name, value in values.items()},
    }


def test_columns_do_not_depend_on_which_devices_there_are_and_in_which_order():
    rows = [row_of("a"), improved("b", lag=1.0), improved("c", creep=2.0, lag=3.0), row_of("d", "broken")]
    columns = list(frame_of(iter(rows)).columns)
    assert all(list(frame_of(iter(some)).columns) == columns for some in permutations(rows))
    cells = " [um/V]", " low [um/V]", " high [um/V]", " verdict"
    names = [f"improved {name}{cell}" for name in ("creep", "lag") for cell in cells]
    assert columns[-12:] == [*names, "cpu [s]", "sha256", "folder", "reason"]
    assert columns.index("improved gain [um/V]") < columns.index(names[0])


OWN = list(frame_of(iter([row_of("a")])).columns)
VALUES = (
    st.none()
    | st.integers(-(2**53), 2**53)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text("23 C", max_size=4)
)
HEADINGS = st.sampled_from([*OWN, *(f"{name} (given)" for name in OWN), "batch", "temperature [K]"])
ROWS = st.lists(
    st.tuples(st.sampled_from(["done", "broken", "not done"]), st.dictionaries(HEADINGS, VALUES)), max_size=6
)


@settings(max_examples=60, deadline=None)
@given(ROWS)
@example([("done", {"temperature [K]": 23.0}), ("done", {"temperature [K]": "23 C"})])
@example([("done", {}), ("broken", {"cpu [s]": "slow"})])
@example([("done", {"device": "x", "device (given)": "y"})])
def test_the_table_keeps_what_was_given_and_what_was_found(rows):
    rows = [row_of(f"d{place}", state, columns) for place, (state, columns) in enumerate(rows)]
    frame = frame_of(iter(rows))
    plain = frame.astype(object).where(frame.notna(), None)
    for index, row in enumerate(rows):
        line = plain.iloc[index].to_dict()
        found = line_of(row, {})
        assert {name: line[name] for name in found} == found
        cells = [str(value).removesuffix(".0") for name, value in line.items() if name not in found]
        given = [str(value).removesuffix(".0") for value in row["columns"].values()]
        assert not Counter(given) - Counter(cells)
    content = BytesIO()
    frame.to_parquet(content, engine="pyarrow")
    assert list(pd.read_parquet(content).columns) == list(frame.columns)


def test_whole_numbers_are_written_as_such_where_a_cell_is_empty():
    frame = frame_of(row_of(f"d{place}", columns={"serial": serial}) for place, serial in enumerate([12, None, 13]))
    assert pd.read_csv(BytesIO(frame.to_csv().encode()), dtype=str)["serial"].fillna("").tolist() == ["12", "", "13"]
    parquet = pd.read_parquet(BytesIO(with_dates(frame, {"serial"}).to_parquet(index=False)))
    assert [None if pd.isna(cell) else cell for cell in parquet["serial"]] == [12, None, 13]
    assert all(type(cell) is int for cell in parquet["serial"].dropna().tolist())


def test_parquet_has_times_where_the_lot_has_dates():
    made = [("A", "02.03.2026"), ("B", None), ("C", "2026-03-05T01:00+01:00")]
    known = {name: {"made": date, "batch": "2026", "verdict": date} for name, date in made}
    frame = frame_of(row_of(name, columns=columns) for name, columns in known.items())
    times = pd.read_parquet(BytesIO(with_dates(frame, {"made", "batch", "verdict"}).to_parquet(index=False)))
    for heading in ("made", "verdict (given)"):
        first, none, last = times[heading]
        assert (last - first).days == 3 and pd.isna(none)
    assert [*times["verdict"]] == ["adequate"] * 3 and [*times["batch"]] == ["2026"] * 3
    assert [*frame["made"].dropna()] == [date for _, date in made if date]
