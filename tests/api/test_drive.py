"""The drive for a reference: what it is, what it says, and what it refuses."""

import json

import numpy as np
import pytest

import pzt_ident as pzt
from pzt_ident.run.identified import read_identified

T = np.arange(800) * 5e-3
REFERENCE = 3 * np.sin(np.pi * T / T[-1]) ** 2


def test_the_model_follows(fit):
    found = fit.drive(T, REFERENCE)
    followed = fit.simulate(T, found.drive["x"])
    assert np.abs(followed - REFERENCE).max() < 1e-9 and found.peak["x"] < 1e-9
    assert found.units == {"x": "um"} and found.drive_units == {"x": "V"}
    assert "RMSE, predicted" in str(found)


def test_a_reference_may_be_in_another_unit(fit):
    nanometres = pzt.Record(T, 1e3 * REFERENCE, drive="nm")
    assert np.allclose(fit.drive(nanometres).drive["x"], fit.drive(T, REFERENCE).drive["x"], rtol=1e-12)


def test_the_limits_of_the_amplifier_are_kept_and_told(fit):
    free = fit.drive(T, REFERENCE).drive["x"]
    slew = 0.8 * np.abs(np.diff(free)).max() / 5e-3
    found = fit.drive(T, REFERENCE, limits=(-5.0, 0.9 * free.max()), slew=slew)
    assert found.drive["x"].max() <= 0.9 * free.max() + 1e-9
    assert np.abs(np.diff(found.drive["x"])).max() <= slew * 5e-3 * (1 + 1e-9)
    assert any("beyond the limits of the amplifier" in note and "falls short" in note for note in found.notes)


def test_what_the_identification_did_not_see_is_told(fit):
    notes = " ".join(fit.drive("2 kHz", 4 * REFERENCE).notes)
    assert "the model was identified from" in notes and "the model was identified up to" in notes


def test_a_reference_with_noise_is_told(fit):
    noisy = REFERENCE + 0.01 * np.random.default_rng(1).normal(size=T.size)
    assert any("as noise does" in note for note in fit.drive(T, noisy).notes)
    assert not any("as noise does" in note for note in fit.drive(T, REFERENCE).notes)


def test_a_drive_is_kept_as_csv(fit, tmp_path):
    found = fit.drive(T, REFERENCE)
    path = found.save(tmp_path / "drive.csv")
    assert path.read_text().startswith("time [s],u_x [V]\n")
    assert np.array_equal(np.loadtxt(path, delimiter=",", skiprows=1).T, [T, found.drive["x"]])


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        ((T, {"y": REFERENCE}), {}, "axis 'y' is not in the result"),
        ((pzt.Record(T, REFERENCE, drive="V"),), {}, "axis x is in V, not in um"),
        ((T, REFERENCE), {"limits": (5, 1)}, "5 to 1 are no limits"),
        ((T, REFERENCE), {"noise_gain": 0.5}, "0.5 is no noise gain"),
        ((T, REFERENCE), {"slew": -1.0}, "-1 is no slew rate"),
        ((T, np.where(T > 2, np.nan, REFERENCE)), {}, "reference"),
    ],
)
def test_what_makes_no_sense_is_refused(fit, arguments, options, message):
    with pytest.raises(pzt.InputError, match=message):
        fit.drive(*arguments, **options)


@pytest.mark.parametrize("header", ["time [s],x [um]", "time_s,displacement_um", "Zeit (s),x_um"])
def test_the_command_writes_the_same_drive(fit, tmp_path, header):
    """Headings are read as those of a measurement are in the workbench."""
    from click.testing import CliRunner

    from pzt_ident.cli.commands import main

    result, file, out = fit.save(tmp_path / "run"), tmp_path / "ramp.csv", tmp_path / "drive.csv"
    np.savetxt(file, np.transpose([T, REFERENCE]), "%.17g", ",", header=header, comments="")
    answer = CliRunner().invoke(main, ["drive", str(result), "--reference", str(file), "-o", str(out), "--json"])
    assert answer.exit_code == 0, answer.output
    assert json.loads(answer.stdout)["peak"]["x"] < 1e-9
    assert np.allclose(np.loadtxt(out, delimiter=",", skiprows=1)[:, 1], fit.drive(T, REFERENCE).drive["x"])


@pytest.mark.parametrize(
    ("header", "options", "message"),
    [
        ("time [s],x", (), "column 'x' has no unit"),
        ("time [s],x [V]", (), "axis x is in V"),
        ("time [s],y [um],z [um]", (), "has no column for axis x"),
        ("x [um],y [um]", (), "has no column of time"),
        ("time [s],x [um]", ("--current", "50"), "no quantity above zero"),
        ("time [s],x [um]", ("--current", "50mA"), "give --capacitance too"),
        ("time [s],x [um]", ("--limits", "5"), "is no range"),
    ],
)
def test_the_command_refuses_in_one_sentence(fit, tmp_path, header, options, message):
    from click.testing import CliRunner

    from pzt_ident.cli.commands import main

    result, file = fit.save(tmp_path / "run"), tmp_path / "ramp.csv"
    columns = header.count(",") + 1
    file.write_text(header + "\n" + "\n".join(",".join([f"{t}"] * columns) for t in T.tolist()))
    command = ["drive", str(result), "--reference", str(file), "-o", str(tmp_path / "drive.csv"), *options]
    answer = CliRunner().invoke(main, command)
    assert answer.exit_code == 2 and message in answer.output and "Traceback" not in answer.output


def test_an_improvement_and_an_exported_model_are_put_to_work_too(fit, commanded, tmp_path):
    (exported,) = fit.export(tmp_path / "json", to="json")
    again = pzt.load(exported)
    assert np.allclose(again.drive(T, REFERENCE).drive["x"], fit.drive(T, REFERENCE).drive["x"], rtol=1e-12)
    assert again.tune(200.0)["x"] == fit.tune(200.0)["x"]

    improved = pzt.load(commanded)
    assert [*read_identified(commanded, as_given=True).chain.names] == [*fit.identified.chain.names]
    assert improved.drive(T, REFERENCE).peak["x"] < 1e-3
    assert set(improved.parameters) > set(fit.parameters)
