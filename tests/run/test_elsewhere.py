"""An improvement on a cluster, and one that was killed."""

import json
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from experiments.fleet.lot import write_lot
from pzt_ident.cli.commands import main
from pzt_ident.errors import InputError
from pzt_ident.job.schema import load_job
from pzt_ident.model.registry import blocks
from pzt_ident.run import elsewhere
from pzt_ident.run.elsewhere import begin_again, end_last, is_whole, sought_at, task_of
from pzt_ident.run.folder import make_empty, read_environment
from pzt_ident.run.improve import begin_task
from pzt_ident.run.place import HERE, Local, place_of


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    """A stage whose gain grows with the voltage, and few effects to choose from."""
    folder = tmp_path_factory.mktemp("job")
    write_lot(folder, 2, 3, hidden=1.0, samples=600)
    truth = json.loads((folder / "truth.json").read_text())
    home = folder / "lot" / next(name for name, facts in truth.items() if facts["kind"] == "quadratic_gain")
    others = [word for word in blocks.effects() if word not in ("creep", "quadratic_gain")]
    text = (folder / "job.yaml").read_text()
    (home / "job.yaml").write_text(f"{text}rule_out: [{', '.join(others)}]\n")
    return load_job(home / "job.yaml")


@pytest.fixture(scope="module")
def here(job, tmp_path_factory):
    return sought_at(HERE, "improve", job, tmp_path_factory.mktemp("here") / "out")


def test_the_same_improvement_and_diagnosis_on_a_cluster(job, here, tmp_path):
    pytest.importorskip("distributed")
    from experiments.fleet.cluster import TCP

    cluster, events = TCP(workers=1), []
    try:
        away = sought_at(place_of(cluster.address), "improve", job, tmp_path / "out", events.append)
        diagnosed = sought_at(place_of(cluster.address), "diagnose", job, tmp_path / "diagnosed")
    finally:
        cluster.end()
    assert (away / "improvement.json").read_bytes() == (here / "improvement.json").read_bytes()
    assert load_job(away / "improved.yaml").hash != job.hash
    for source in load_job(away / "improved.yaml").records:
        assert (away / source.file).is_file()
    assert "quadratic_gain" in [event["added"] for event in events if event["event"] == "stair"]
    assert (task_of(away), task_of(diagnosed)) == ("improve", "diagnose")
    found = sought_at(HERE, "diagnose", job, tmp_path / "found") / "diagnosis.json"
    assert (diagnosed / "diagnosis.json").read_bytes() == found.read_bytes()


class Away:
    """A place that shares no disk with this process, in this process."""

    shares_disk = False

    def __init__(self):
        self.tasks = []

    def run_all(self, entry, common, tasks, tell, done):
        for name, arguments in tasks:
            self.tasks.append(arguments)
            done(name, entry(tell, *common, *arguments))
        return {}


def killed(whole, tmp_path):
    """The folder of an improvement, as a kill ahead of its end leaves it."""
    out = shutil.copytree(whole, whole.with_name(tmp_path.name))
    for name in ("diagnosis.json", "residuals.json", "signals.nc"):
        (out / name).unlink()
    content = json.loads((out / "improvement.json").read_text()) | {"verdict": "unfinished"}
    (out / "improvement.json").write_text(json.dumps(content))
    return out


def test_an_improvement_that_was_killed_is_begun_again_at_any_place(here, tmp_path):
    out, place = killed(here, tmp_path), Away()
    begin_again(out, place=place)
    assert (out / "improvement.json").read_bytes() == (here / "improvement.json").read_bytes()
    assert [arguments[0] for arguments in place.tasks] == ["improve"]
    for source in load_job(out / "improved.yaml").records:
        assert (out / source.file).is_file()
    events = []
    begin_again(out, events.append, place=place)
    assert events == [{"event": "finished"}]


@pytest.mark.parametrize("task", ["improve", "diagnose"])
@pytest.mark.parametrize("ended", [False, True])
def test_resume_heeds_where_and_from_what(here, tmp_path, monkeypatch, task, ended):
    out, asked = shutil.copytree(here, tmp_path / "out") if ended else killed(here, tmp_path), []
    environment = json.loads((out / "environment.json").read_text())
    environment["task"] |= {"name": task}
    (out / "environment.json").write_text(json.dumps(environment))

    def sought_at(place, task, job, new, listen, budget, start):
        asked.append((place, task, start))
        return shutil.copytree(here, new)

    monkeypatch.setattr(elsewhere, "sought_at", sought_at)
    words = ["resume", str(out), "--on", "local:3", "--from", str(here), "--no-report", "--quiet"]
    ran = CliRunner().invoke(main, words)
    assert ran.exit_code == 0, ran.output
    assert asked == [(Local(3), task, here)]


def test_what_it_began_from_is_found_from_any_working_folder(job, here, tmp_path, monkeypatch):
    monkeypatch.chdir(here.parent)
    begin_task(job, tmp_path / "out", 1.0, Path(here.name))
    assert read_environment(tmp_path / "out")["task"]["start"] == str(here)


def test_an_improvement_is_whole_only_with_all_of_its_files_as_written(here, tmp_path):
    assert is_whole(here)
    for name in ("diagnosis.json", "improvement.json", "residuals.json"):
        out = shutil.copytree(here, tmp_path / name)
        (out / name).write_bytes((out / name).read_bytes()[:-40])
        assert not is_whole(out)
    assert sorted(["diagnosis.json", "signals.nc", "improvement.json"], key=end_last)[-1] == "diagnosis.json"


def test_what_a_killed_beginning_left_is_begun_again_and_nothing_else(tmp_path):
    for name in ("job.yaml", ".job.yaml.x7.tmp", ".environment.json.x7.tmp"):
        (tmp_path / name).write_text("name: a")
    make_empty(tmp_path, "name: a")
    with pytest.raises(InputError, match="not empty"):
        make_empty(tmp_path, "name: another")
    (tmp_path / "environment.json").write_text("{}")
    with pytest.raises(InputError, match="not empty"):
        make_empty(tmp_path, "name: a")
