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
        (["fleet", "{lot}/job.yaml", "{lot}/lot/*/", "--budget", "9"], "--budget: is the time of each diagnosis"),
        (["fleet", "{lot}/job.yaml", "{lot}/lot/*/", "--on", "cloud"], "is no place to run at"),
        (["run", "{lot}/job.yaml", "--on", "local:1", "--workers", "1"], "write --on local:1 alone"),
    ],
)
def test_clumsy_use_ends_with_a_sentence(lot, words, sentence):
    ended = call(*(word.format(lot=lot) for word in words))
    assert ended.exit_code == 2
    assert sentence in ended.stderr
    assert "Traceback" not in ended.output


def test_where_every_device_is_broken_the_command_fails(lot, tmp_path):
    home = tmp_path / "lot" / "a"
    home.mkdir(parents=True)
    for name in ("loops.csv", "tones.csv"):
        (home / name).write_text("")
    ended = call("fleet", lot / "job.yaml", f"{tmp_path}/lot/*/", "--out", tmp_path / "out")
    assert ended.exit_code == 1
    assert "no device could be identified" in ended.stderr
    assert (tmp_path / "out" / "devices.csv").exists()


def test_help_names_both_uses():
    text = call("fleet", "--help").output
    assert "fleet JOB PATTERN..." in text and "fleet report DIR" in text and "--improve" in text
