"""Files that no rig writes and a user may still have: pipes, cells in the last corner, no values, values beyond all
measure, thousands of records of one file."""

import os
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from click.testing import CliRunner
from nptdms import ChannelObject, TdmsWriter

from pzt_ident.cli.commands import main
from pzt_ident.data.readers import read_records
from pzt_ident.data.record import Axis, Channel, Source
from pzt_ident.errors import InputError, in_words
from pzt_ident.report import figures
from sheets import write_sheets

HEADER = "t [s],u [V],x [um]\n"
ROWS = [["t [s]", "u [V]", "x [um]"], [0, 0, 1], [1, 1, 3], [2, 0, 2], [3, 1, 4]]


def with_cell(path, cell: str) -> None:
    """Put a number into one more cell of the first sheet."""
    with zipfile.ZipFile(path) as book:
        files = {name: book.read(name) for name in book.namelist()}
    row = "".join(filter(str.isdigit, cell))
    more = f'<row r="{row}"><c r="{cell}"><v>7</v></c></row></sheetData>'
    with zipfile.ZipFile(path, "w") as book:
        for name, content in files.items():
            book.writestr(name, content.replace(b"</sheetData>", more.encode()) if "s1.xml" in name else content)


@pytest.mark.parametrize(("cell", "row", "column"), [("XFD1048576", 1048576, 16384), ("ZZ90000", 90000, 702)])
def test_a_cell_far_from_the_table_of_a_workbook(tmp_path, problem, read, cell, row, column):
    path = tmp_path / "loop.xlsx"
    write_sheets(path, loop=ROWS, other=ROWS)
    with_cell(path, cell)
    error = problem(path)
    assert f"sheet 'loop' has cells as far as row {row} and column {column}" in error.message
    assert read(path, sheet="other").samples == 4


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names")
def test_a_pipe_is_no_file(tmp_path, problem):
    os.mkfifo(tmp_path / "loop.csv")
    assert "a pipe" in problem(tmp_path / "loop.csv").message


@pytest.mark.parametrize("shape", [(0,), (0, 3), (3, 0)])
@pytest.mark.parametrize("column", [None, 1])
def test_an_array_without_values(tmp_path, problem, shape, column):
    np.save(tmp_path / "u.npy", np.empty(shape))
    signal = Channel(unit="V", column=column), Channel(unit="um", column=column)
    assert problem(tmp_path / "u.npy", *signal, None, sample_rate=1).message == "holds no values"


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", ["1e300", "-1e300", "1e18", "1.7e308"])
@pytest.mark.parametrize("column", [0, 1, 2])
def test_a_value_beyond_all_measure(tmp_path, problem, value, column):
    rows = [["0", "0", "1"], ["1", "1", "3"], ["2", "0", "2"], ["3", "1", "4"]]
    rows[3][column] = value
    path = tmp_path / "loop.csv"
    path.write_text(HEADER + "".join(",".join(row) + "\n" for row in rows))
    error = problem(path)
    assert "row 3 (line 5)" in error.message or "time" in error.message


def test_a_measurement_of_ni_that_was_cut_short(tmp_path, problem, capfd):
    path = tmp_path / "loop.tdms"
    with TdmsWriter(path) as writer:
        writer.write_segment([ChannelObject("a", name, np.arange(9.0)) for name in "tux"])
    path.write_bytes(path.read_bytes()[:-20])
    assert problem(path).message == "is cut short: its last segment has fewer values than it says"
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    "said", ["", "TProtocolException: invalid", "<ast.Name object at 0x7f56>", "no type \x1b", "bad dtype"]
)
def test_what_a_library_says_to_programmers_is_not_passed_on(said):
    assert in_words(ValueError(said)) == "it is damaged"
    assert in_words(ValueError("the file has no end\nmore")) == "the file has no end"


def test_the_names_of_thousands_of_records_of_one_file(tmp_path):
    """In a time that grows as their number: 20,000 took minutes."""
    (tmp_path / "loop.csv").write_text(HEADER + "0,0,1\n1,1,3\n2,0,2\n3,1,4\n")
    axes = {"x": Axis(Channel("u"), Channel("x"))}
    records = read_records([Source("loop.csv")] * 300, axes, Channel("t"), tmp_path)
    assert [record.name for record in records] == [f"loop_{number}" for number in range(1, 301)]


@pytest.mark.skipif(sys.platform != "linux", reason="paths are text elsewhere")
def test_a_path_that_is_not_utf_8(tmp_path, monkeypatch):
    """Nothing fails after the run."""
    folder = os.path.join(os.fsencode(tmp_path), b"caf\xe9")
    os.mkdir(folder)
    t = np.arange(200) / 200
    x = 0.1 * t + np.random.default_rng(0).normal(0, 1e-3, t.size)
    rows = "".join(f"{a:.4f},{b:.4f},{c:.5f}\n" for a, b, c in zip(t, t, x, strict=True))
    job = (
        "name: a\nrecords: [{file: a.csv}]\n"
        'channels: {time: "t [s]", axes: {x: {drive: "u [V]", response: "x [um]"}}}\n'
        "model: [bouc_wen]\noptimizers: [{name: pso, population: 4, generations: 3}]\n"
    )
    for name, text in ((b"a.csv", HEADER + rows), (b"job.yaml", job)):
        with open(os.path.join(folder, name), "w") as file:
            file.write(text)
    out = os.path.join(folder, b"out")
    command = [sys.executable, "-m", "pzt_ident", "run"]
    words = [os.path.join(folder, b"job.yaml"), b"--out", out]
    ended = subprocess.run([*map(os.fsencode, command), *words], capture_output=True)
    assert ended.returncode == 0, ended.stderr
    every = figures.plates
    monkeypatch.setattr(figures, "plates", lambda results: every(results)[:1])
    for word in ("resume", "report"):
        ended = CliRunner().invoke(main, [word, os.fsdecode(out)])
        assert ended.exit_code == 0, ended.output
    assert os.path.exists(os.path.join(out, b"report.html"))


def test_values_at_the_limit_are_read(tmp_path, read):
    path = tmp_path / "loop.csv"
    path.write_text(HEADER.replace("u [V]", "u [V/m]") + "0,0,1\n1,1e9,3\n2,0,2\n3,1,4\n")
    assert read(path, drive="u [V/m]").drive.max() == 1e9
    with pytest.raises(InputError):
        path.write_text(HEADER.replace("u [V]", "u [kV/mm]") + "0,0,1\n1,1e12,3\n2,0,2\n3,1,4\n")
        read(path, drive="u [kV/mm]")
