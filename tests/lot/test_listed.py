"""What is a list of devices and what is data, whatever is in the file; and what a list says."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from lot.test_devices import ONE, TWO, here, job, touch
from pzt_ident.errors import InputError
from pzt_ident.lot.devices import devices_of
from pzt_ident.lot.listed import is_table

__all__ = ["here"]
LONG = 200_000  # characters, above the limit of a field of Python's csv
CONTENTS = st.binary(max_size=60) | st.text('fileoldr,;\t#"\n\r\0 é', max_size=60).map(str.encode)


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(CONTENTS)
@example(b"a" * LONG)
@example(b'time,"' + b"a,\n" * LONG)
@example(b"\xff\xfea")
@example(b"\0")
def test_any_file_is_data_or_a_list_and_never_the_end_of_a_lot(here, content):
    touch(here / "good.csv")
    (here / "any.csv").write_bytes(content)
    try:
        devices = devices_of(["good.csv", "any.csv"], job(ONE, here))
    except InputError as error:
        assert is_table(Path("any.csv"), job(ONE, here)) and "any.csv" in str(error)
    else:
        assert "good" in [device.name for device in devices]


@pytest.mark.parametrize("header", ["time [s],u [V],x [um],", "time [s];u [V];x [um];", ",time [s],u [V],x [um]"])
@pytest.mark.parametrize("text", [ONE, TWO])
def test_data_with_an_empty_heading_are_no_list(here, header, text):
    (here / "a.csv").write_text(f"{header}\n0,0,0,\n")
    assert not is_table(Path("a.csv"), job(text, here))


def test_data_are_not_read_to_tell_them_from_a_list(here, monkeypatch):
    touch(here / "a.csv")
    (here / "lot.csv").write_text("file\n" + "a.csv\n" * LONG)
    monkeypatch.setattr(Path, "read_bytes", None)
    monkeypatch.setattr(Path, "read_text", None)
    assert not is_table(Path("a.csv"), job(ONE, here))
    assert is_table(Path("lot.csv"), job(ONE, here))


LIST = "device;file;batch\r\nd1;a.csv;Gerät…\r\nd2;b.csv;A, B\r\n"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
@pytest.mark.parametrize("above", ["", "sep=;\r\n", "# written by hand, 3 May\r\n#\r\n", "\r\n"])
def test_a_list_is_read_as_spreadsheets_write_it(here, encoding, above):
    touch(here / "a.csv", here / "b.csv")
    (here / "lot.csv").write_bytes((above + LIST).encode(encoding))
    devices = devices_of(["lot.csv"], job(ONE, here))
    assert [(device.name, device.columns) for device in devices] == [
        ("d1", {"batch": "Gerät…"}),
        ("d2", {"batch": "A, B"}),
    ]


def test_an_empty_cell_behind_the_last_heading_is_none(here):
    touch(here / "a.csv", here / "b.csv")
    (here / "lot.csv").write_text("file,batch\na.csv,A,,\nb.csv\n")
    devices = devices_of(["lot.csv"], job(ONE, here))
    assert [(device.name, device.columns) for device in devices] == [("a", {"batch": "A"}), ("b", {"batch": None})]


BAD_ROWS = {
    "no file": ("bad,", "names no file: fill the cell"),
    "no file, no name": (",,x", "names no file: fill the cell"),
    "more cells": ("bad,b.csv,,7", "has 4 cells, the header 3: put text with commas in quotes"),
    "no such file": ("bad,no.csv", "no such file"),
    "a name twice": ("twin,b.csv\ntwin,c.csv", "the device 'twin' is in lot.csv:"),
    "data twice": ("c1,c.csv\nc2,./c.csv", "names the same data as lot.csv:"),
}


@pytest.mark.parametrize(("row", "said"), BAD_ROWS.values(), ids=BAD_ROWS)
def test_a_bad_row_is_the_fault_of_its_devices_alone(here, row, said):
    touch(here / "a.csv", here / "b.csv", here / "c.csv")
    (here / "lot.csv").write_text(f"device,file,batch\n{row}\ngood,a.csv,A\n")
    *bad, good = sorted(devices_of(["lot.csv"], job(ONE, here)), key=lambda device: not device.fault)
    assert (good.name, good.fault, len(bad)) == ("good", "", row.count("\n") + 1)
    assert all(said in device.fault and device.name not in ("twin", "good") for device in bad)
    assert len({device.name for device in bad}) == len(bad)


def test_devices_may_be_folders_in_some_rows_and_files_in_others(here):
    touch(here / "d1" / "loops.csv", here / "d1" / "slow.csv", here / "a.csv", here / "b.csv")
    (here / "lot.csv").write_text("device,folder,loops,slow\nd1,d1,,\nd2,,a.csv,b.csv\nd3,,a.csv,\n")
    first, second, third = devices_of(["lot.csv"], job(TWO, here))
    assert [*map(str, first.files.values())] == ["d1/loops.csv", "d1/slow.csv"] and not first.columns
    assert [*map(str, second.files.values())] == ["a.csv", "b.csv"] and not second.columns
    assert not first.fault and not second.fault
    assert third.fault == "lot.csv:4: names no file: fill the cell, or leave the row out"


def test_the_same_row_again_is_the_same_device(here):
    touch(here / "lot/a/loops.csv", here / "lot/b/loops.csv")
    (here / "lot.csv").write_text("device,folder,batch\na,lot/a,A\na,lot/a,A\n")
    devices = devices_of(["lot.csv", "lot/*/", "lot.csv"], job(ONE, here))
    assert [(device.name, device.columns, device.fault) for device in devices] == [
        ("a", {"batch": "A"}, ""),
        ("b", {}, ""),
    ]


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("file,batch,batch", "the columns 2 and 3 have the same heading 'batch'"),
        ("device,file,device", "the columns 1 and 3 have the same heading 'device'"),
        ("device,folder,File", "has the columns `folder` and `File`"),
    ],
)
def test_a_list_that_leaves_open_what_is_meant_is_refused(here, header, said):
    (here / "lot.csv").write_text(f"{header}\na,b,c\n")
    with pytest.raises(InputError, match=f"lot.csv: {said}") as caught:
        devices_of(["lot.csv"], job(ONE, here))
    assert caught.value.remedy


@pytest.mark.parametrize("heading", ["file", "Folder", "path", "filename", "directory"])
def test_where_a_device_is_has_several_names(here, heading):
    touch(here / "lot/a/loops.csv")
    (here / "lot.csv").write_text(f"{heading};temperature [K];\nlot/a;23,5;\n")
    (device,) = devices_of(["lot.csv"], job(ONE, here))
    assert (device.fault, device.columns) == ("", {"temperature [K]": 23.5})


def test_a_column_that_odd_cells_make_words_is_told_with_its_cells_and_a_remedy(here):
    touch(*(here / f"{letter}.csv" for letter in "abcde"))
    rows = ["a.csv,23,2026-03-02,12", "b.csv,21 C,3.2.2026,", "c.csv,24,2026-13-45,13", "d.csv,-,,007", "e.csv,25,NA,1"]
    (here / "lot.csv").write_text("\n".join(["file,T,made,serial", *rows]))
    with pytest.warns(UserWarning) as warned:
        devices = devices_of(["lot.csv"], job(ONE, here))
    assert [str(warning.message).partition(". ")[0] for warning in warned] == [
        "lot.csv: '21 C' (line 3) under 'T' is no number, as most others are: the column is taken as words",
        "lot.csv: '2026-13-45' (line 4) under 'made' is no date, as most others are: the column is taken as words",
    ]
    assert all("or leave the cells empty" in str(warning.message) for warning in warned)
    assert devices[3].columns == {"T": None, "made": None, "serial": "007"}
