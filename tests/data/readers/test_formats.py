"""The same loop through every format: values, units, sample time."""

import gzip
import sys
import zipfile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from pzt_ident.data.readers.registry import readers
from pzt_ident.data.record import Channel
from sheets import write_sheets

DT = 0.5
DRIVE = np.array([0.0, 1.5, -2.25, 1e-3])
RESPONSE = np.array([1.0, 2.5, 1 / 3, -1e-7])
TIME = DT * np.arange(4)
NAMED = {"t [s]": TIME, "u [V]": DRIVE, "x [um]": RESPONSE}
U, X = Channel(name="u", unit="V"), Channel(name="x", unit="um")


def assert_the_loop(record, dt=DT):
    np.testing.assert_array_equal(record.drive[0], DRIVE)
    np.testing.assert_array_equal(record.response[0], 1e-6 * RESPONSE)
    assert record.dt == pytest.approx(dt)
    assert (record.drive_units, record.response_units) == (("V",), ("um",))
    assert len(record.sha256) == 64


ROWS = [list(NAMED), *(list(map(float, row)) for row in zip(*NAMED.values(), strict=True))]


def test_excel_takes_the_first_sheet_or_the_named_one(tmp_path, read, problem):
    path = tmp_path / "rig.xlsx"
    write_sheets(path, Notes=[["Rig 3"], ["temperature", 21.0]], Loop=[["Rig 3"], *ROWS])
    assert_the_loop(read(path, sheet="Loop"))
    error = problem(path, sheet="Lop")
    assert "no sheet 'Lop'" in error.message
    assert "'Loop'" in error.remedy
    assert "no table of numbers" in problem(path).message


def test_excel_names_the_row_of_a_bad_cell(tmp_path, problem):
    path = tmp_path / "rig.xlsx"
    write_sheets(path, Loop=[*ROWS[:3], [1.0, 0.0, "overload"], *ROWS[4:]])
    assert "row 2 (row 4) holds 'overload'" in problem(path).message


def test_parquet(tmp_path, read):
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    path = tmp_path / "loop.parquet"
    parquet.write_table(pyarrow.table(NAMED), path)
    assert_the_loop(read(path))
    fields = [
        pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit}) for name, unit in (("u", "V"), ("x", "um"))
    ]
    parquet.write_table(pyarrow.table([DRIVE, RESPONSE], schema=pyarrow.schema(fields)), path)
    assert_the_loop(read(path, "u", "x", None, sample_rate=1 / DT))


def test_parquet_without_pyarrow_names_the_extra(tmp_path, problem, monkeypatch):
    path = tmp_path / "loop.parquet"
    path.write_bytes(b"PAR1 and more")
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    error = problem(path)
    assert "needs pyarrow" in error.message
    assert "pzt-ident[parquet]" in error.remedy


def test_tdms(tmp_path, read, problem):
    from nptdms import ChannelObject, TdmsWriter

    path = tmp_path / "loop.tdms"
    with TdmsWriter(path) as writer:
        writer.write_segment(
            [
                ChannelObject("Log", "u", DRIVE, {"unit_string": "V", "wf_increment": DT}),
                ChannelObject("Log", "x", RESPONSE, {"unit_string": "um", "wf_increment": DT}),
            ]
        )
    assert_the_loop(read(path, "Log/u", "Log/x", "Log/u/wf_increment"))
    assert_the_loop(read(path, "u", "x", "u/wf_increment", dataset="Log"))
    assert_the_loop(read(path, Channel(column=1), Channel(column=2), None, dataset="Log", sample_rate=1 / DT))
    assert_the_loop(read(path, "u", "x", None, dataset="Log"))
    assert "contradicts" in problem(path, "u", "x", None, dataset="Log", sample_rate=1.5 / DT).message
    with TdmsWriter(path) as writer:
        other = [ChannelObject("Log", "u", DRIVE, {"unit_string": "V", "wf_increment": DT})]
        other.append(ChannelObject("Log", "x", RESPONSE, {"unit_string": "um", "wf_increment": 2 * DT}))
        writer.write_segment(other)
    assert "different sample times, 0.5 and 1 s" in problem(path, "u", "x", None, dataset="Log").message


@pytest.mark.parametrize("scale", [0.01, np.array([0.01])])
def test_packed_hdf5_is_unpacked(tmp_path, read, problem, scale):
    import h5py

    path = tmp_path / "packed.nc"
    with h5py.File(path, "w") as file:
        file["t"] = TIME
        for name, counts, unit in (("u", [0, 150, -225, 10], "V"), ("x", [100, 250, 33, 0], "um")):
            file[name] = np.array(counts, np.int16)
            file[name].attrs.update({"scale_factor": scale, "add_offset": 5.0, "units": unit, "_FillValue": -9999})
    channels = {
        key: Channel(dataset=name, unit="s" if name == "t" else None) for key, name in zip("cux", "tux", strict=True)
    }
    record = read(path, channels["u"], channels["x"], channels["c"])
    np.testing.assert_allclose(record.drive[0], [5.0, 6.5, 2.75, 5.1])
    np.testing.assert_allclose(record.response[0], [6e-6, 7.5e-6, 5.33e-6, 5e-6])
    with h5py.File(path, "a") as file:
        file["u"][2] = -9999
    assert "1 value is missing: row 2" in problem(path, channels["u"], channels["x"], channels["c"]).message


def test_hdf5_groups_units_and_a_rate_that_the_job_names(tmp_path, read):
    import h5py

    path = tmp_path / "rig.h5"
    with h5py.File(path, "w") as file:
        group = file.create_group("multisine")
        group["u"] = DRIVE[:, None]
        group["u"].attrs["units"] = "V"
        group["x"] = RESPONSE[None, :]
        group["x"].attrs["unit"] = np.bytes_("um")
        group["fs"] = [[1 / DT]]
        group.attrs["rate"] = 1 / DT
        group["both"] = np.stack([DRIVE, RESPONSE], axis=1)
    for dataset, prefix in (("multisine", ""), (None, "multisine/"), (None, "/multisine."), ("/multisine/", "")):
        record = read(path, prefix + "u", prefix + "x", Channel(name=prefix + "fs", unit="Hz"), dataset=dataset)
        assert_the_loop(record)
    assert_the_loop(read(path, "u", "x", Channel(name="rate", unit="Hz"), dataset="multisine"))
    columns = [Channel(column=k, unit=unit) for k, unit in ((1, "V"), (2, "um"))]
    assert_the_loop(read(path, *columns, None, dataset="multisine/both", sample_rate=1 / DT))
    indices = [Channel(dataset="multisine.both", index=(":", k), unit=unit) for k, unit in ((0, "V"), (1, "um"))]
    assert_the_loop(read(path, *indices, None, sample_rate=1 / DT))


def test_matlab_v5_structs_and_cells(tmp_path, read):
    from scipy.io import savemat

    path = tmp_path / "rig.mat"
    loops = {"init": {"E": {"p": DRIVE}, "x": RESPONSE[:, None]}, "note": "good"}
    cells = np.empty(2, object)
    cells[:] = [DRIVE[None, :], RESPONSE]
    savemat(path, {"Loops": loops, "both": np.stack([DRIVE, RESPONSE], axis=1), "cells": cells, "dt": DT})
    step = Channel(name="dt", unit="s")
    assert_the_loop(read(path, Channel("Loops.init.E.p", unit="V"), Channel("Loops/init/x", unit="um"), step))
    assert_the_loop(read(path, Channel("cells.1", unit="V"), Channel("cells.2", unit="um"), step))
    named = [Channel(dataset="both", column=k, unit=unit) for k, unit in ((1, "V"), (2, "um"))]
    assert_the_loop(read(path, *named, step))
    record = read(path, Channel("E.p", unit="V"), Channel("x", unit="um"), None, dataset="Loops.init", sample_rate=2)
    assert_the_loop(record)


def test_matlab_v73_is_stored_column_by_column(tmp_path, read):
    import h5py

    path = tmp_path / "rig.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["Loops/u"] = DRIVE[None, :]
        file["Loops/both"] = np.stack([DRIVE, RESPONSE])
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file")
    both = Channel(dataset="both", column=2, unit="um")
    assert_the_loop(read(path, U, both, None, dataset="Loops", sample_rate=1 / DT))


@settings(max_examples=40, deadline=None)
@given(arrays.array_shapes(min_dims=2, max_dims=4, min_side=3, max_side=5), st.data())
def test_npy_by_index_and_column(read, tmp_path_factory, shape, data):
    array = np.random.default_rng(0).normal(size=shape)
    path = tmp_path_factory.getbasetemp() / "u.npy"
    np.save(path, array)
    rest = tuple(data.draw(st.integers(0, side - 1)) for side in shape[1:])
    record = read(
        path, Channel(index=(":", *rest), unit="V"), Channel(index=(":", *rest), unit="m"), None, sample_rate=1
    )
    np.testing.assert_array_equal(record.drive[0], array[(slice(None), *rest)])
    column, others = rest[0], rest[1:]
    channel = Channel(column=column + 1, unit="V")
    record = read(path, channel, channel, None, sample_rate=1, index=(":", ":", *others))
    np.testing.assert_array_equal(record.response[0], array[(slice(None), column, *others)])


def test_npy_structured(tmp_path, read):
    path = tmp_path / "loop.npy"
    np.save(path, np.array(list(zip(TIME, DRIVE, RESPONSE, strict=True)), dtype=[(name, float) for name in NAMED]))
    assert_the_loop(read(path))


def test_the_content_decides_where_the_name_says_only_data(tmp_path, read):
    path = tmp_path / "loop.dat"
    with path.open("wb") as file:
        np.save(file, np.stack([DRIVE, RESPONSE], axis=1))
    assert_the_loop(read(path, Channel(column=1, unit="V"), Channel(column=2, unit="um"), None, sample_rate=1 / DT))


@pytest.mark.parametrize("suffix", sorted(readers.suffixes()))
def test_a_damaged_file_of_any_format_is_an_input_error(tmp_path, problem, suffix):
    path = tmp_path / f"broken{suffix}"
    path.write_bytes(b"\x00\x01 neither text nor anything else" * 20)
    assert problem(path).message


def test_npz_has_an_array_a_signal(tmp_path, read):
    path = tmp_path / "loop.npz"
    np.savez(path, t=TIME, u=DRIVE, x=RESPONSE)
    assert_the_loop(read(path, U, X, Channel(name="t", unit="s")))


@pytest.mark.parametrize("name", ["loop.csv.gz", "loop.csv"])
def test_text_that_is_packed_is_unpacked(tmp_path, read, name):
    path = tmp_path / name
    rows = "".join(f"{float(t)!r},{float(u)!r},{float(x)!r}\n" for t, u, x in zip(TIME, DRIVE, RESPONSE, strict=True))
    path.write_bytes(gzip.compress(("t [s],u [V],x [um]\n" + rows).encode()))
    assert_the_loop(read(path))


def test_an_archive_is_no_workbook(tmp_path, problem):
    with zipfile.ZipFile(tmp_path / "loop.zip", "w") as archive:
        archive.writestr("loop.csv", "t [s],u [V],x [um]\n")
    error = problem(tmp_path / "loop.zip")
    assert error.message == "is an archive and no workbook" and error.remedy.startswith("unpack it")


def test_a_workbook_is_read_by_its_content(tmp_path, read):
    write_sheets(tmp_path / "rig.xlsx", Loop=ROWS)
    assert_the_loop(read((tmp_path / "rig.xlsx").rename(tmp_path / "rig.xls")))
