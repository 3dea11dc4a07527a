"""Tables on the terminal."""

import sys

from pzt_ident.cli.job_tables import show_job
from pzt_ident.cli.table import table
from terminal import Terminal


def test_table_columns_stand_under_their_headings(capsys):
    table(("name", "n"), [("long name", 1), ("x", None)])
    assert capsys.readouterr().out == "name       n\nlong name  1\nx\n\n"


def test_table_on_a_terminal_keeps_brackets(monkeypatch):
    screen = Terminal()
    monkeypatch.setattr(sys, "stdout", screen)
    table(("best [um]", "n"), [("[bold]", 1)])
    assert "best [um]" in screen.getvalue()
    assert "[bold]" in screen.getvalue()


def test_table_on_a_narrow_terminal_cuts_no_word(monkeypatch):
    screen = Terminal()
    monkeypatch.setattr(sys, "stdout", screen)
    monkeypatch.setenv("COLUMNS", "20")
    words = ("x.cross_coupling.ratio", "-0.2308", "standard_error", "not-determined")
    table(("parameter", "value", "error", "verdict"), [words])
    assert all(word in screen.getvalue() for word in words)


def test_a_range_has_no_negative_zero(capsys):
    axis = {"name": "x", "drive_unit": "V", "drive_range": [-0.0, 150.0]}
    axis |= {"response_unit": "um", "response_range": [-0.0, 11.56]}
    facts = {"name": "j", "hash": "0", "model": [], "records": [], "axes": [axis], "parameters": [], "notes": []}
    lacking = {"there is no second axis": ["cross_coupling", "kinematic_coupling"]}
    show_job(
        facts
        | {
            "runs": [],
            "evaluations": 0,
            "nameable": ["creep", "delay"],
            "faults": ["backlash", "clipping"],
            "out_of_place": lacking,
        }
    )
    said = capsys.readouterr().out
    assert "0 to 150 V" in said and "0 to 11.56 um" in said and "-0" not in said
    assert "a diagnosis may name creep and delay, and as faults of the set-up backlash and clipping" in said
    assert "no diagnosis names cross_coupling and kinematic_coupling: there is no second axis" in said
