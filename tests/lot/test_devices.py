"""Which files are whose, by folders, files and tables, and what is told where that cannot be."""

import os
from pathlib import Path

import pytest

from pzt_ident.errors import InputError
from pzt_ident.job.schema import Job
from pzt_ident.lot.devices import devices_of

ONE = """\
records:
  - {file: loops.csv, rows: [0, 10]}
  - {file: loops.csv, rows: [10, 20], use: validate}
channels: {time: "time [s]", axes: {x: {drive: "u [V]", response: "x [um]"}}}
model: [bouc_wen]
"""
TWO = ONE.replace("{file: loops.csv, rows: [10, 20], use: validate}", "{file: data/slow.csv, name: slow}")


def job(text: str, folder: Path) -> Job:
    return Job.from_text(text, folder)


def touch(*paths: Path) -> None:
    for path in paths:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("time [s],u [V],x [um]\n0,0,0\n")


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_folders_hold_the_files_of_the_records_by_path_or_name(here):
    touch(here / "lot/a/loops.csv", here / "lot/a/data/slow.csv", here / "lot/b/loops.csv", here / "lot/b/slow.csv")
    touch(here / "lot/c/loops.csv", here / "lot/readme.txt")
    a, b, c = devices_of(["lot/*/"], job(TWO, here))
    assert (a.name, a.files) == (
        "a",
        {"loops.csv": Path("lot/a/loops.csv"), "data/slow.csv": Path("lot/a/data/slow.csv")},
    )
    assert b.files["data/slow.csv"] == Path("lot/b/slow.csv")
    assert "holds no slow.csv: it holds loops.csv" in c.fault


def test_files_are_devices_where_the_job_has_one(here):
    touch(here / "lot/a.csv", here / "lot/b.csv")
    assert [(device.name, device.files) for device in devices_of(["lot/*.csv"], job(ONE, here))] == [
        ("a", {"loops.csv": Path("lot/a.csv")}),
        ("b", {"loops.csv": Path("lot/b.csv")}),
    ]


def test_names_have_as_many_parts_as_make_them_distinct(here):
    touch(here / "may/d1/loops.csv", here / "june/d1/loops.csv")
    assert [device.name for device in devices_of(["may/*/", "june/*/"], job(ONE, here))] == ["june-d1", "may-d1"]


def test_a_file_of_a_single_channel_is_the_jobs_own_where_a_device_has_none(here):
    text = ONE.replace('drive: "u [V]"', "drive: {file: drive.npy, dataset: u, unit: V}")
    touch(here / "lot/a/loops.csv", here / "lot/b/loops.csv", here / "lot/b/drive.npy")
    a, b = devices_of(["lot/*/"], job(text, here))
    assert (a.files["drive.npy"], b.files["drive.npy"]) == (here / "drive.npy", Path("lot/b/drive.npy"))


@pytest.mark.parametrize(
    ("text", "table"),
    [
        (ONE, "Device,file,temperature [K],batch\nd1,lot/a.csv,295,A\nd2,lot/b.csv,,B\n"),
        (ONE, "\ufeffdevice;loops;temperature [K];batch\nd1;lot/a.csv;295;A\n\nd2;lot/b.csv;;B\n"),
        (
            TWO,
            "device\tloops\tslow\ttemperature [K]\tbatch\nd1\tlot/a.csv\tlot/b.csv\t295\tA\n"
            "d2\tlot/b.csv\tlot/a.csv\t\tB\n",
        ),
    ],
)
def test_a_table_says_which_file_is_whose_and_what_else_is_known(here, text, table):
    touch(here / "sub/lot/a.csv", here / "sub/lot/b.csv")
    (here / "sub/lot.csv").write_text(table, encoding="utf-8")
    first, second = devices_of(["sub/lot.csv"], job(text, here))
    assert (first.name, first.columns) == ("d1", {"temperature [K]": 295.0, "batch": "A"})
    assert first.files["loops.csv"] == Path("sub/lot/a.csv")
    assert (second.name, second.columns) == ("d2", {"temperature [K]": None, "batch": "B"})


def test_a_row_without_its_file_is_a_device_with_a_fault(here):
    touch(here / "a.csv")
    (here / "lot.csv").write_text("file,serial\na.csv,1\nb.csv,2\n")
    a, b = devices_of(["lot.csv"], job(ONE, here))
    assert (a.name, a.fault, b.name, b.fault) == ("a", "", "b", "b.csv: no such file")


FAULTS = {
    "nothing": (lambda path: None, "no such file"),
    "folder": (lambda path: path.mkdir(), "is a folder, not a file"),
    "pipe": (os.mkfifo, "is no file but a pipe"),
    "dangling": (lambda path: path.symlink_to("gone"), "is a link that leads nowhere"),
    "loop": (lambda path: path.symlink_to(path.name), "is a link that leads nowhere"),
}


@pytest.mark.parametrize("text", [ONE, TWO])
@pytest.mark.parametrize(("make", "said"), FAULTS.values(), ids=FAULTS)
def test_what_is_no_file_is_the_fault_of_its_device_alone(here, text, make, said):
    touch(here / "lot/good/loops.csv", here / "lot/good/slow.csv", here / "lot/bad/slow.csv")
    make(here / "lot/bad/loops.csv")
    rows = ["device,loops,slow", "bad,lot/bad/loops.csv,a", "good,lot/good/loops.csv,lot/good/slow.csv"]
    (here / "lot.csv").write_text("\n".join(rows))
    for patterns in (["lot/*/"], ["lot.csv"]):
        bad, good = devices_of(patterns, job(text, here))
        assert (bad.name, good.name, good.fault) == ("bad", "good", "")
        assert said in bad.fault or (said == "no such file" and "holds no loops.csv: it holds slow.csv" in bad.fault)


@pytest.mark.parametrize("cell", ["gone", "lot\\a", "a\0b", "x" * 300, "lot/a/loops.csv", "lot/empty", "."])
@pytest.mark.parametrize("text", [ONE, TWO])
def test_a_row_that_leads_to_no_device_is_its_own_fault(here, text, cell):
    touch(here / "lot/a/loops.csv", here / "lot/b/loops.csv", here / "lot/b/slow.csv")
    (here / "lot/empty").mkdir()
    (here / "lot.csv").write_text(f"device,folder\nbad,{cell}\ngood,lot/b\n")
    bad, good = devices_of(["lot.csv"], job(text, here))
    assert (bad.name, good.fault) == ("bad", "")
    assert bad.fault or (text, cell) == (ONE, "lot/a/loops.csv")


@pytest.mark.parametrize("path", ["lot/bad", "lot/bad/loops.csv"])
def test_what_may_not_be_read_is_the_fault_of_its_device_alone(here, monkeypatch, path):
    touch(here / "lot/good/loops.csv", here / "lot/bad/loops.csv")
    denied, listdir = here / path, os.listdir

    def checked(act):
        def checked_act(name, *more, **options):
            if denied in Path(os.path.abspath(name)).parents or (act is listdir and Path(name).absolute() == denied):
                raise PermissionError(13, "Permission denied", str(name))
            return act(name, *more, **options)

        return checked_act

    monkeypatch.setattr(os, "access", lambda name, mode: Path(name).absolute() != denied)
    for name in ("listdir", "stat", "lstat"):
        monkeypatch.setattr(os, name, checked(getattr(os, name)))
    bad, good = devices_of(["lot/*/"], job(ONE, here))
    assert (bad.fault, good.fault) == (f"{path}: permission denied", "")


@pytest.mark.parametrize("other", ["Loops.CSV", "raw/loops.csv"])
def test_a_file_that_is_almost_there_is_named(here, other):
    touch(here / "lot/a/loops.csv", here / "lot/b" / other, *(here / f"lot/b/{letter}" for letter in "ABCDEFG"))
    assert f"it holds {other}, which must be there as loops.csv" in devices_of(["lot/*/"], job(ONE, here))[1].fault


def test_the_only_folder_among_files_is_a_device_with_a_fault(here):
    touch(here / "lot/odd.csv/x", *(here / f"lot/{letter}.csv" for letter in "abc"))
    (fault,) = [device.fault for device in devices_of(["lot/*.csv"], job(ONE, here)) if device.fault]
    assert fault == "lot/odd.csv: is a folder, the other devices are files"


@pytest.mark.parametrize(
    ("entries", "said", "remedy"),
    [
        (["a/x", "b/x", "c.csv", "d.csv"], "2 folders and 2 files are", "one that ends with *.csv the files"),
        (["a.csv/x", "b.csv/x", "c.csv", "d.csv"], "2 folders and 2 files are", "a column `file` the files"),
        (["a/x", "b.csv"], "1 folder and 1 file are", "a pattern that ends with / takes the folders alone"),
    ],
)
def test_where_folders_and_files_may_both_be_the_devices_nothing_is_guessed(here, entries, said, remedy):
    touch(*(here / "lot" / entry for entry in entries))
    with pytest.raises(InputError, match=said) as caught:
        devices_of(["lot/*"], job(ONE, here))
    assert remedy in caught.value.remedy


@pytest.mark.parametrize("patterns", [["lot/*/"], ["lot/*"], ["lot/latest", "lot/a"], ["lot/latest/", "lot/*"]])
def test_a_link_to_a_device_is_no_other(here, patterns):
    touch(here / "lot/a/loops.csv")
    (here / "lot/latest").symlink_to("a")
    (here / "lot/1").symlink_to(here / "lot/a")
    with pytest.warns(UserWarning, match="leads to lot/a: it is one device"):
        (device,) = devices_of(patterns, job(ONE, here))
    assert device.name == "a"


@pytest.mark.parametrize("patterns", [["lot/a/", "lot/*/"], ["lot/a", "lot/./a/", "lot/../lot/a"]])
def test_a_device_that_is_matched_twice_is_one(here, patterns):
    touch(here / "lot/a/loops.csv")
    (device,) = devices_of(patterns, job(ONE, here))
    assert device.name == "a"


@pytest.mark.parametrize("patterns", [["lot/*/"], ["lot/*"], ["lot/a", "lot/dangling", "lot/loop", "lot/twin"]])
def test_a_link_that_leads_nowhere_is_a_device_with_a_fault(here, patterns):
    touch(here / "lot/a/loops.csv")
    for name, target in ("dangling", "gone"), ("twin", "gone"), ("loop", "loop"):
        (here / "lot" / name).symlink_to(target)
    faults = {device.name: device.fault for device in devices_of(patterns, job(ONE, here))}
    assert list(faults) == ["a", "dangling", "loop", "twin"] and not faults.pop("a")
    assert all(fault == f"lot/{name}: is a link that leads nowhere" for name, fault in faults.items())


@pytest.mark.parametrize("name", ["e[1]", "e[12]x", "what?", "**", "[", "e[!a]"])
def test_a_path_is_taken_letter_by_letter_before_it_is_a_pattern(here, name):
    touch(here / "lot" / name / "loops.csv", here / "lot/e1/loops.csv")
    for pattern in (f"lot/{name}/", f"lot/{name}"):
        assert [device.name for device in devices_of([pattern], job(ONE, here))] == [name]


def test_a_path_that_is_gone_is_the_fault_of_its_device_alone(here):
    touch(here / "lot/a/loops.csv")
    a, b = devices_of(["lot/a/", "lot/b/"], job(ONE, here))
    assert (a.fault, b.name, b.fault) == ("", "b", "lot/b: no such file")


def test_the_results_of_a_fleet_are_no_device(here):
    touch(here / "lot/a/loops.csv", here / "lot/out/fleet.json", here / "lot/out/loops.csv")
    assert [device.name for device in devices_of(["lot/*/"], job(ONE, here))] == ["a"]
    with pytest.raises(InputError, match="no device"):
        devices_of(["lot/out"], job(ONE, here))


BAD_LETTERS = [b"\xff", b"\x1b[31m", b"\n", b"\xe2\x80\xae", b"\xc2\x9b2J"]


@pytest.mark.parametrize("letters", BAD_LETTERS)
def test_what_is_told_of_a_device_is_printable(here, letters):
    name = os.fsdecode(b"d" + letters)
    touch(here / "lot" / name / "loops.csv", here / "lot" / f"{name}2/tones.csv", here / "lot/good/loops.csv")
    devices = devices_of(["lot/*/"], job(ONE, here))
    assert [bool(device.fault) for device in devices] == [False, True, False]
    assert os.path.isfile(devices[0].files["loops.csv"])
    assert all(device.name.isprintable() and device.fault.isprintable() for device in devices)
    with pytest.raises(InputError) as caught:
        devices_of([f"lot/{name}2/"], job(ONE, here))
    assert str(caught.value).replace("\n  ", "").isprintable()


def test_the_cells_of_a_table_are_printable(here):
    touch(here / "a.csv")
    (here / "lot.csv").write_text('device,file,"se\x1brial"\n"a\nb",a.csv,\x1b[31mred 5\u00a0µm\n')
    (device,) = devices_of(["lot.csv"], job(ONE, here))
    assert (device.name, device.columns) == (r"a\nb", {r"se\x1brial": "\\x1b[31mred 5\u00a0µm"})


@pytest.mark.parametrize("heading", ["device", "Name"])
def test_a_device_whose_cell_is_empty_has_the_name_of_its_path(here, heading):
    touch(here / "a.csv", here / "b.csv", here / "c.csv")
    (here / "lot.csv").write_text(f"{heading},file\nfirst,a.csv\n,b.csv\n  ,c.csv\n")
    assert [device.name for device in devices_of(["lot.csv"], job(ONE, here))] == ["b", "c", "first"]


@pytest.mark.parametrize(
    ("text", "patterns", "table", "sentence"),
    [
        (ONE, ["lto/*/"], "", r"'lto/\*/': matches nothing\n  there is no lto"),
        (ONE, ["lot/x*/"], "", r"matches nothing\n  in lot there is a, b"),
        (ONE, ["lot/*"], "", "2 folders and 1 file are matched"),
        (ONE, ["lot/"], "", r"holds no loops.csv: it holds a, b, readme.txt\n  did you mean 'lot/\*/'"),
        (TWO, ["lot/a/loops.csv"], "", "the job has records in 2 files, loops.csv, data/slow.csv, the device is one"),
        (TWO.replace("data/slow.csv", "data/loops.csv"), ["lot/*/"], "", "are the same file lot/a/loops.csv"),
        (ONE, ["t.csv"], "file\n", "t.csv: lists no device"),
        (
            ONE,
            ["t.csv"],
            "device,file\nd,lot/a/loops.csv\nd,lot/b/loops.csv\n",
            r"The first, d \(t.csv:2\): the device 'd' is in t.csv:3, too",
        ),
        (
            ONE,
            ["t.csv"],
            "device,file\nc,lot/a/loops.csv\nd,lot/a/loops.csv\n",
            "t.csv:2: names the same data as t.csv:3",
        ),
        (ONE, ["t.csv"], "device,file\nd,\n", "t.csv:2: names no file"),
        (ONE, ["t.csv"], "device,file\nd,lot/a/loops.csv,7\n", "t.csv:2: has 3 cells, the header 2"),
        (ONE, ["t.csv"], "device,file\nd,no.csv\n", "no device can be identified. The first, d: no.csv: no such"),
    ],
)
def test_clumsy_use_is_told_with_a_remedy(here, text, patterns, table, sentence):
    touch(here / "lot/a/loops.csv", here / "lot/b/loops.csv", here / "lot/readme.txt")
    (here / "t.csv").write_text(table)
    with pytest.raises(InputError, match=sentence) as caught:
        devices_of(patterns, job(text, here))
    assert caught.value.remedy
