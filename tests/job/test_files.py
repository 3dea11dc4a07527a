"""The same job on other files."""

from pathlib import Path

import pytest

from pzt_ident.job.files import Template, channel_files, moved, on_files, record_files
from pzt_ident.job.schema import Job, load_job

JOBS = [*sorted(Path("configs").glob("*.yaml")), Path("pzt_ident/job/examples/demo/job.yaml")]
CHANNELS = """\
records: [{file: a.npy, sample_rate: 1 kHz, channels: {x.drive: {file: "of ' one.npy", unit: V}}}]  # why
channels: {axes: {x: {drive: {file: u.npy, unit: V}, response: {file: a.npy, unit: um}}}}
model: [bouc_wen]
"""


@pytest.mark.parametrize("path", [path for path in JOBS if path.exists()], ids=lambda path: path.stem)
def test_the_text_on_other_files_states_the_job_on_other_files(path):
    job = load_job(path, plugins=True)
    names = {file: f'other "{place}".csv' for place, file in enumerate([*record_files(job), *channel_files(job)])}
    stated = Job.from_text(Template(job).on(names), job.folder, f"{job.name}.yaml", plugins=True)
    assert stated.hash == on_files(job, names.__getitem__).hash != job.hash
    assert on_files(job, lambda file: file).hash == job.hash
    assert Job.from_text(Template(job).on({}), job.folder, f"{job.name}.yaml", plugins=True).hash == job.hash


def test_files_of_records_and_of_single_channels_are_told_apart():
    job = Job.from_text(CHANNELS)
    assert (record_files(job), channel_files(job)) == (["a.npy"], ["u.npy", "of ' one.npy"])
    assert "# why" in Template(job).on({"a.npy": "b.npy"})


def test_a_job_that_is_moved_leads_to_the_same_files(tmp_path):
    text = moved(CHANNELS, tmp_path / "a" / "b", tmp_path / "c")
    assert record_files(Job.from_text(text)) == ["../a/b/a.npy"]
