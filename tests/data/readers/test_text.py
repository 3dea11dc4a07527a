import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pzt_ident.data.record import Channel
from pzt_ident.data.units import plain

NUMBERS = st.floats(-1e7, 1e7, allow_nan=False).filter(lambda x: x == 0 or abs(x) > 1e-9)
HEADERS = {
    "brackets": ["t [ms]{d}u [kV]{d}x [um]"],
    "parentheses": ["t (ms){d}u (kV){d}x (um)"],
    "unit line": ["t{d}u{d}x", "ms{d}kV{d}um"],
    "quoted": ['"t [ms]"{d}"u [kV]"{d}"x [um]"'],
    "comment": ["# made by a rig", "# t [ms]{d}u [kV]{d}x [um]"],
    "preamble": ["Rig 3, 21.11.", "Operator: N N", "", "t [ms]{d}u [kV]{d}x [µm]"],
}


ROWS = st.lists(st.tuples(NUMBERS, NUMBERS), min_size=3, max_size=8).filter(lambda rows: np.ptp(rows, axis=0)[1] > 0)


@settings(max_examples=100, deadline=None)
@given(
    ROWS,
    st.sampled_from([("\t", "."), ("\t", ","), (";", "."), (";", ","), (",", "."), (" ", "."), ("   ", ",")]),
    st.sampled_from(sorted(HEADERS)),
    st.sampled_from(["utf-8", "utf-8-sig", "latin-1", "utf-16"]),
    st.sampled_from(["\n", "\r\n"]),
)
def test_round_trip_through_any_layout(read, rows, punctuation, header, encoding, newline):
    delimiter, decimal = punctuation
    cells = [[repr(value).replace(".", decimal) for value in (5.0 * i, *row)] for i, row in enumerate(rows)]
    lines = [line.format(d=delimiter) for line in HEADERS[header]] + [delimiter.join(row) for row in cells]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "loop.dat"
        path.write_bytes(newline.join([*lines, ""]).encode(encoding))
        record = read(path, "u", "x", "t")
    drive, response = np.array(rows).T
    np.testing.assert_array_equal(record.drive[0], 1e3 * drive)
    np.testing.assert_array_equal(record.response[0], 1e-6 * response)
    assert record.dt == pytest.approx(5e-3)
    assert (record.drive_units, plain(record.response_units[0])) == (("kV",), "um")


@settings(max_examples=50, deadline=None)
@given(ROWS, st.sampled_from(["\t", ";", ",", " "]), st.booleans())
def test_round_trip_without_header(read, rows, delimiter, empty_first_column):
    first = delimiter if empty_first_column and delimiter != " " else ""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "loop.csv"
        path.write_text("\n".join(first + delimiter.join(map(repr, row)) for row in rows))
        drive, response = (Channel(column=k + bool(first), unit="V") for k in (1, 2))
        record = read(path, drive, response, None, sample_rate=1e3)
    np.testing.assert_array_equal([record.drive[0], record.response[0]], np.array(rows).T)
    assert record.dt == 1e-3


def write(folder, text, name="loop.csv"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


BODY = "0,0,1\n1,1,3\n2,0,2\n"


@pytest.mark.parametrize("name", ["x [um]", "x", "X [UM]", "X"])
def test_a_name_may_leave_out_unit_and_case(tmp_path, read, name):
    path = write(tmp_path, "t [s],u [V],x [um]\n" + BODY)
    np.testing.assert_allclose(read(path, response=name).response[0], [1e-6, 3e-6, 2e-6])


def test_micro_signs_are_one(tmp_path, read):
    path = write(tmp_path, "t [s],u [V],x [\u00b5m]\n" + BODY)
    np.testing.assert_allclose(read(path, response="x [\u03bcm]").response[0], [1e-6, 3e-6, 2e-6])


def test_the_exact_header_wins_over_the_same_name(tmp_path, read):
    path = write(tmp_path, "t [s],u [V],x [um],x [V]\n0,0,1,7\n1,1,3,8\n2,0,2,9\n")
    assert read(path, response="x [V]").response[0].tolist() == [7, 8, 9]


def test_the_unit_of_the_job_wins(tmp_path, read):
    path = write(tmp_path, "t [s],u [V],x [um]\n" + BODY)
    record = read(path, drive=Channel(name="u", unit="20 V"), response=Channel(column=3, unit="nm"))
    np.testing.assert_allclose(record.drive[0], [0, 20, 0])
    np.testing.assert_allclose(record.response[0], [1e-9, 3e-9, 2e-9])
    assert (record.drive_units, record.response_units) == (("V",), ("nm",))


def test_comments_and_empty_lines_between_the_rows_are_skipped(tmp_path, read):
    path = write(tmp_path, "# rig 3\nt [s],u [V],x [um]\n0,0,1\n\n# bump\n1,1,3\n2,0,2\n\n")
    assert read(path).samples == 3


def test_a_column_of_text_does_not_disturb_the_others(tmp_path, read):
    path = write(tmp_path, "t [s],u [V],x [um],note\n0,0,1,up\n1,1,3,\n2,0,2,down\n")
    assert read(path).samples == 3


def test_a_block_of_settings_with_a_table_like_shape_is_no_data(tmp_path, read):
    path = write(tmp_path, "R,Ohm\tC,pF\tT,C\n000\t100\t+25\nu,V\tx,um\tt,s\n0\t1\t0\n1\t3\t1\n0\t2\t2\n")
    record = read(path, "u", "x", "t")
    assert record.drive[0].tolist() == [0, 1, 0]


def test_the_trailing_delimiter_of_an_instrument_is_no_column(tmp_path, read):
    path = write(tmp_path, "t [s]\tu [V]\tx [um]\t\n0\t0\t1\t\n1\t1\t3\t\n2\t0\t2\t\n")
    assert read(path).samples == 3


ROW_NAMES = {"of R": "1 2 3 4", "quoted": '"1" "2" "3" "4"', "from zero": "0 1 2 3", "from the middle": "17 18 19 20"}


@pytest.mark.parametrize("names", ROW_NAMES.values(), ids=ROW_NAMES)
@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_names_of_rows_have_none_in_the_header(tmp_path, read, names, delimiter):
    lines = [f"{name},{i},{i % 2},{0.5 * i}" for i, name in enumerate(names.split())]
    record = read(write(tmp_path, "\n".join(["t [s],u [V],x [um]", *lines]).replace(",", delimiter)))
    assert record.drive[0].tolist() == [0, 1, 0, 1] and record.dt == 1


@pytest.mark.parametrize("header", ["t [s],u [V],x [um]", "t (s);u (V);x (um)", "t,u,x\ns,V,um"])
@pytest.mark.parametrize("row", ["0,{},1,2{}", "0,{},1,7,2,5{}", "{},3.5,1,0.2{}"])
def test_more_numbers_than_the_header_names_are_refused(tmp_path, problem, header, row):
    """As where the decimal sign is the comma between the columns: no name says which column is meant."""
    lines = [row.format(7 * i, i) for i in range(9)]
    error = problem(write(tmp_path, "\n".join([header, *lines])))
    assert "the header names 3 columns" in error.message and "semicolons" in error.remedy


def test_flags_at_the_end_of_a_row_need_no_name(tmp_path, read):
    lines = [f"{i},{i % 2},{0.5 * i},{i // 3}" for i in range(8)]
    assert read(write(tmp_path, "\n".join(["t [s],u [V],x [um]", *lines]))).response[0, -1] == 3.5e-6


@pytest.mark.parametrize("footer", ["Mean,0.4,2.1", "Mean,0.4,2.1\nStd,0.5,1.2", "Total,,"])
def test_statistics_at_the_end_are_no_measurement(tmp_path, problem, footer):
    """Though the column of their names is not asked for."""
    lines = [f"{i},{i % 2},{0.5 * i}" for i in range(20)]
    path = write(tmp_path, "\n".join(["t [s],u [V],x [um]", *lines, footer, ""]))
    error = problem(path, clock=None, sample_rate=10)
    assert footer.splitlines()[-1].split(",")[0] in error.message and "line" in error.message


@pytest.mark.parametrize(
    ("mark", "delimiter", "decimal"),
    [(".", ",", "."), (".", ";", "."), (".", ";", ","), (",", ";", "."), (",", ";", ","), (",", "\t", ".")],
)
def test_thousands_are_told_from_decimals(tmp_path, problem, mark, delimiter, decimal):
    """Whole numbers below a thousand have no mark, and those above it have three digits behind each."""
    lines = [[f"{0.1 * i:.1f}".replace(".", decimal), str(i % 7), f"{40 * i:,}".replace(",", mark)] for i in range(60)]
    path = write(tmp_path, "\n".join(delimiter.join(line) for line in [["t [s]", "u [V]", "x [nm]"], *lines]))
    error = problem(path, response="x [nm]")
    assert error.message.startswith(f"row 25 (line 27) holds '1{mark}000', which reads as a decimal or as thousands")
    assert error.where.endswith("x.response")


@pytest.mark.parametrize("mark", ["'", " ", "’"])
def test_thousands_with_decimals_are_told(tmp_path, problem, mark):
    lines = [f"{i};{i % 7};" + f"{40.5 * i:,.2f}".replace(",", mark) for i in range(60)]
    error = problem(write(tmp_path, "\n".join(["t [s];u [V];x [um]", *lines])))
    assert error.remedy == "export the numbers without signs between the thousands"


@given(st.lists(st.integers(-4000, 4000), min_size=3, max_size=40), st.sampled_from([1, 2, 3, 4]), st.booleans())
def test_decimals_are_no_thousands(read, values, digits, short):
    """However many digits they have, with or without the zeros at their end."""
    written = [f"{value / 10**digits:.{digits}f}" for value in values]
    cells = [text.rstrip("0").rstrip(".") if short else text for text in written]
    if short and {len(cell.partition(".")[2]) for cell in cells} <= {0, 3}:
        return
    lines = [f"{i};{i % 3};{cell}".replace(".", ",") for i, cell in enumerate([*cells, "0,5", "0,25"])]
    with tempfile.TemporaryDirectory() as folder:
        record = read(write(Path(folder), "\n".join(["t [s];u [V];x [um]", *lines])))
    np.testing.assert_allclose(record.response[0, :-2], 1e-6 * np.array(values) / 10**digits, atol=1e-18)


def test_the_exponents_of_fortran_are_read(tmp_path, read):
    rows = [f"{i:.1f}D+00 {2 * i:.2f}D-01 {i * i:.3f}D-03" for i in range(4)]
    record = read(write(tmp_path, "\n".join(["t[s] u[V] x[um]", *rows])), "u", "x", "t")
    np.testing.assert_allclose(record.drive[0], [0, 0.2, 0.4, 0.6])
    np.testing.assert_allclose(record.response[0], 1e-9 * np.array([0, 1, 4, 9]))


def test_units_in_the_cells_are_told(tmp_path, problem):
    path = write(tmp_path, "t,u,x\n" + "".join(f"{i} ms,{i % 3}.5 V,{i}.25 um\n" for i in range(6)))
    assert problem(path, "u", "x", "t").remedy.endswith(
        " ms': put the unit into the header, as in `x [um]`, and leave it out of every line"
    )


def test_a_second_header_is_another_measurement(tmp_path, problem):
    text = f"t [s],u [V],x [um]\n{BODY}"
    error = problem(write(tmp_path, text + text), clock=None, sample_rate=1)
    assert "holds 'u [V]' instead of a number" in error.message
    assert error.remedy.endswith("a record of its own, by `rows: [0, 3]` and `rows: [4, 7]`")


@pytest.mark.parametrize(
    ("unit", "note"),
    [
        ("um", "x.response is taken in um, as the job says, where the file says nm"),
        ("nm", ""),
        ("20 nm", ""),
        ("V", "x.response is taken in V, as the job says, where the file says nm"),
    ],
)
def test_a_unit_of_the_job_beside_another_one_of_the_file_is_said(tmp_path, read, unit, note):
    path = write(tmp_path, f"t [s],u [V],x [nm]\n{BODY}")
    notes = read(path, response=Channel(name="x", unit=unit)).notes
    assert [text for text in notes if "is taken in" in text] == ([note] if note else [])
