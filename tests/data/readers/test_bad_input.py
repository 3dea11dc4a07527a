"""Every mistake in a file or in what a job says of it: one error with file, place, value and remedy."""

import numpy as np
import pytest

from pzt_ident.data.readers import read_records
from pzt_ident.data.record import Axis, Channel, Source
from pzt_ident.errors import InputError

HEADER = "t [s],u [V],x [um]\n"
ROWS = ["0,0,1", "1,1,3", "2,0,2", "3,1,4", "4,0,2", "5,1,3"]


def write(folder, *rows, header=HEADER, name="loop.csv"):
    path = folder / name
    path.write_text(header + "".join(f"{row}\n" for row in rows), encoding="utf-8")
    return path


def test_missing_file_names_the_nearest(tmp_path, problem):
    write(tmp_path, *ROWS, name="minor_loops.csv")
    error = problem(tmp_path / "minor_lops.csv")
    assert error.message == "no such file"
    assert "'minor_loops.csv'" in error.remedy
    assert "no folder" in problem(tmp_path / "nowhere" / "a.csv").remedy


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file is empty"),
        ("\n\n", "no table of numbers"),
        (HEADER, "no table"),
        (f"{HEADER}0,1,2\n", "holds one row of numbers"),
        ("0;1,5;2\n", "holds one row of numbers"),
    ],
)
def test_empty_file(tmp_path, problem, text, message):
    assert message in problem(write(tmp_path, header=text)).message


def test_unset_variable_in_a_path(tmp_path, monkeypatch):
    monkeypatch.delenv("RIG_DATA", raising=False)
    source = Source("${RIG_DATA}/loop.csv")
    axes = {"x": Axis(Channel("u"), Channel("x"))}
    with pytest.raises(InputError, match="variable RIG_DATA is not set"):
        read_records([source], axes, Channel("t"), tmp_path)
    write(tmp_path, *ROWS)
    monkeypatch.setenv("RIG_DATA", str(tmp_path))
    assert read_records([source], axes, Channel("t"), tmp_path / "elsewhere")[0].samples == 6


@pytest.mark.parametrize(
    ("name", "message", "remedy"),
    [
        ("displacement", "has no column 'displacement'", "known: "),
        ("xx [um]", "has no column 'xx [um]'", "'x [um]'"),
        ("x [V]", "has no column 'x [V]'", "'x [um]'"),
    ],
)
def test_unknown_column_names_the_nearest(tmp_path, problem, name, message, remedy):
    error = problem(write(tmp_path, *ROWS), response=name)
    assert error.message == message
    assert remedy in error.remedy
    assert error.where.endswith("loop.csv: x.response")


def test_a_name_in_a_file_without_header(tmp_path, problem):
    assert "it has no header: give `column:` 1 to 3" in problem(write(tmp_path, *ROWS, header="")).remedy


def test_a_name_that_occurs_twice(tmp_path, problem):
    error = problem(write(tmp_path, *ROWS, header="t [s],x [um],x [um]\n"), drive=Channel(column=2))
    assert error.message == "column 'x [um]' occurs 2 times"
    assert "2 and 3" in error.remedy


@pytest.mark.parametrize("number", [-1, 0, 4])
def test_column_number_out_of_range(tmp_path, problem, number):
    error = problem(write(tmp_path, *ROWS), response=Channel(column=number))
    assert error.message == f"column {number} is out of range"
    assert "from 1 to 3" in error.remedy


def test_neither_name_nor_number(tmp_path, problem):
    assert "holds 3 columns" in problem(write(tmp_path, *ROWS), response=Channel(unit="um")).message


@pytest.mark.parametrize("header", [HEADER, ""])
@pytest.mark.parametrize("row", range(6))
def test_text_in_a_number_column(tmp_path, problem, header, row):
    rows = [*ROWS]
    rows[row] = f"{row},{row % 2},overload"
    channels = [Channel(column=k, unit=unit) for k, unit in ((2, "V"), (3, "um"), (1, "s"))]
    error = problem(write(tmp_path, *rows, header=header), *channels)
    assert error.message == f"row {row} (line {row + 1 + bool(header)}) holds 'overload' instead of a number"


def test_bad_rows_outside_the_slice_do_not_matter(tmp_path, read):
    path = write(tmp_path, "0,0,nan", *ROWS[1:5], "5,1,overload")
    assert read(path, rows=(1, 5)).samples == 4


@pytest.mark.parametrize("gap", ["", "nan", "NaN", "N/A"])
def test_gaps_name_their_rows(tmp_path, problem, gap):
    rows = [*ROWS]
    for row in (1, 2, 4):
        rows[row] = f"{row},{row % 2},{gap}"
    error = problem(write(tmp_path, *rows))
    assert error.message == "3 values are missing: row 1 (line 3) to row 2 (line 4), row 4 (line 6)"
    rows[1] = "1,,3"
    assert "row 1 (line 3)" in problem(write(tmp_path, *rows), response=Channel("u")).message


@pytest.mark.parametrize(("row", "fields"), [("3", "1 field"), ("3,1", "2 fields"), ("3,1,4,9", "4 fields")])
def test_ragged_lines(tmp_path, problem, row, fields):
    error = problem(write(tmp_path, *ROWS[:3], row, *ROWS[4:]))
    assert error.message == f"line 5 has {fields} instead of 3"


def test_a_first_line_of_numbers_that_is_torn_is_no_header(tmp_path, problem):
    path = tmp_path / "bare.txt"
    path.write_text("0 0 0 9 1\n" + "".join(f"{i} {i % 2} {i % 3}\n" for i in range(8)))
    columns = (Channel(column=i, unit=unit) for i, unit in ((2, "V"), (3, "um"), (1, "s")))
    assert problem(path, *columns).message == "line 1 has 5 fields instead of 3"


@pytest.mark.parametrize(
    ("stamp", "message"),
    [
        ("2", "time repeats at row 3 (line 5): 2 s after 2 s"),
        ("1.5", "time runs backward at row 3 (line 5): 1.5 s after 2 s"),
        ("3.5", "time is not uniform: the step after row 2 (line 4) is 1.5 s, 1.5 times the usual 1 s"),
        ("3.02", "time is not uniform: the step after row 2 (line 4) is 1.02 s, 1.02 times the usual 1 s"),
        ("", "1 value is missing: row 3 (line 5)"),
        ("inf", "1 value is infinite: row 3 (line 5)"),
        ("3_0", "row 3 (line 5) holds '3_0' instead of a number"),
    ],
)
def test_time_that_is_no_grid(tmp_path, problem, stamp, message):
    error = problem(write(tmp_path, *ROWS[:3], f"{stamp},1,4", *ROWS[4:]))
    assert error.message == message
    assert error.where.endswith("loop.csv: time")


def test_time_that_starts_again_says_which_rows_to_take(tmp_path, problem):
    path = write(tmp_path, *ROWS[:4], *ROWS[:2])
    assert "`rows: [0, 4]`" in problem(path).remedy
    assert "`rows: [1, 4]`" in problem(path, rows=(1, None)).remedy


@pytest.mark.parametrize("stamp", ["12:30:01.5", "2024-03-01", "2024-03-01 12:30:01.5"])
def test_time_of_day_is_not_read(tmp_path, problem, stamp):
    error = problem(write(tmp_path, *(f"{stamp},{i % 2},{i}" for i in range(5))))
    assert "instead of a number" in error.message
    assert "give `sample_rate`" in error.remedy


def test_a_folder_is_no_file(tmp_path, problem):
    assert problem(tmp_path).message == "Is a directory"


def test_a_missing_sample_is_no_grid(tmp_path, problem):
    assert "2 times the usual" in problem(write(tmp_path, *ROWS[:3], *ROWS[4:])).message


def test_jitter_below_a_hundredth_is_made_regular(tmp_path, read):
    record = read(write(tmp_path, *ROWS[:3], "3.009,1,4", *ROWS[4:]))
    np.testing.assert_allclose(record.time, np.arange(6), rtol=1e-12)


def test_sample_rate_against_the_time_channel(tmp_path, read, problem):
    path = write(tmp_path, *ROWS)
    assert read(path, sample_rate=1.009).dt == 1
    message = problem(path, sample_rate=200).message
    assert message == "sample_rate 200 Hz contradicts the time channel, which has 1 Hz"


@pytest.mark.parametrize(
    ("rate", "message"), [(None, "has no time"), (0.0, "sample rate 0 Hz"), (-5.0, "sample rate -5 Hz")]
)
def test_no_time(tmp_path, problem, rate, message):
    assert message in problem(write(tmp_path, *ROWS), clock=None, sample_rate=rate).message


def test_constant_response_is_an_error_and_constant_drive_is_not(tmp_path, read, problem):
    path = write(tmp_path, *(f"{i},5,{i * i}" for i in range(5)))
    assert np.ptp(read(path).drive) == 0
    path = write(tmp_path, *(f"{i},{i},-317.2" for i in range(5)))
    assert "the response is constant (-317.2 um in all 5 samples)" in problem(path).message


@pytest.mark.parametrize(("parked", "is_read"), [("0", True), ("{i}", False)])
def test_an_axis_that_is_held_while_another_moves_may_have_a_constant_response(tmp_path, parked, is_read):
    header = "t [s],u [V],v [V],x [um],y [um]\n"
    path = write(tmp_path, *(f"{i},{parked},{i * i},-0,{i}".format(i=i) for i in range(5)), header=header)
    axes = {name: Axis(Channel(name=drive), Channel(name=name)) for name, drive in (("x", "u"), ("y", "v"))}
    source = Source(file=path.name, use="identify")
    if is_read:
        (record,) = read_records([source], axes, Channel(name="t"), tmp_path)
        assert not record.response[0].any()
        return
    with pytest.raises(InputError, match=r"the response is constant \(0 um in all 5 samples\)"):
        read_records([source], axes, Channel(name="t"), tmp_path)


def test_the_shortest_record(tmp_path, read, problem):
    assert read(write(tmp_path, *ROWS[:3])).samples == 3
    assert "has 2 samples, at least 3" in problem(write(tmp_path, *ROWS[:2])).message
    assert "has 2 samples, at least 3" in problem(write(tmp_path, *ROWS), decimate=4).message
    assert "has 1 sample" in problem(write(tmp_path, *ROWS), rows=(2, 3)).message


def test_settle_leaves_something(tmp_path, read, problem):
    path = write(tmp_path, *ROWS)
    assert read(path, settle=2.0).settle == 2
    assert "settle 6 s leaves nothing of 6 s" in problem(path, settle=6.0).message


@pytest.mark.parametrize("rows", [(0, 7), (4, 2), (3, 3), (-1, 3), (6, None)])
def test_rows_out_of_range(tmp_path, problem, rows):
    error = problem(write(tmp_path, *ROWS), rows=rows)
    assert "out of range" in error.message
    assert "[0, 6]" in error.remedy


@pytest.mark.parametrize("time", [(-1, 3), (2, 9), (4, 2), (7, None)])
def test_time_out_of_range(tmp_path, problem, time):
    error = problem(write(tmp_path, *ROWS), time=time)
    assert "out of range" in error.message
    assert "from 0 s to 5 s" in error.remedy


def test_no_unit_says_how_to_give_one(tmp_path, problem):
    error = problem(write(tmp_path, *ROWS, header="t [s],u [V],x\n"), response="x")
    assert error.message == "has no unit"
    assert "`x [um]`" in error.remedy
    assert "`unit: um`" in error.remedy
    clock = problem(write(tmp_path, *ROWS, header="t,u [V],x [um]\n"), clock="t")
    assert clock.where.endswith(": time") and "`t [s]`" in clock.remedy and "`unit: s`" in clock.remedy
    assert "`u [V]`" in problem(write(tmp_path, *ROWS, header="t [s],u,x [um]\n"), drive="u").remedy


def test_dates_without_a_unit_are_dates_first(tmp_path, problem):
    dates = [f"2026-03-14T09:26:5{i},{i % 2},{i}\n" for i in range(6)]
    assert "dates" in problem(write(tmp_path, *dates, header="t,u [V],x [um]\n"), clock="t").remedy


def test_a_unit_that_is_none(tmp_path, problem):
    error = problem(write(tmp_path, *ROWS, header="t [s],u [V],x [furlong]\n"), response="x")
    assert error.message == "unknown unit 'furlong'"
    assert error.where.endswith("loop.csv: x.response")
    assert "um" in error.remedy


def test_a_unit_of_the_wrong_kind(tmp_path, problem):
    path = write(tmp_path, *ROWS)
    assert problem(path, drive="t [s]").message == "a drive cannot have the unit 's'"
    assert problem(path, response=Channel("x", unit="kHz")).message == "a response cannot have the unit 'kHz'"
    assert problem(path, response=Channel("x", unit="kg")).message == "a response cannot have the unit 'kg'"
    assert problem(path, clock="u [V]").message == "time cannot have the unit 'V'"
    assert problem(path, clock=Channel("t", unit="Hz")).message == "time cannot have the unit 'Hz'"


def test_records_of_one_axis_have_one_kind_of_unit(tmp_path):
    write(tmp_path, *ROWS, name="a.csv")
    write(tmp_path, *ROWS, name="b.csv", header="t [s],u [kV/cm],x [um]\n")
    with pytest.raises(InputError, match=r"axis x is in kV/cm, in the record 'a' it is in V"):
        read_records(
            [Source("a.csv"), Source("b.csv")], {"x": Axis(Channel("u"), Channel("x"))}, Channel("t"), tmp_path
        )


def test_a_text_file_that_is_none(tmp_path, problem):
    path = tmp_path / "loop.csv"
    path.write_bytes(b"\x89PNG\r\n\x1a\n\x00\x00")
    assert "not a text file" in problem(path).message


@pytest.fixture
def array(tmp_path):
    path = tmp_path / "u.npy"
    np.save(path, np.random.default_rng(1).normal(size=(8, 3, 2)))
    return path


@pytest.mark.parametrize("index", [(":", 3, 0), (":", 0, 0, 0), (":", "one", 0)])
def test_wrong_index(array, problem, index):
    error = problem(array, Channel(unit="V"), Channel(unit="V"), None, sample_rate=1, index=index)
    assert error.message == f"index [{', '.join(map(str, index))}] is wrong"
    assert "(8, 3, 2)" in error.remedy


def test_an_array_is_not_one_signal(array, problem):
    channel = Channel(unit="V")
    message = problem(array, channel, channel, None, sample_rate=1, index=(":", ":", 0)).message
    assert message == "'u' is an array of shape (8, 3), not one signal"
    channel = Channel(column=4, unit="V")
    assert "column 4" in problem(array, channel, channel, None, sample_rate=1, index=(":", ":", 0)).message


@pytest.mark.parametrize("values", [np.arange(4) * 1j, np.array(["2024-01-01"] * 4, dtype="M8[s]")])
def test_numbers_that_are_not_real(tmp_path, problem, values):
    path = tmp_path / "u.npy"
    np.save(path, values)
    assert "not real numbers" in problem(path, Channel(unit="V"), Channel(unit="V"), None, sample_rate=1).message


def test_unknown_data_set(tmp_path, problem):
    import h5py

    path = tmp_path / "rig.h5"
    with h5py.File(path, "w") as file:
        file["multisine/u"] = np.arange(5.0)
        file["sweep/u"] = np.arange(5.0)
    error = problem(path, "u", "u", None, dataset="multisin", sample_rate=1)
    assert error.message == "has no data set 'multisin'"
    assert "'multisine'" in error.remedy
    error = problem(path, "v", "v", None, dataset="sweep", sample_rate=1)
    assert (error.message, error.remedy) == ("has no column 'v'", "known: u")


def test_signals_of_different_length(tmp_path, problem):
    np.save(tmp_path / "u.npy", np.arange(5.0))
    np.save(tmp_path / "x.npy", np.arange(6.0))
    channels = Channel(unit="V"), Channel(unit="um", file="x.npy")
    message = problem(tmp_path / "u.npy", *channels, None, sample_rate=1).message
    assert "differ in length" in message
    assert "u.npy: x.drive 5" in message
    assert "x.npy: x.response 6" in message


def test_time_of_different_length(tmp_path, problem):
    np.save(tmp_path / "u.npy", np.arange(5.0))
    np.save(tmp_path / "t.npy", np.arange(6.0))
    signal = Channel(unit="V")
    with pytest.raises(InputError, match="time: has 6 rows, the signals have 5"):
        read_records([Source("u.npy")], {"x": Axis(signal, signal)}, Channel(unit="s", file="t.npy"), tmp_path)


def test_a_channel_of_the_record_that_no_axis_has(tmp_path, problem):
    error = problem(write(tmp_path, *ROWS), channels={"x.respnse": Channel("x")})
    assert error.message == "unknown channel 'x.respnse'"
    assert "'x.response'" in error.remedy
