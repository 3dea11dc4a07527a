"""A folder of results of which a file is truncated or garbled: resume does it again, report and compare leave it out or
say in a sentence why they cannot be made."""

import json
import shutil

import numpy as np
import pytest
from click.testing import CliRunner

import measured
from pzt_ident.cli.commands import main
from pzt_ident.job.schema import load_job
from pzt_ident.run.identify import run
from pzt_ident.run.place import Local

JOB = """\
name: small
records: [{file: identify.csv}]
channels: {time: "time [s]", axes: {x: {drive: "u_x [V]", response: "x [um]"}}}
model: [bouc_wen]
optimizers: [{name: pso, population: 8, generations: 6}]
repeats: 2
seed: 3
"""
FILES = [
    "result.json",
    "history.csv",
    "signals.nc",
    "residuals.json",
    "environment.json",
    "runs/pso-1.json",
    "runs/pso-1.losses",
    "job.yaml",
]
FOR_GOOD = ("environment.json", "job.yaml")
"""What says what the run began with."""
RNG = np.random.default_rng(0)


def other_bytes(raw: bytes) -> bytes:
    places = RNG.integers(0, len(raw), 5)
    garbled = bytearray(raw)
    for place in places:
        garbled[place] ^= int(RNG.integers(1, 255))
    return bytes(garbled)


def another_word(raw: bytes) -> bytes:
    """Another first letter of a word in the middle."""
    place = next(i for i in range(len(raw) // 2, len(raw)) if bytes([raw[i]]).isalpha() and raw[i : i + 1] != b"Q")
    return raw[:place] + b"Q" + raw[place + 1 :]


DAMAGES = {
    "emptied": lambda raw: b"",
    "cut in half": lambda raw: raw[: len(raw) // 2],
    "cut at the end": lambda raw: raw[:-3],
    "garbled": other_bytes,
    "another word": another_word,
    "a list": lambda raw: b"[1, 2]",
    "an object": lambda raw: b"{}",
    "zeros": lambda raw: bytes(len(raw)),
}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("job")
    t = np.arange(300) / 300
    u = 50 * (1 - np.cos(6 * np.pi * t))
    x = 0.08 * u + np.random.default_rng(0).normal(0, 0.01, u.size)
    measured.write(folder / "identify.csv", t, u, x)
    (folder / "job.yaml").write_text(JOB)
    return run(load_job(folder / "job.yaml"), folder / "out", place=Local(1))


def call(*words):
    ended = CliRunner().invoke(main, [str(word) for word in words])
    assert ended.exit_code in (0, 2), ended.output
    for name in ("Error:", "Traceback"):
        text = ended.stderr.removeprefix("Error: ") if ended.exit_code else ended.output
        assert name not in text, text
    return ended


def numbers(out):
    result = json.loads((out / "result.json").read_text())
    clock = ("seconds", "cpu_seconds", "polish_seconds")
    return [{key: value for key, value in row.items() if key not in clock} for row in result["runs"]]


def hurt(whole, tmp_path, file, damage):
    out = shutil.copytree(whole, tmp_path / "out")
    raw = (out / file).read_bytes()
    (out / file).write_bytes(DAMAGES[damage](raw))
    return out, (out / file).read_bytes() != raw


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("file", FILES)
def test_resume_does_again_what_is_damaged_and_says_so(whole, tmp_path, file, damage):
    out, changed = hurt(whole, tmp_path, file, damage)
    ended = call("resume", out, "--workers", "1", "--no-report")
    if file in FOR_GOOD:
        assert ended.exit_code == 2 or numbers(out) == numbers(whole)
        return
    assert changed and ended.exit_code == 0
    assert "damaged" in ended.stderr and file in ended.stderr
    assert numbers(out) == numbers(whole)
    assert "every run is finished" in call("resume", out, "--no-report").stderr


@pytest.mark.parametrize("damage", ["cut in half", "garbled", "an object"])
@pytest.mark.parametrize("file", FILES)
@pytest.mark.parametrize("command", ["report", "compare"])
def test_report_and_compare_leave_out_what_is_damaged_and_say_so(whole, tmp_path, command, file, damage, monkeypatch):
    monkeypatch.setattr("pzt_ident.report.figures.write_all_figures", lambda folders, listen: None)
    monkeypatch.setattr("pzt_ident.report.figures.write_misfit_figures", lambda results, folder: iter(()))
    monkeypatch.setattr("pzt_ident.report.page._figures_by_section", lambda results: {})
    out, _ = hurt(whole, tmp_path, file, damage)
    ended = call(command, out)
    if file in ("result.json", "signals.nc"):
        assert ended.exit_code == 2 and file in ended.stderr
    else:
        assert ended.exit_code == 0
        if file in ("history.csv", "residuals.json") and command == "report":
            assert f"{file}: is damaged" in ended.stderr
            assert "is damaged" in (out / "report.html").read_text(encoding="utf-8")


def test_of_several_folders_the_damaged_one_is_left_out(whole, tmp_path, monkeypatch):
    monkeypatch.setattr("pzt_ident.report.figures.write_all_figures", lambda folders, listen: None)
    monkeypatch.setattr("pzt_ident.report.page._figures_by_section", lambda results: {})
    out, _ = hurt(whole, tmp_path, "result.json", "cut in half")
    others = [shutil.copytree(whole, tmp_path / name) for name in ("a", "b")]
    page = tmp_path / "page.html"
    ended = call("report", out, *others, "-o", page)
    assert ended.exit_code == 0
    assert f"{out / 'result.json'}: is damaged" in ended.stderr
    assert "2 results" in page.read_text(encoding="utf-8")


@pytest.mark.parametrize("command", ["tune", "export"])
@pytest.mark.parametrize("file", FILES)
def test_other_commands_say_what_is_damaged(whole, tmp_path, command, file):
    out, _ = hurt(whole, tmp_path, file, "garbled")
    more = ["--rate", "1kHz"] if command == "tune" else ["--to", "json", "--out", tmp_path / "export"]
    call(command, out, *more)
