"""Ways to follow a reference, beside each other."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import pzt_ident as pzt
from cut_texts import cut_texts
from pzt_ident.api.tracking import ALONE, INVERSE, LOOP, MEASURED, OPEN, Following, control
from pzt_ident.cli.commands import main
from pzt_ident.control.identified import Identified
from rig import model

T = np.arange(600) * 5e-3
REFERENCE = 3 * np.sin(np.pi * T / T[-1]) ** 2
COUPLED = {"bouc_wen.gain": 8e-8, "bouc_wen.alpha": 0.5, "bouc_wen.beta": 0.02, "bouc_wen.gamma": 0.01}


@pytest.fixture(scope="module")
def two_axes():
    chain = model("bouc_wen", "cross_coupling", axes=2)
    ratios = {"x.cross_coupling.ratio": -0.05, "y.cross_coupling.ratio": 0.03}
    theta = np.array([ratios.get(name, COUPLED.get(name.partition(".")[2], 0.0)) for name in chain.names])
    blank = ("1",) * len(theta), (None,) * len(theta)
    ends = np.array([[0.0, 100.0]] * 2)
    return Identified("xy", chain, theta, *blank, 1e-3, ends, ("V", "V"), ("um", "um"), (1.0, 1.0))


def test_each_way_is_better_than_the_one_before(two_axes):
    fine = np.linspace(0, T[-1], 7_000)
    reference = 3 * np.sin(np.pi * fine / fine[-1]) ** 2 * (1 + 0.3 * np.sin(9 * fine / fine[-1]))
    tracking = control(two_axes, fine, {"x": reference, "y": reference[::-1]}, kp=0.1, ki=10.0)
    assert [*tracking.ways] == [OPEN, ALONE, INVERSE, LOOP]
    for axis in "xy":
        open_, alone, inverse, _ = (way.rmse[axis] for way in tracking.ways.values())
        assert open_ > alone > 100 * inverse
    left = -0.05 * reference[::-1]
    assert np.abs(tracking.ways[ALONE].error["x"] - left).max() < 0.01 * np.abs(left).max()


def test_a_held_drive_is_late_by_half_a_sample_at_the_samples(two_axes):
    tracking = control(two_axes, T, {"x": REFERENCE, "y": REFERENCE}, kp=0.0, ki=0.0)
    late = -np.gradient(REFERENCE, T) * (T[1] - T[0]) / 2
    assert np.abs(tracking.ways[INVERSE].error["x"] - late).max() < 0.02 * np.abs(late).max()


def test_each_axis_has_the_count_of_its_own_unit(two_axes):
    in_nanometres = replace(two_axes, response_units=("um", "nm"))
    wanted = 1e-6 * np.array([REFERENCE, REFERENCE])
    follow = Following(in_nanometres, wanted, T[1] - T[0], 1, 0.1, None, None)
    reading = follow.by(np.zeros(wanted.shape)).reading + follow.by(wanted / 8e-8).reading
    counts = reading / np.array([[1e-7], [1e-10]])
    assert np.abs(counts - np.round(counts)).max() < 1e-6


def test_spectrum_holds_the_whole_error(fit):
    way = fit.control(T, REFERENCE).ways[OPEN]
    error = way.error["x"]
    assert np.isclose(np.sum(way.spectrum["x"] ** 2), np.var(error), rtol=1e-9)


def test_gains_are_those_of_tune_unless_given(fit):
    tracking, tuned = fit.control(T, REFERENCE), fit.tune(200.0, 1)
    assert tracking.gains["x"] == (tuned["x"].kp, tuned["x"].ki)
    assert fit.control(T, REFERENCE, kp=0.1, ki=5.0).gains["x"] == (0.1, 5.0)
    with pytest.raises(pzt.InputError, match="one gain without the other"):
        fit.control(T, REFERENCE, kp=0.1)


def test_a_record_of_the_stage_stands_beside(fit):
    late = pzt.Record(T, REFERENCE + 0.3 + 0.02 * np.sin(40 * T), drive="um")
    tracking = fit.control(T, REFERENCE, measured=late)
    assert tracking.ways[MEASURED].rmse["x"] == pytest.approx(0.02 / np.sqrt(2), rel=0.05)
    short = pzt.Record(T[:300], REFERENCE[:300], drive="um")
    with pytest.raises(pzt.InputError, match="shorter than the reference"):
        fit.control(T, REFERENCE, measured=short)


def test_the_command_writes_table_signals_and_figure(fit, tmp_path):
    result, file, out = fit.save(tmp_path / "run"), tmp_path / "ramp.csv", tmp_path / "out"
    np.savetxt(file, np.transpose([T, REFERENCE]), "%.17g", ",", header="time [s],x [um]", comments="")
    line = ["control", str(result), "--reference", str(file), "--out", str(out), "--record", str(file), "--json"]
    answer = CliRunner().invoke(main, line)
    assert answer.exit_code == 0, answer.output
    facts = json.loads((out / "control.json").read_text())
    assert [*facts["ways"]] == [OPEN, INVERSE, LOOP, MEASURED]
    assert facts["ways"][INVERSE]["rmse"]["x"] < 0.2 * facts["ways"][OPEN]["rmse"]["x"]
    assert json.loads(answer.stdout)["ways"] == facts["ways"]
    header = (out / "control.csv").read_text().split("\n")[0]
    assert '"x, open loop [um]"' in header and '"u_x, feedforward [V]"' in header
    assert (out / "tracking.svg").read_text().lstrip().startswith("<?xml")
    assert (out / "tracking.pdf").read_bytes().startswith(b"%PDF")


def test_figures_are_drawn(fit):
    for subject in (fit.control(T, REFERENCE), fit.drive(T, REFERENCE)):
        assert subject.plot()._repr_png_().startswith(b"\x89PNG")
        assert not cut_texts(subject.plot(88)) + cut_texts(subject.plot(180))
