"""Which columns of a dropped file are time, drive and response."""

import numpy as np
import pytest

from pzt_ident.errors import InputError
from pzt_ident.job import Job
from pzt_ident.workbench.columns import columns_of
from pzt_ident.workbench.form import job_text, with_model

from .conftest import form

TIME = np.arange(60) / 100
DRIVE = 40 * np.sin(TIME * 9)
RESPONSE = 3 * np.sin(TIME * 9 - 0.2)


def roles(path):
    return [column["role"] for column in columns_of(path)["columns"]]


@pytest.mark.parametrize(
    ("header", "order", "expected"),
    [
        ("time [s],u_x [V],x [um]", "tur", ["time", "drive", "response"]),
        ("x [um],t [ms],voltage [V]", "rtu", ["response", "time", "drive"]),
        ("Displacement (nm),Command (V)", "ru", ["response", "drive"]),
        ("zeit,spannung,sensor", "tur", ["time", "drive", "response"]),
        (None, "tur", ["time", "drive", "response"]),
        (None, "ur", ["drive", "response"]),
        ("E [V/m],x [um]", "ur", ["drive", "response"]),
        ("displacement,amplifier", "ru", ["response", "drive"]),
    ],
)
def test_roles_by_unit_name_or_place(tmp_path, header, order, expected):
    columns = np.column_stack([{"t": TIME, "u": DRIVE, "r": RESPONSE}[letter] for letter in order])
    path = tmp_path / "data.csv"
    np.savetxt(path, columns, delimiter=",", header=header or "", comments="")
    assert roles(path) == expected


def test_a_constant_column_is_neither_drive_nor_response(tmp_path):
    path = tmp_path / "data.csv"
    still = np.full(60, 20.0)
    np.savetxt(path, np.column_stack([still, TIME, DRIVE, RESPONSE]), delimiter=",", header="T,time,u,x", comments="")
    assert roles(path) == ["", "time", "drive", "response"]


def test_matlab_vectors_are_columns(tmp_path):
    from scipy.io import savemat

    savemat(tmp_path / "data.mat", {"t": TIME, "u": DRIVE, "x": RESPONSE, "gain": 3.0, "note": "rig 2"})
    assert sorted(roles(tmp_path / "data.mat")) == ["drive", "response", "time"]


def test_a_file_without_signals_is_an_error(tmp_path):
    (tmp_path / "data.csv").write_text("nothing\nhere\n")
    with pytest.raises(InputError):
        columns_of(tmp_path / "data.csv")


def test_the_form_is_a_job_that_reads(tmp_path):
    job = Job.from_text(job_text(form(name="small", model=["bouc_wen", "lumped"])), tmp_path)
    assert (job.name, job.model, job.effects) == ("small", ("bouc_wen", "lumped"), ())
    assert job.channels.axes["x"].drive.name == "u_x [V]"


def test_a_form_without_headings_counts_columns(tmp_path):
    column = {"header": "", "number": 2, "unit": "V"}
    axes = {"x": {"drive": column, "response": {"header": "", "number": 5, "unit": "nm"}}}
    job = Job.from_text(job_text(form(time=None, sample_rate="200 Hz", axes=axes)), tmp_path)
    assert job.channels.axes["x"].response.column == 5
    assert job.records[0].sample_rate == 200


def test_another_model_keeps_the_comments(tmp_path):
    text = with_model(job_text(form()), ["bouc_wen", "lumped"])
    assert text.startswith("# Made in the workbench.")
    assert Job.from_text(text, tmp_path).model == ("bouc_wen", "lumped")
