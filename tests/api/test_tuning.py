"""PI gains for a fit: what they are, what they say, and what is refused."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import pzt_ident as pzt
from pzt_ident.api.tuning import sliding, tune
from pzt_ident.cli.commands import main
from pzt_ident.control.loop import PI, closed_loop

KEPT = {"rate": 1000, "delay": 1}


@pytest.fixture(scope="module")
def damped(demo):
    """With a resonance at 3.4 kHz, damped by 1 %."""
    fixed = {"lumped.mass": 0.157, "lumped.damping": 66.0, "lumped.stiffness": 7e7}
    optimizer = {"name": "pso", "population": 40, "generations": 40}
    record = pzt.Record(*(column[:900] for column in demo[0]))
    return pzt.identify(pzt.Model("bouc_wen", "lumped"), record, fixed=fixed, optimizer=optimizer, seed=3)


def test_gains_have_the_units_of_the_data_and_keep_their_margins(damped):
    found = damped.tune(**KEPT)["x"]
    assert (found.kp_unit, found.ki_unit, found.slope_unit) == ("V/um", "V/(um s)", "um/V")
    assert found.gain_margin > 1.998 and found.phase_margin > 59.9 and found.radius < 1
    assert found.slope == pytest.approx(damped.parameters["bouc_wen.gain"].value, rel=0.05)
    assert found.damping == 66 and found.damping_needed == pytest.approx(
        0.157 * found.slope * found.ki / (1 + found.slope * found.kp)
    )


def test_stage_follows_under_the_gains(damped):
    """In nanometres and volts, and in the sampled loop."""
    found = damped.tune("1 kHz", 1)["x"]
    stage = damped.identified.stage(1e-3 / 20)
    reference = 1e-6 * np.minimum(np.arange(400) / 20, 1.0)[None]
    gains = PI(np.array([found.kp * 1e6]), np.array([found.ki * 1e6]))
    error = closed_loop(stage, reference, gains).error[0]
    assert np.abs(error).max() < 0.3e-6 and np.abs(error[100:]).max() < 1e-9


def test_tuning_prints_itself(damped):
    shown = str(damped.tune(**KEPT))
    assert shown.startswith("PI at 1000\u00a0Hz with 1 sample of computing delay")
    for part in ("V/µm", "V/(µm·s)", "largest slope", "in continuous time these gains would need a damping"):
        assert part in shown
    assert "<table>" in damped.tune(**KEPT)._repr_html_()


def test_friction_does_not_hide_the_gain_of_a_stage_that_slides(damped):
    rubbing = damped.add("friction.motion")
    values = rubbing.identified.theta.copy()
    values[rubbing.statement.problem.model.names.index("lumped.friction")] = 0.1e-6
    stuck = replace(rubbing.identified, theta=values)
    free = tune(sliding(stuck), **KEPT)["x"]
    assert tune(stuck, **KEPT)["x"] == free and free.damping is None


def test_less_margin_is_faster(damped):
    assert damped.tune(**KEPT, gain_margin=1.5, phase_margin=40)["x"].ki > damped.tune(**KEPT)["x"].ki


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"rate": "1 V"}, "'1 V' is no sample rate"),
        ({"rate": [1.0, 2.0]}, "rate: is no single number"),
        ({"delay": 0.5}, "0.5 is no delay"),
        ({"gain_margin": 0.5}, "gain_margin: 0.5 is no margin"),
        ({"phase_margin": 90}, "phase_margin: 90 is no margin"),
        ({"axis": "y"}, "axis 'y' is not in the result"),
        ({"delay": 0, "gain_margin": 1e6}, "axis x: no PI gains keep a gain margin of 1e\\+06"),
    ],
)
def test_what_makes_no_sense_is_refused(damped, arguments, message):
    with pytest.raises(pzt.InputError, match=message):
        damped.tune(**arguments)


def test_the_command_finds_the_same_gains(damped, tmp_path):
    result = damped.save(tmp_path / "run")
    answer = CliRunner().invoke(main, ["tune", str(result), "--rate", "1kHz", "--delay", "1", "--json"])
    assert answer.exit_code == 0, answer.output
    assert json.loads(answer.stdout) == damped.tune(**KEPT).facts
    assert "Ki" in CliRunner().invoke(main, ["tune", str(result), "--rate", "1kHz"]).output


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--rate", "1kHz", "--axis", "y"], "axis 'y' is not in the result"),
        (["--rate", "fast"], "'fast' is no sample rate"),
        (["--rate", "1kHz", "--delay", "-1"], "-1 is not in the range"),
        (["--rate", "1kHz", "--delay", "0", "--gain-margin", "1e6"], "no PI gains keep"),
    ],
)
def test_the_command_refuses_in_one_sentence(damped, tmp_path, options, message):
    answer = CliRunner().invoke(main, ["tune", str(damped.save(tmp_path / "run")), *options])
    assert answer.exit_code == 2 and message in answer.output and "Traceback" not in answer.output


def test_a_folder_without_a_result_is_refused(tmp_path):
    answer = CliRunner().invoke(main, ["tune", str(tmp_path), "--rate", "1kHz"])
    assert answer.exit_code == 2 and "holds no" in answer.output
