"""An improvement on a cluster, and one that was killed."""

import json
import shutil

import pytest

from experiments.fleet.lot import write_lot
from pzt_ident.errors import InputError
from pzt_ident.job.schema import load_job
from pzt_ident.model.registry import blocks
from pzt_ident.run.elsewhere import begin_again, end_last, is_whole, sought_at, task_of
from pzt_ident.run.folder import make_empty
from pzt_ident.run.place import HERE, place_of


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


def test_an_improvement_that_was_killed_is_begun_again(here, tmp_path):
    out = shutil.copytree(here, here.with_name("killed"))
    for name in ("diagnosis.json", "residuals.json", "signals.nc"):
        (out / name).unlink()
    content = json.loads((out / "improvement.json").read_text()) | {"verdict": "unfinished"}
    (out / "improvement.json").write_text(json.dumps(content))
    begin_again(out)
    assert (out / "improvement.json").read_bytes() == (here / "improvement.json").read_bytes()
    events = []
    begin_again(out, events.append)
    assert events == [{"event": "finished"}]


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
