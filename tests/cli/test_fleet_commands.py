"""The commands on many devices."""

import json
import shutil

import pytest
from click.testing import CliRunner

from experiments.fleet.lot import write_lot
from pzt_ident.cli.commands import main


def call(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.fixture(scope="module")
def lot(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lot")
    write_lot(folder, 3, 1, broken=0.3, samples=300, swarm=(8, 8))
    return folder


@pytest.fixture(scope="module")
def out(lot, tmp_path_factory):
    folder = tmp_path_factory.mktemp("out") / "fleet"
    ended = call("fleet", lot / "job.yaml", f"{lot}/lot/*/", "--out", folder, "--on", "local:1", "--json")
    assert ended.exit_code == 0, ended.output
    facts = json.loads(ended.stdout)
    assert (facts["devices"], facts["done"], len(facts["broken"])) == (3, 2, 1)
    return folder


def test_it_says_what_the_lot_came_to_and_what_to_do_next(lot, out):
    ended = call("fleet", lot / "job.yaml", f"{lot}/lot/*/", "--out", out, "--workers", "1")
    assert "2 of 3 devices identified, 1 broken." in ended.stdout
    assert f"next: pzt-ident fleet report {out}" in ended.stdout
    assert "the file is empty" in ended.stderr


def test_resume_goes_on_with_a_fleet(out, tmp_path):
    shutil.copytree(out, tmp_path / "out")
    ended = call("resume", tmp_path / "out", "--on", "local:1", "--json")
    assert json.loads(ended.stdout)["done"] == 2


def test_a_fleet_starts_from_no_other_fit(out):
    ended = call("resume", out, "--from", out)
    assert ended.exit_code == 2 and "--from is for a run" in ended.stderr


def test_report_of_a_fleet(out):
    ended = call("fleet", "report", out, "--json", "--workers", "1")
    assert json.loads(ended.stdout)["report"] == str(out / "report.html")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["fleet", "{lot}/job.yaml"], "Missing argument 'PATTERN...'"),
        (["fleet", "{lot}/job.yaml", "nothing/*/", "--out", "{lot}/x"], "matches nothing"),
        (["fleet", "{lot}/no.yaml", "{lot}/lot/*/"], "no such file"),
        (["fleet", "report", "{lot}"], "holds no fleet"),
        (["fleet", "reprot", "{lot}"], "did you mean 'report'?"),
        (
            ["fleet", "{lot}/lot/*/", "{lot}/job.yaml"],
            "the job comes first: `pzt-ident fleet {lot}/job.yaml PATTERN...`",
        ),
        (["fleet", "{lot}/lot", "{lot}/truth.json", "{lot}/job.yaml"], "the job comes first"),
        (["fleet", "{lot}/job.yaml", "{lot}/empty.csv"], "{lot}/empty.csv: the file is empty"),
        (["fleet", "{lot}/job.yaml", "{lot}/lot/*/", "--budget", "9"], "--budget: is the time of each diagnosis"),
        (["fleet", "{lot}/job.yaml", "{lot}/lot/*/", "--on", "cloud"], "is no place to run at"),
        (["run", "{lot}/job.yaml", "--on", "local:1", "--workers", "1"], "write --on local:1 alone"),
    ],
)
def test_clumsy_use_ends_with_a_sentence(lot, words, sentence):
    (lot / "empty.csv").touch()
    ended = call(*(word.format(lot=lot) for word in words))
    assert ended.exit_code == 2
    assert sentence.format(lot=lot) in ended.stderr
    assert "Traceback" not in ended.output


def test_where_every_device_is_broken_the_command_fails(lot, tmp_path):
    home = tmp_path / "lot" / "a"
    home.mkdir(parents=True)
    for name in ("loops.csv", "tones.csv"):
        (home / name).write_text("")
    ended = call("fleet", lot / "job.yaml", f"{tmp_path}/lot/*/", "--out", tmp_path / "out")
    assert ended.exit_code == 1
    assert "no device could be identified" in ended.stderr and "next:" not in ended.output
    assert (tmp_path / "out" / "devices.csv").exists()


def test_a_fault_that_all_devices_have_is_told_once(lot, tmp_path):
    job = tmp_path / "job.yaml"
    job.write_text((lot / "job.yaml").read_text().replace("x [um]", "x [furlong]"))
    for name in "abcd":
        shutil.copytree(next((lot / "lot").glob("d*1")), tmp_path / "lot" / name)
    ended = call("fleet", job, f"{tmp_path}/lot/*/", "--out", tmp_path / "out", "--on", "local:1")
    assert ended.exit_code == 1
    assert ended.stderr.count("has no column 'x [furlong]'") == 1
    assert "b, c, d are broken for the same reason as a: is it the job that is at fault?" in ended.stderr


@pytest.mark.parametrize("words", [["fleet", "report"], ["resume"]])
def test_a_damaged_fleet_is_made_again_by_its_command(lot, out, tmp_path, words):
    copy = shutil.copytree(out, tmp_path / "out")
    (copy / "fleet.json").write_text("{")
    ended = call(*words, copy)
    assert (ended.exit_code, f"give the command that made it again, with --out {copy}" in ended.stderr) == (2, True)
    ended = call("fleet", lot / "job.yaml", f"{lot}/lot/*/", "--out", copy, "--on", "local:1")
    assert ended.exit_code == 0 and "2 of 3 devices were done before and are as they were" in ended.stderr


def test_quiet_says_nothing_but_errors(lot, tmp_path, recwarn):
    shutil.copytree(next((lot / "lot").glob("d*1")), tmp_path / "lot/a")
    (tmp_path / "lot/link").symlink_to("a")
    words = ["fleet", lot / "job.yaml", f"{tmp_path}/lot/*/", "--out", tmp_path / "out", "--on", "local:1"]
    ended = call(*words, "--quiet")
    assert (ended.exit_code, ended.output, len(recwarn)) == (0, "", 0)
    assert call(*words).output and "it is one device" in str(recwarn.pop().message)


def test_help_names_both_uses():
    text = call("fleet", "--help").output
    assert "fleet JOB PATTERN..." in text and "fleet report DIR" in text and "--improve" in text
