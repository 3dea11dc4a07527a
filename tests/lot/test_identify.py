"""A job on a lot: broken devices are named and the others are as if identified alone; killed, gone on with, again."""

import json
import os
import platform
import shutil
import signal
import subprocess
import sys
import time
from html import unescape
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from experiments.fleet.lot import BROKEN, write_lot
from experiments.trust.essence import differences, essence
from lot.conftest import DEVICES
from pzt_ident.errors import InputError, LostError
from pzt_ident.files import read_sealed, write_sealed
from pzt_ident.job.schema import load_job
from pzt_ident.lot import identification
from pzt_ident.lot.identify import fleet, resume
from pzt_ident.lot.outcome import read_lot
from pzt_ident.lot.report import page
from pzt_ident.model.registry import blocks
from pzt_ident.run.alone import LOCK
from pzt_ident.run.identify import run
from pzt_ident.run.place import Local, place_of

DAMAGES = {
    "emptied": lambda path: path.write_bytes(b""),
    "garbled": lambda path: path.write_bytes(path.read_bytes()[:-9] + b"x" + path.read_bytes()[-8:]),
}
CLOCK = ["cpu [s]"]
SAID = {
    "empty": "the file is empty",
    "short": "the record has 2 samples",
    "text": "row 149 (line 151) holds 'ERROR' instead of a number",
    "gap": "1 value is missing: row 149 (line 151)",
    "missing": "holds no loops.csv: it holds tones.csv",
    "constant": "the response is constant",
    "not text": "is not a text file",
}


def table(out: Path) -> pd.DataFrame:
    return pd.read_csv(out / "devices.csv").drop(columns=CLOCK)


def kinds(lot: Path) -> dict[str, str]:
    return {name: facts["kind"] for name, facts in json.loads((lot / "truth.json").read_text()).items()}


def test_a_broken_device_is_named_with_the_reason_and_the_others_finish(lot, identified):
    out, events = identified
    frame = table(out).set_index("device")
    assert set(kinds(lot).values()) >= set(BROKEN)
    for name, kind in kinds(lot).items():
        row = frame.loc[name]
        assert row["state"] == ("broken" if kind in BROKEN else "done")
        if kind in BROKEN:
            assert SAID[kind] in row["reason"]
            assert f"lot/{name}" in row["reason"]
            assert not any(word in row["reason"] for word in ("Error:", "/tmp/pzt-ident-", "\n"))
    last = events[-1]
    assert (last["of"], last["done"], last["broken"]) == (DEVICES, DEVICES - len(BROKEN), len(BROKEN))


def test_the_table_has_what_is_known_and_what_was_found(lot, identified):
    frame = table(identified[0])
    first = frame[frame.state == "done"].iloc[0]
    assert first["bouc_wen.gain low [um/V]"] < first["bouc_wen.gain [um/V]"] < first["bouc_wen.gain high [um/V]"]
    assert first["identify RMSE [um]"] == pytest.approx(0.01, rel=0.5)
    assert first["noise floor [um]"] > 0
    assert len(first["sha256"]) == 64
    assert (identified[0] / first["folder"] / "result.json").is_file()
    broken = frame[frame.state == "broken"].set_index("device")
    has_hash = {kinds(lot)[name]: isinstance(value, str) for name, value in broken["sha256"].items()}
    assert has_hash == dict.fromkeys(BROKEN, True) | {"missing": False}
    assert frame["sha256"].nunique() == DEVICES - 1
    parquet = pd.read_parquet(identified[0] / "devices.parquet")
    assert list(parquet.columns) == list(pd.read_csv(identified[0] / "devices.csv").columns)
    assert set(frame.columns) >= {"serial", "temperature [K]", "date", "batch"}
    assert parquet["temperature [K]"].tolist() == pd.read_csv(lot / "lot.csv")["temperature [K]"].tolist()


def test_the_hash_is_that_of_all_files_of_a_device(lot, identified, tmp_path):
    copy, out = copied(lot, identified, tmp_path)
    before = table(out).set_index("device")["sha256"]
    broken = next(name for name, kind in kinds(lot).items() if kind == "gap")
    whole = next(name for name, kind in kinds(lot).items() if kind not in BROKEN)
    for name in (broken, whole):
        with (copy / "lot" / name / "tones.csv").open("a") as file:
            file.write("\n")
    resume(out, place=Local(1))
    after = table(out).set_index("device")["sha256"]
    assert set(after.index[after.ne(before) & after.notna()]) == {broken, whole}


def test_a_table_keeps_types_for_whoever_reads_parquet(identified):
    parquet = pytest.importorskip("pyarrow.parquet")
    types = {field.name: str(field.type) for field in parquet.read_schema(identified[0] / "devices.parquet")}
    assert types["temperature [K]"] == types["bouc_wen.gain low [um/V]"] == "double"
    assert types["device"].endswith("string") and types["verdict"].endswith("string")


def test_without_pyarrow_the_table_is_csv_and_how_to_get_the_other_is_said_once(lot, identified, tmp_path, monkeypatch):
    _, out = copied(lot, identified, tmp_path)
    monkeypatch.setattr("pzt_ident.lot.table.find_spec", lambda name: None)
    events = []
    resume(out, place=Local(1), listen=events.append)
    (said,) = [event["said"] for event in events if event["event"] == "table"]
    assert said.endswith("pip install 'pzt-ident[parquet]'")
    assert not (out / "devices.parquet").exists()
    text = page(read_lot(out), {})
    assert (
        "devices.parquet" not in text
        and said.rpartition(" that needs ")[2] in unescape(text)
        and 'href="devices.csv"' in text
    )


def test_a_device_is_as_if_identified_alone(identified, tmp_path):
    """The job in its folder leads to its data, too."""
    out = identified[0]
    row = next(row for row in read_lot(out).rows if row["state"] == "done")
    home = out / "devices" / row["device"]
    alone = json.loads((run(load_job(home / "job.yaml"), tmp_path / "alone") / "result.json").read_text())
    in_lot = json.loads((home / "result.json").read_text())
    assert alone["best"]["parameters"] == in_lot["best"]["parameters"]
    assert [record["rmse"] for record in alone["records"]] == [record["rmse"] for record in in_lot["records"]]
    assert not list(out.rglob("*.losses")) and not list(out.rglob("*.tmp"))


def copied(lot: Path, identified, tmp_path: Path) -> tuple[Path, Path]:
    """The lot and its fleet, as they would be there."""
    copy, out = shutil.copytree(lot, tmp_path / "lot"), shutil.copytree(identified[0], tmp_path / "out")
    write_sealed(out / "fleet.json", read_sealed(out / "fleet.json") | {"patterns": [str(copy / "lot.csv")]})
    return copy, out


def done_again(out: Path, act) -> set[str]:
    """The devices whose results were written anew."""
    before = {path: path.stat().st_mtime_ns for path in out.glob("devices/*/result.json")}
    act()
    return {p.parent.name for p in out.glob("devices/*/result.json") if before.get(p) != p.stat().st_mtime_ns}


def test_what_was_done_is_not_done_again_unless_data_or_job_changed(lot, identified, tmp_path):
    copy, out = copied(lot, identified, tmp_path)
    done = [name for name, kind in kinds(lot).items() if kind not in BROKEN]
    before = table(out).drop(columns="reason")  # which names the files
    assert done_again(out, lambda: resume(out, place=Local(1))) == set()
    pd.testing.assert_frame_equal(table(out).drop(columns="reason"), before)
    data = copy / "lot" / done[0] / "tones.csv"
    data.write_text(data.read_text().replace("\n0.00100,", "\n0.001001,"))
    mended = next(name for name, kind in kinds(lot).items() if kind == "missing")
    shutil.copy(copy / "lot" / done[1] / "loops.csv", copy / "lot" / mended)
    damaged = out / "devices" / done[2] / "device.json"
    damaged.write_text(damaged.read_text()[:100])
    assert done_again(out, lambda: resume(out, place=Local(1))) == {done[0], mended, done[2]}
    (copy / "job.yaml").write_text((copy / "job.yaml").read_text().replace("seed: 1", "seed: 2"))
    job = load_job(copy / "job.yaml")
    again = done_again(out, lambda: fleet(job, [str(copy / "lot.csv")], out, place=Local(1)))
    assert again == {*done, mended}


def test_what_was_identified_is_kept_where_the_data_are_gone_and_that_is_said(lot, identified, tmp_path):
    copy, out = copied(lot, identified, tmp_path)
    done, events = [row["device"] for row in read_lot(out).done], []
    before = essence(out / "devices" / done[0])
    shutil.rmtree(copy / "lot" / done[0])
    assert done_again(out, lambda: resume(out, place=Local(1), listen=events.append)) == set()
    assert differences(before, essence(out / "devices" / done[0])) == []
    said = {event["event"]: event["said"] for event in events if "said" in event}
    reason = table(out).set_index("device")["reason"][done[0]]
    assert said["stale"] == f"{done[0]}: {reason}" == f"{done[0]}: {read_lot(out).done[0]['reason']}"
    assert said["stale"].startswith(f"{done[0]}: ") and said["stale"].endswith("what was identified before is kept")
    assert said["kept"] == f"{len(done)} of 16 devices were done before and are as they were"


def test_another_job_is_said_and_improvements_are_not_given_up_for_one_without(lot, identified, tmp_path):
    copy, out = copied(lot, identified, tmp_path)
    stated, events = read_sealed(out / "fleet.json"), []
    write_sealed(out / "fleet.json", stated | {"job_hash": "another"})
    resume(out, place=Local(1), listen=events.append)
    assert [event["said"] for event in events if event["event"] == "other"] == [
        f"this is not what was asked before in {out}: every device is done again"
    ]
    done = next(row["device"] for row in read_lot(out).done)
    (out / "devices" / done / "improved").mkdir()
    write_sealed(out / "fleet.json", stated | {"improve": True})
    with pytest.raises(InputError, match="give --improve, or another folder"):
        fleet(load_job(copy / "job.yaml"), [str(copy / "lot.csv")], out, place=Local(1))


FILES = ("device.json", "result.json", "signals.nc", "history.csv", "job.yaml")
"""Of a device."""


@pytest.mark.parametrize("damage", ["emptied", "garbled", "gone"])
def test_a_damaged_device_is_identified_again_and_that_is_said(lot, identified, tmp_path, damage):
    out, events = shutil.copytree(identified[0], tmp_path / "out"), []
    done = [row["device"] for row in read_lot(out).done]
    hurt = {out / "devices" / name / file: name for name, file in zip(done, FILES, strict=False)}
    for path in hurt:
        DAMAGES.get(damage, lambda path: path.unlink())(path)
    again = done_again(out, lambda: resume(out, place=Local(1), listen=events.append))
    assert again == set(hurt.values())
    said = [event["said"] for event in events if event["event"] == "damaged"]
    assert [sentence.partition(" is damaged: it ")[0] for sentence in said] == [str(path) for path in hurt]
    assert all(sentence.endswith("; the device is identified again") for sentence in said)
    assert differences(essence(identified[0]), essence(out)) == []
    assert done_again(out, lambda: resume(out, place=Local(1))) == set()


def test_a_device_that_is_gone_is_left_out_and_that_is_said(lot, identified, tmp_path):
    copy, out = copied(lot, identified, tmp_path)
    events, stated = [], read_sealed(out / "fleet.json")
    write_sealed(out / "fleet.json", stated | {"patterns": [f"{copy}/lot/*/"]})
    names = [row["device"] for row in read_lot(out).rows]
    for name in names[:2]:
        shutil.rmtree(copy / "lot" / name)
    resume(out, place=Local(1), listen=events.append)
    (said,) = [event["said"] for event in events if event["event"] == "gone"]
    assert said.startswith(f"{names[0]}, {names[1]} are no devices any more") and str(out / "devices") in said
    assert sorted(table(out)["device"]) == names[2:]


@pytest.mark.parametrize(("again", "fresh"), [(0.0, True), (np.inf, False)])
def test_the_table_keeps_up_with_the_devices_in_case_of_a_kill_that_nothing_can_be_done_after(
    lot, tmp_path, monkeypatch, again, fresh
):
    """again: seconds after which it is due."""
    monkeypatch.setattr(identification, "AGAIN", again)
    monkeypatch.setattr(identification, "SHARE", np.inf)
    out, found = tmp_path / "out", []

    def listen(event):
        if event["event"] == "devices" and "device" in event:
            written = (
                pd.read_csv(out / "devices.csv") if (out / "devices.csv").exists() else pd.DataFrame({"state": []})
            )
            found.append((written["state"] != "not done").sum() == event["done"] + event["broken"])

    few = pd.read_csv(lot / "lot.csv")[:4]
    few.assign(folder=[lot / folder for folder in few.folder]).to_csv(tmp_path / "few.csv", index=False)
    fleet(load_job(lot / "job.yaml"), [str(tmp_path / "few.csv")], out, listen=listen)
    assert len(found) == len(few) and all(item == fresh for item in found)
    assert set(table(out)["state"]) <= {"done", "broken"}


def test_a_fleet_killed_hard_goes_on_to_the_same_results_bit_for_bit(lot, identified, tmp_path):
    out = tmp_path / "out"
    command = ["fleet", str(lot / "job.yaml"), str(lot / "lot.csv"), "--out", str(out), "--on", "local:1", "--quiet"]
    process = subprocess.Popen([sys.executable, "-m", "pzt_ident", *command], start_new_session=True)
    while len(list(out.glob("devices/*/device.json"))) < 4:
        assert process.poll() is None
        time.sleep(0.005)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    assert f"process {process.pid} on" in (out / LOCK).read_text()
    resume(out, place=Local(2))
    assert differences(essence(identified[0]), essence(out)) == []
    assert not list(out.rglob(".new"))


def test_the_same_results_bit_for_bit_on_a_cluster_of_which_a_worker_or_the_scheduler_is_lost(
    lot, identified, tmp_path
):
    pytest.importorskip("distributed")
    from experiments.fleet.cluster import TCP

    cluster = TCP(workers=2)

    def on_cluster(out, lost, after):
        def listen(event):
            if event["event"] == "devices" and event["done"] == after:
                lost.kill()

        fleet(job, [str(lot / "lot.csv")], out, place=place_of(cluster.address), listen=listen)

    job, whole, broken_off = load_job(lot / "job.yaml"), tmp_path / "out", tmp_path / "lost"
    try:
        on_cluster(whole, cluster.workers[0], 2)
        with pytest.raises(LostError, match="scheduler"):
            on_cluster(broken_off, cluster.scheduler, 3)
    finally:
        cluster.end()
    assert differences(essence(identified[0]), essence(whole)) == []
    states = pd.read_csv(broken_off / "devices.csv").set_index("device")["state"]
    assert 3 <= list(states).count("done") < DEVICES - len(BROKEN)
    resume(broken_off, place=Local(1))
    assert differences(essence(identified[0]), essence(broken_off)) == []


def test_a_second_fleet_in_one_folder_is_refused_while_the_first_is_at_work(lot, tmp_path):
    command = [sys.executable, "-m", "pzt_ident", "fleet", str(lot / "job.yaml"), str(lot / "lot.csv"), "--quiet"]
    refused = []

    def listen(event):
        if event["event"] == "devices" and event["done"] == 1 and not refused:
            refused.append(subprocess.run([*command, "--out", str(out)], capture_output=True, text=True))
            with pytest.raises(InputError) as second:
                resume(out)
            refused.append(second)

    job, out = load_job(lot / "job.yaml"), tmp_path / "out"
    fleet(job, [str(lot / "lot.csv")], out, place=Local(1), listen=listen)
    said = f"{out}: process {os.getpid()} on {platform.node()} is at work in this folder\n  wait until"
    assert refused[0].returncode == 2 and refused[0].stderr.startswith(f"Error: {said}")
    assert str(refused[1].value).startswith(said)
    assert list(table(out)["state"]).count("done") == DEVICES - len(BROKEN)


def test_names_that_no_file_system_takes(lot, tmp_path):
    words = ["a/b c", "..", "é" * 200, "<b>&\"'"]
    source = next(name for name, kind in kinds(lot).items() if kind == "plain")
    rows = []
    for place, _ in enumerate(words):
        home = shutil.copytree(lot / "lot" / source, tmp_path / f"{place}")
        with (home / "tones.csv").open("a") as file:
            file.write("\n" * (place + 1))
        rows.append(f"{place}")
    quoted = ['"' + word.replace('"', '""') + '"' for word in words]
    lines = [f"{word},{row}" for word, row in zip(quoted, rows, strict=True)]
    (tmp_path / "lot.csv").write_text("\n".join(["device,folder", *lines]))
    out = fleet(load_job(lot / "job.yaml"), [str(tmp_path / "lot.csv")], tmp_path / "out", place=Local(1))
    frame = table(out)
    assert sorted(frame.device) == sorted(words)
    assert set(frame.state) == {"done"}
    assert all((out / folder / "result.json").is_file() for folder in frame.folder)
    assert {path.name for path in tmp_path.iterdir()} == {"0", "1", "2", "3", "lot.csv", "out"}


def test_a_broken_device_of_any_name_is_in_the_table(lot, tmp_path):
    source = next(name for name, kind in kinds(lot).items() if kind == "plain")
    shutil.copytree(lot / "lot" / source, tmp_path / "lot/good")
    for letters in (b"\xff", b"\x1b[31m"):
        broken = tmp_path / "lot" / os.fsdecode(letters)
        shutil.copytree(lot / "lot" / source, broken)
        (broken / "loops.csv").write_text("")
    out = fleet(load_job(lot / "job.yaml"), [f"{tmp_path}/lot/*/"], tmp_path / "out", place=Local(1))
    frame = table(out).set_index("device")
    assert dict(frame.state) == {"good": "done", r"\udcff": "broken", r"\x1b[31m": "broken"}
    assert all("lot/" in reason and reason.isprintable() for reason in frame.reason.drop("good"))


def test_the_same_bytes_under_another_name_are_told(lot, tmp_path):
    plain = [name for name, kind in kinds(lot).items() if kind == "plain"]
    for name, source in ("a", plain[0]), ("b", plain[1]), ("copy", plain[0]):
        shutil.copytree(lot / "lot" / source, tmp_path / "lot" / name)
    events = []
    job, out = load_job(lot / "job.yaml"), tmp_path / "out"
    fleet(job, [f"{tmp_path}/lot/*/"], out, place=Local(1), listen=events.append)
    said = [event["said"] for event in events if event["event"] == "alike"]
    assert said == ["copy has the same data as a: is one of them a copy?"]
    found = read_lot(out)
    assert found.summary()["same_data"] == [["a", "copy"]]
    assert "a and copy have the same data: is one of them a copy?" in page(found, {})


def test_a_fault_that_the_model_finds_in_the_data_names_the_file_as_given(lot, tmp_path, monkeypatch):
    source = next(name for name, kind in kinds(lot).items() if kind == "plain")
    for name in ("good", "still"):
        shutil.copytree(lot / "lot" / source, tmp_path / "lot" / name)
    for path in (tmp_path / "lot/still").glob("*.csv"):
        lines = path.read_text().splitlines()
        cells = [line.split(",") for line in lines[1:]]
        path.write_text("\n".join([lines[0], *(",".join([row[0], "1", *row[2:]]) for row in cells)]))
    monkeypatch.chdir(tmp_path)
    job = (lot / "job.yaml").read_text()
    Path("job.yaml").write_text(job.replace("  bouc_wen.gain: {bounds: [0.05, 0.2]}\n", ""))
    out = fleet(load_job(Path("job.yaml")), ["lot/*/"], Path("out"), place=Local(1))
    reason = table(out).set_index("device")["reason"]["still"]
    assert "lot/still/loops.csv: the drive of axis x is constant" in reason and "../" not in reason


def test_a_folder_with_something_else_is_not_written_into(lot, tmp_path):
    (tmp_path / "mine.txt").touch()
    with pytest.raises(InputError, match="not empty"):
        fleet(load_job(lot / "job.yaml"), [str(lot / "lot.csv")], tmp_path)
    with pytest.raises(InputError, match="holds no fleet"):
        resume(tmp_path)


def test_each_device_is_diagnosed_where_that_is_asked(tmp_path):
    """One device with a quadratic gain, one without; every path that is left leads to the data."""
    write_lot(tmp_path, 2, 3, hidden=0.5, samples=600, swarm=(20, 40))
    job = (tmp_path / "job.yaml").read_text().replace("model: [bouc_wen, lumped]", "model: [bouc_wen, lumped]\n")
    keep = "creep, quadratic_gain"
    rule_out = [word for word in blocks.effects() if word not in keep]
    (tmp_path / "job.yaml").write_text(f"{job}rule_out: [{', '.join(rule_out)}]\n")
    out = fleet(
        load_job(tmp_path / "job.yaml"), [str(tmp_path / "lot.csv")], tmp_path / "out", improve=True, place=Local(2)
    )
    frame = table(out).set_index("device")
    for name, kind in kinds(tmp_path).items():
        row = frame.loc[name]
        assert (row["effects"] if isinstance(row["effects"], str) else "") == kind.replace("plain", "")
        improved = load_job(out / row["folder"] / "improved" / "improved.yaml")
        assert all((improved.folder / source.file).is_file() for source in improved.records)
        assert row["improved identify RMSE [um]"] <= row["identify RMSE [um]"] * 1.01
        steps = read_sealed(out / row["folder"] / "improved" / "improvement.json")["steps"]
        for parameter, found in steps[-1]["parameters"].items():
            at = f"improved {parameter}{{}} [{found['unit']}]"
            ends, middle = [row[at.format(" low")], row[at.format(" high")]], row[at.format("")]
            if found["interval"] is None:
                assert pd.isna(ends).all()
            else:
                assert ends == pytest.approx(found["interval"], rel=1e-9, abs=1e-12)
            assert row[f"improved {parameter} verdict"] == found["verdict"]
            assert middle == pytest.approx(found["value"], rel=1e-9)
        known = {heading.split(" [")[0] for heading in row.dropna().index if heading.startswith("improved ")}
        assert {f"improved {parameter}" for parameter in steps[-1]["parameters"]} <= known
        assert any(heading.startswith("improved quadratic_gain.") for heading in known) == (kind == "quadratic_gain")
