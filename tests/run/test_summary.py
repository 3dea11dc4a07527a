"""What `check` tells of a job before anything is fitted."""

from pathlib import Path

import numpy as np
import pytest

import stage
from pzt_ident.job.schema import load_job
from pzt_ident.model.registry import blocks
from pzt_ident.run.summary import summary_of


def test_the_noise_floor_is_told_with_what_it_is_taken_from(tmp_path):
    axis = summary_of(load_job(stage.write(tmp_path, stage.records({}), stage.JOB)))["axes"][0]
    assert axis["noise_floor"] == pytest.approx(stage.NOISE / 1e-6, rel=0.2)
    assert axis["noise_floor_source"] == "rest segments"


def notes_of(folder: Path, model: str, parameters: str) -> list[str]:
    job = stage.JOB.replace("model: [bouc_wen]", f"model: {model}\nparameters: {parameters}")
    return summary_of(load_job(stage.write(folder, stage.records({}), job)))["notes"]


@pytest.mark.parametrize(
    ("bounds", "told"),
    [("[0.05, 0.1]", False), ("[5.0e-5, 1.0e-4]", True), ("[50, 100]", True), ("[0, 1000]", False), ("[-2, 2]", False)],
)
def test_a_gain_in_another_unit_is_asked_about(tmp_path, bounds, told):
    """Of a stage that moves by 0.08 um/V."""
    notes = notes_of(tmp_path, "[bouc_wen]", f"{{bouc_wen.gain: {{bounds: {bounds}}}}}")
    assert [note.endswith("are the units right?") for note in notes] == [True] * told


@pytest.mark.parametrize(
    ("setting", "told"),
    [("value: 156.6", True), ("value: 0.1566", False), ("bounds: [100, 200]", True), ("bounds: [5, 15]", False)],
)
def test_a_mass_in_another_unit_is_asked_about(tmp_path, setting, told):
    notes = notes_of(tmp_path, "[bouc_wen, lumped]", f"{{lumped.mass: {{{setting}}}, lumped.damping: {{value: 9}}}}")
    assert [note.startswith("lumped.mass is 1") for note in notes] == [True] * told


@pytest.mark.parametrize(("setting", "told"), [("bounds: [0.5, 2]", True), ("value: 1", False)])
def test_a_mass_that_is_free_beside_damping_and_stiffness_is_told(tmp_path, setting, told):
    notes = notes_of(tmp_path, "[bouc_wen, lumped]", f"{{lumped.mass: {{{setting}}}}}")
    sentence = "of lumped.mass, lumped.damping and lumped.stiffness the data hold two ratios, whatever the mass is"
    assert [note.startswith(sentence) for note in notes] == [True] * told


@pytest.mark.parametrize(("setting", "told"), [("bounds: [0.05, 0.1]", True), ("value: 0.08", False)])
def test_a_gain_that_is_free_beside_the_shapes_of_modes_is_told(tmp_path, setting, told):
    notes = notes_of(tmp_path, "[bouc_wen, modal]", f"{{bouc_wen.gain: {{{setting}}}}}")
    assert ["known only as products" in note for note in notes] == [True] * told


def test_a_noise_floor_that_is_taken_while_the_stage_moves_is_told(tmp_path):
    chirp = 60 - 60 * np.cos(np.arange(4000) ** 1.2 / 3000)
    records = stage.records({}, drives=[chirp, 0.8 * chirp])
    (note,) = summary_of(load_job(stage.write(tmp_path, records, stage.JOB)))["notes"]
    assert note.startswith("x: the noise floor is taken while the stage moves")


def notes_with(folder: Path, *changes: tuple[str, str], made: object = None) -> list[str]:
    job = stage.JOB
    for old, new in changes:
        assert old in job
        job = job.replace(old, new)
    return summary_of(load_job(stage.write(folder, made or stage.records({}), job)))["notes"]


def test_whose_parameters_an_axis_without_a_response_has_is_told(tmp_path):
    job = stage.JOB.replace('    x: {drive: "u_x [V]"', '    y: {drive: "u_x [V]"}\n    x: {drive: "u_x [V]"')
    notes = summary_of(load_job(stage.write(tmp_path, stage.records({}), job)))["notes"]
    (note,) = [note for note in notes if "has no response" in note]
    assert note.startswith("y has no response") and "its parameters are those of x" in note


def test_that_no_record_is_kept_back_is_told(tmp_path):
    assert notes_with(tmp_path) == []
    (note,) = notes_with(tmp_path, ("use: validate", "use: identify"))
    assert note.startswith("all records are fitted: keep one back")


@pytest.mark.parametrize(
    ("cut", "model", "told"),
    [
        ("rows: [300, 900]", "[bouc_wen]", True),
        ("time: [0.3, 0.9]", "[bouc_wen]", True),
        ("rows: [300, 900], run_in: 1", "[bouc_wen]", False),
        ("rows: [300, 900], rest_at: 0 V", "[bouc_wen]", False),
        ("rows: [300, 900]", "[history, bouc_wen]", False),
        ("rows: [100, 900]", "[bouc_wen]", False),
        ("rows: [0, 900]", "[bouc_wen]", False),
    ],
)
def test_a_record_that_is_cut_out_in_motion_is_told_unless_the_job_says_what_was_before(tmp_path, cut, model, told):
    """The drive rests for 0.2 s and moves then."""
    drive = 60 - 60 * np.cos(np.maximum(np.arange(1000) - 200, 0) / 60)
    made = stage.records({}, drives=[drive, drive], dt=1e-3)
    changes = ("identify.csv, use: identify", f"identify.csv, use: identify, {cut}"), ("[bouc_wen]", model)
    notes = notes_with(tmp_path, *changes, made=made)
    assert ["is cut out where the drive moves" in note for note in notes] == [True] * told


@pytest.mark.parametrize(
    ("phase", "cut", "told"),
    [
        (1.5, "", True),
        (0.0, "", False),
        (np.pi, "", False),
        (1.5, ", run_in: 1", False),
        (1.5, ", rest_at: 0 V", False),
    ],
)
def test_a_record_that_begins_in_the_middle_of_a_motion_is_told_unless_the_job_says_what_was_before(
    tmp_path, phase, cut, told
):
    drive = 60 - 60 * np.cos(phase + np.arange(1000) / 60)
    made = stage.records({}, drives=[drive, 60 - 60 * np.cos(np.arange(1000) / 60)], dt=1e-3)
    notes = notes_with(tmp_path, ("identify.csv, use: identify", f"identify.csv, use: identify{cut}"), made=made)
    assert any("identify is under way from the first sample on" in note for note in notes) == told


def test_what_a_diagnosis_cannot_name_is_told_with_the_reason(tmp_path):
    """A term that another block has, and a coupling of one axis; not what the job rules out."""
    job = stage.JOB + "rule_out: [kinematic_coupling]\n"
    told = summary_of(load_job(stage.write(tmp_path, stage.records({}), job)))
    assert told["out_of_place"] == {
        "no block of this model has a term for such an effect, and `pzt-ident show` tells which have": [
            "load_mass",
            "viscous_damping",
        ],
        "there is no second axis": ["cross_coupling"],
    }
    others = ["load_mass", "viscous_damping", "cross_coupling", "kinematic_coupling", *blocks.faults()]
    assert told["faults"] == blocks.faults()
    assert {*told["nameable"], *others} == {*blocks.effects()} and not {*told["nameable"]} & {*others}
