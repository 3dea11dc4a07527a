"""A fit handed on to other programs, and read again."""

import csv
import json

import numpy as np
import pytest
from click.testing import CliRunner

import pzt_ident as pzt
from pzt_ident.cli.commands import main


def test_json_loads_again_as_the_model(fit, demo, tmp_path):
    (path,) = fit.export(tmp_path, "json")
    again = pzt.load(path)
    time, drive = demo[0][:2]
    np.testing.assert_allclose(again.simulate(time, drive), fit.simulate(time, drive), rtol=1e-12, atol=1e-15)
    for name, parameter in fit.parameters.items():
        found = again.parameters[name]
        assert (found.unit, found.stderr) == (parameter.unit, parameter.stderr)
        assert found.value == pytest.approx(parameter.value, rel=1e-12)
    assert "bouc_wen.gain" in repr(again)
    assert [each.read_text() for each in again.export(tmp_path / "c")] == [
        each.read_text() for each in fit.export(tmp_path / "again")
    ]


def test_identified_values_stand_in_the_c_with_unit_and_error(fit, tmp_path):
    header = fit.export(tmp_path)[0].read_text()
    gain = fit.parameters["bouc_wen.gain"]
    assert f"double bouc_wen_gain; /* {gain.unit}, standard error {gain.stderr:.2g}." in header
    assert "#define FIT_DT" in header


def test_another_rate_changes_the_sample_time(fit, tmp_path):
    assert "#define FIT_DT 0.0001 " in fit.export(tmp_path, rate="10 kHz")[0].read_text()


def test_tables_hold_parameters_and_a_response(fit, tmp_path):
    parameters, response = (list(csv.DictReader(path.open())) for path in fit.export(tmp_path, "csv"))
    assert {row["parameter"]: float(row["value"]) for row in parameters} == pytest.approx(
        {name: item.value for name, item in fit.parameters.items()}
    )
    assert list(response[0]) == ["time [s]", "u_x [V]", "x [um]"] and len(response) > 100


def exported(*arguments):
    return CliRunner().invoke(main, ["export", *map(str, arguments)])


def test_command_exports_a_folder_of_results(fit, tmp_path):
    folder = fit.save(tmp_path / "run")
    made = exported(folder, "--to", "c", "--out", tmp_path / "c", "--json")
    assert made.exit_code == 0, made.output
    assert json.loads(made.output)["files"] == [str(tmp_path / "c" / f"fit{end}") for end in (".h", ".c", "_test.c")]


@pytest.mark.parametrize(
    ("to", "more", "said"),
    [
        ("d", (), "export: unknown format 'd'\n  known: c, csv, fmu, json, matlab"),
        ("c", ("--precision", "half"), "unknown precision 'half'"),
        ("c", ("--rate", "3 V"), "rate: '3 V' is no sample rate"),
    ],
)
def test_what_cannot_be_exported_is_named(fit, tmp_path, to, more, said):
    (path,) = fit.export(tmp_path, "json")
    made = exported(path, "--to", to, "--out", tmp_path / "out", *more)
    assert made.exit_code == 2 and said in made.output
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["", "nothing", "job.json"])
def test_what_is_no_result_is_named(tmp_path, name):
    (tmp_path / "job.json").write_text("[1]")
    made = exported(tmp_path / name, "--to", "c", "--out", tmp_path / "out")
    assert made.exit_code == 2
    assert str(tmp_path / name) in made.output and "give the folder of a finished run" in made.output
