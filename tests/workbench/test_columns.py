"""Which columns of a dropped file are time, drive and response."""

from dataclasses import replace

import numpy as np
import pytest

from pzt_ident.data.readers.open import open_table
from pzt_ident.errors import InputError
from pzt_ident.job.schema import Job
from pzt_ident.run.statement import read
from pzt_ident.workbench import columns
from pzt_ident.workbench.columns import columns_of
from pzt_ident.workbench.job_form import job_text
from pzt_ident.workbench.measurement import measured
from sheets import write_sheets

from .conftest import form

TIME = np.arange(60) / 100
DRIVE = 40 * np.sin(TIME * 9)
RESPONSE = 3 * np.sin(TIME * 9 - 0.2)


def roles(path):
    return [column["role"] for column in columns_of((path, None))["columns"]]


@pytest.mark.parametrize(
    ("header", "order", "expected"),
    [
        ("time [s],u_x [V],x [um]", "tur", ["time", "x.drive", "x.response"]),
        ("x [um],t [ms],voltage [V]", "rtu", ["x.response", "time", "x.drive"]),
        ("Displacement (nm),Command (V)", "ru", ["x.response", "x.drive"]),
        ("zeit,spannung,sensor", "tur", ["time", "x.drive", "x.response"]),
        (None, "tur", ["time", "x.drive", "x.response"]),
        (None, "ur", ["x.drive", "x.response"]),
        ("E [V/m],x [um]", "ur", ["x.drive", "x.response"]),
        ("displacement,amplifier", "ru", ["x.response", "x.drive"]),
    ],
)
def test_roles_by_unit_name_or_place(tmp_path, header, order, expected):
    columns = np.column_stack([{"t": TIME, "u": DRIVE, "r": RESPONSE}[letter] for letter in order])
    path = tmp_path / "data.csv"
    np.savetxt(path, columns, delimiter=",", header=header or "", comments="")
    assert roles(path) == expected


@pytest.mark.parametrize(
    ("header", "expected"),
    [
        ("t_s,HV1 / V,HV2 / V,pos1 / um,pos2 / um", ["time", "x.drive", "y.drive", "x.response", "y.response"]),
        ("t [s],u_x [V],u_mon [V],x [um],T [K]", ["time", "x.drive", "", "x.response", ""]),
        ("t [s],U1 [V],U2 [V],x [um],target [um]", ["time", "x.drive", "", "x.response", ""]),
    ],
)
def test_another_axis_where_both_its_signals_are_called_alike(tmp_path, header, expected):
    columns = np.column_stack([TIME, DRIVE, 2 * DRIVE, RESPONSE, 3 * RESPONSE])
    np.savetxt(tmp_path / "data.csv", columns, delimiter=",", header=header, comments="")
    assert roles(tmp_path / "data.csv") == expected


def test_of_two_columns_without_a_name_the_smoother_is_the_drive(tmp_path):
    noisy = RESPONSE + np.random.default_rng(1).normal(0, 0.05, TIME.size)
    np.savetxt(tmp_path / "data.csv", np.column_stack([TIME, noisy, DRIVE]), delimiter=",")
    found = columns_of((tmp_path / "data.csv", None))["columns"]
    assert [column["role"] for column in found] == ["time", "x.response", "x.drive"]
    assert all(0 <= value <= 1 for column in found for value in column["shape"])


def test_a_unit_at_the_end_of_a_name(tmp_path):
    columns = np.column_stack([TIME, DRIVE, RESPONSE])
    np.savetxt(tmp_path / "data.csv", columns, delimiter=",", header="t_ms,gain_x,disp_nm", comments="")
    assert [column["unit"] for column in columns_of((tmp_path / "data.csv", None))["columns"]] == ["ms", None, "nm"]


def test_sheets_and_tables(tmp_path):
    rows = [["t [s]", "u [V]", "x [um]"], *np.column_stack([TIME, DRIVE, RESPONSE]).tolist()]
    write_sheets(tmp_path / "rig.xlsx", Sheet=[["Rig 3"]], Loops=rows, Check=rows)
    (found,) = columns_of((tmp_path / "rig.xlsx", None))["files"]
    assert (found["kind"], found["part"], list(found["parts"])) == ("sheet", "Loops", ["Sheet", "Loops", "Check"])
    assert columns_of((tmp_path / "rig.xlsx", "Check"))["files"][0]["part"] == "Check"
    with pytest.raises(InputError, match="no table of numbers"):
        columns_of((tmp_path / "rig.xlsx", "Sheet"))
    lines = "\n".join(f"{t},{u},{x}" for t, u, x in zip(TIME, DRIVE, RESPONSE, strict=True))
    tables = (f"Table {n}\nSampleName: run {n}\nt [s],u [V],x [um]\n{lines}\n\n" for n in (1, 2))
    (tmp_path / "rig.dat").write_text("".join(tables))
    (found,) = columns_of((tmp_path / "rig.dat", "2"))["files"]
    assert (found["kind"], found["parts"]) == ("table", {"1": "Table 1: run 1", "2": "Table 2: run 2"})
    records = [
        {"file": "rig.dat", "use": use, found["kind"]: part} for use, part in (("identify", "1"), ("validate", "2"))
    ]
    job = Job.from_text(job_text(form(records=records)), tmp_path)
    assert [(record.table, record.use) for record in job.records] == [("1", "identify"), ("2", "validate")]


def test_a_constant_column_is_neither_drive_nor_response(tmp_path):
    path = tmp_path / "data.csv"
    still = np.full(60, 20.0)
    np.savetxt(path, np.column_stack([still, TIME, DRIVE, RESPONSE]), delimiter=",", header="T,time,u,x", comments="")
    assert roles(path) == ["", "time", "x.drive", "x.response"]


def test_matlab_vectors_are_columns(tmp_path):
    from scipy.io import savemat

    savemat(tmp_path / "data.mat", {"t": TIME, "u": DRIVE, "x": RESPONSE, "gain": 3.0, "note": "rig 2"})
    assert sorted(roles(tmp_path / "data.mat")) == ["time", "x.drive", "x.response"]


def test_a_file_a_signal(tmp_path):
    paths = []
    for name, values in {"drive": DRIVE, "clock": TIME, "response": RESPONSE}.items():
        np.save(tmp_path / f"{name}.npy", values)
        paths.append(tmp_path / f"{name}.npy")
    assert [roles(path) for path in paths] == [["x.drive"], ["time"], ["x.response"]]
    found = columns_of(*((path, None) for path in paths))["columns"]
    assert [(column["of"], column["role"]) for column in found] == [(0, "x.drive"), (1, "time"), (2, "x.response")]
    np.save(tmp_path / "short.npy", RESPONSE[:50])
    with pytest.raises(InputError, match=r"differ in rows: drive\.npy 60, short\.npy 50"):
        columns_of((paths[0], None), (tmp_path / "short.npy", None))


def test_an_array_of_columns(tmp_path):
    np.save(tmp_path / "all.npy", np.column_stack([TIME, DRIVE, RESPONSE]))
    found = columns_of((tmp_path / "all.npy", None))["columns"]
    assert [(column["number"], column["role"]) for column in found] == [(1, "time"), (2, "x.drive"), (3, "x.response")]


def test_a_record_of_several_files_reads(tmp_path):
    for name, values in {"drive": DRIVE, "response": RESPONSE}.items():
        np.save(tmp_path / f"{name}.npy", values)
    channels = {role: {"file": f"{role[2:]}.npy", "number": 1} for role in ("x.drive", "x.response")}
    records = [{"file": "drive.npy", "use": "identify", "channels": channels}]
    axes = {"x": {"drive": {"unit": "V"}, "response": {"unit": "nm"}}}
    job = Job.from_text(job_text(form(records=records, time=None, sample_rate="100Hz", axes=axes)), tmp_path)
    (record,) = read(job)
    assert np.allclose(record.response, 1e-9 * RESPONSE) and np.allclose(record.drive, DRIVE)


@pytest.mark.parametrize("more", [{}, {"time": None, "sample_rate": "100 Hz"}])
def test_the_last_third_of_a_record_alone_is_kept_back(tmp_path, more):
    header = "time [s],u_x [V],x [um]"
    np.savetxt(
        tmp_path / "data.csv", np.column_stack([TIME, DRIVE, RESPONSE]), delimiter=",", header=header, comments=""
    )
    records = [{"file": "data.csv", "use": "split", "rows": 60, "span": TIME[-1]}]
    fitted, kept = read(Job.from_text(job_text(form(records=records) | more), tmp_path))
    assert (fitted.use, fitted.samples, fitted.settle) == ("identify", 40, 0)
    assert (kept.use, kept.samples, kept.settle, kept.notes) == ("validate", 60, 40, ())


def test_a_column_is_read_once_for_its_facts_and_its_values(tmp_path, monkeypatch):
    loads = []

    def opened(path, source):
        table = open_table(path, source)
        counted = [replace(c, load=lambda c=c: loads.append(c.name) or c.load()) for c in table.columns]
        return replace(table, columns=counted)

    monkeypatch.setattr(columns, "open_table", opened)
    rows = np.column_stack([TIME, DRIVE, RESPONSE])
    np.savetxt(tmp_path / "data.csv", rows, delimiter=",", header="t,u,x", comments="")
    columns_of((tmp_path / "data.csv", None))
    measured([[(tmp_path / "data.csv", None)]])
    assert sorted(loads) == ["t", "u", "x"]


def test_a_file_without_signals_is_an_error(tmp_path):
    (tmp_path / "data.csv").write_text("nothing\nhere\n")
    with pytest.raises(InputError):
        columns_of((tmp_path / "data.csv", None))


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
