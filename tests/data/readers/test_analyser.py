import pytest

EXPORT = """PiezoResult

Table 1
Table No [#]\tVc+ [V]\tDpp [nm]\t
1.0\t100.0\t3.0\t
2.0\t200.0\t4.0\t
3.0\t300.0\t5.0\t

Piezo
Program: analyser 3.0
TimeStamp: 08/23/2019 13:57:50

Table 1
SampleName: slow
Area [mm2]: 60
Time [s]\tV+ [V]\tD1 [nm]\t
0.0\t0.0\t1.0\t
0.1\t5.0\t3.0\t
0.2\t0.0\t2.0\t

Table 2
SampleName: fast
Area [mm2]: 60
Time [s]\tV+ [V]\tD1 [nm]\t
0.00\t0.0\t1.0\t
0.01\t7.0\t3.0\t
0.02\t0.0\toops\t
"""
CHANNELS = ("V+ [V]", "D1 [nm]", "Time [s]")


@pytest.fixture
def export(tmp_path):
    path = tmp_path / "loops.dat"
    path.write_text(EXPORT.replace("mm2", "mm\u00b2"), encoding="latin-1")
    return path


@pytest.mark.parametrize("table", [1, "1", "Table 1", "slow"])
def test_a_table_by_number_heading_or_sample(export, read, table):
    record = read(export, *CHANNELS, table=table)
    assert record.drive[0].tolist() == [0, 5, 0]
    assert record.dt == pytest.approx(0.1)


def test_the_only_table_needs_no_number(tmp_path, read):
    path = tmp_path / "loops.dat"
    path.write_text(EXPORT.partition("Table 2")[0])
    assert read(path, *CHANNELS).drive[0].tolist() == [0, 5, 0]


def test_lines_are_counted_from_the_top_of_the_file(export, problem):
    error = problem(export, *CHANNELS, table=2)
    assert "row 2 (line 27) holds 'oops' instead of a number" in error.message


@pytest.mark.parametrize(
    ("table", "message", "remedy"),
    [
        (None, "has 2 tables", "`table: 1`"),
        (3, "has no table 3", "fast, slow"),
        ("fsat", "has no table 'fsat'", "'fast'"),
    ],
)
def test_which_table_is_said(export, problem, table, message, remedy):
    error = problem(export, *CHANNELS, table=table)
    assert message in error.message
    assert remedy in error.remedy


def test_a_sample_measured_twice_is_named_by_number(tmp_path, problem):
    path = tmp_path / "loops.dat"
    path.write_text(EXPORT.replace("fast", "slow"))
    error = problem(path, *CHANNELS, table="slow")
    assert "has 2 tables 'slow'" in error.message
    assert "`table: 1`" in error.remedy


def test_a_plain_file_has_no_table_3(tmp_path, problem):
    path = tmp_path / "loop.dat"
    path.write_text("t [s],u [V],x [um]\n0,0,1\n1,1,3\n2,0,2\n")
    assert "no tables" in problem(path, table=3).message
