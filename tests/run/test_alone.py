"""Two processes do not work in one folder."""

import errno
import os
from pathlib import Path

import pytest

import measured
from pzt_ident.errors import InputError
from pzt_ident.job.schema import load_job
from pzt_ident.run.alone import LOCK, alone_in, taken
from pzt_ident.run.elsewhere import begin_again
from pzt_ident.run.events import event_log, nobody
from pzt_ident.run.identify import resume, run
from pzt_ident.run.improve import begin_task

JOB = """\
name: small
records: [{file: identify.csv, use: identify}]
channels:
  time: "time [s]"
  axes:
    x: {drive: "u_x [V]", response: "x [um]"}
model: [bouc_wen]
effects: []
optimizers: [{name: pso, population: 8, generations: 4}]
"""


@pytest.fixture
def job(tmp_path):
    measured.write_raised(tmp_path / "identify.csv", 400)
    (tmp_path / "job.yaml").write_text(JOB)
    return load_job(tmp_path / "job.yaml")


@pytest.fixture(params=[resume, begin_again], ids=["a run", "an improvement"])
def begun(request, job, tmp_path):
    """A folder that was begun, and what goes on with it."""
    if request.param is resume:
        return run(job, tmp_path / "out"), resume
    return begin_task(job, tmp_path / "out", 1.0, None)[1], begin_again


def test_who_goes_on_with_a_folder_in_which_another_one_works_is_told_so(begun):
    folder, go_on = begun
    before = sorted(folder.iterdir())
    with (folder / "events.jsonl").open("a") as log:
        assert taken(log)
        with pytest.raises(InputError, match="another process is at work in this folder"):
            go_on(folder)
    assert {*before} <= {*folder.iterdir()} and not list(folder.parent.glob(".*again"))
    assert go_on(folder) == folder


def test_a_log_is_free_when_its_run_is_over(tmp_path):
    for _ in range(2):
        with event_log(tmp_path, nobody) as tell:
            tell({"event": "done"})
    assert len((tmp_path / "events.jsonl").read_text().splitlines()) == 2


@pytest.mark.parametrize("denied", [errno.EACCES, errno.EPERM, errno.EROFS])
def test_a_folder_that_may_not_be_written_into_is_told_with_a_remedy(tmp_path, monkeypatch, denied):
    def refuse(*arguments, **options):
        raise OSError(denied, os.strerror(denied), str(tmp_path / LOCK))

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(InputError, match=f"{tmp_path}: cannot be written into") as caught, alone_in(tmp_path):
        pass
    assert "--out" in caught.value.remedy and LOCK not in str(caught.value)
