"""The files that a job names, and the same job on other files."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import Any

from pzt_ident.data.record import Axis, Channel, Source
from pzt_ident.job.schema import Job
from pzt_ident.job.sections import Channels


def record_files(job: Job) -> list[str]:
    """The files of its records, each once."""
    return list(dict.fromkeys(source.file for source in job.records))


def channel_files(job: Job) -> list[str]:
    """The files that single channels are taken from beside those of the records, each once."""
    files: list[str] = []

    def note(file: str) -> str:
        files.append(file)
        return file

    on_files(job, note)
    return [file for file in dict.fromkeys(files) if file not in record_files(job)]


def on_files(job: Job, name: Callable[[str], str]) -> Job:
    """The job with each file by another name; its text stays."""

    def channel(given: Channel) -> Channel:
        return given if given.file is None else replace(given, file=name(given.file))

    def source(given: Source) -> Source:
        channels = {key: channel(value) for key, value in given.channels.items()}
        return replace(given, file=name(given.file), channels=channels)

    axes = {
        key: Axis(channel(axis.drive), axis.response and channel(axis.response))
        for key, axis in job.channels.axes.items()
    }
    time = job.channels.time and channel(job.channels.time)
    return job.model_copy(update={"records": tuple(map(source, job.records)), "channels": Channels(axes, time)})


class Template:
    """The text of a job that is the same for many files; comments and layout are kept."""

    def __init__(self, job: Job) -> None:
        from ruamel.yaml import YAML

        yaml = YAML()
        yaml.preserve_quotes = True
        yaml.width = 10_000
        document = yaml.load(job.text)
        self.files: list[str] = []
        self._mark(document)
        text = StringIO()
        yaml.dump(document, text)
        self.text = text.getvalue()

    def _mark(self, node: Any) -> None:
        """Put a mark in the place of every file in an item."""
        from ruamel.yaml.scalarstring import DoubleQuotedScalarString

        if isinstance(node, list):
            for part in node:
                self._mark(part)
        elif isinstance(node, dict):
            for key, value in node.items():
                if key == "file" and isinstance(value, str):
                    if value not in self.files:
                        self.files.append(value)
                    node[key] = DoubleQuotedScalarString(_mark_of(self.files.index(value)))
                else:
                    self._mark(value)

    def on(self, names: Mapping[str, str]) -> str:
        """The text with each file by the name that it has here."""
        text = self.text
        for place, file in enumerate(self.files):
            text = text.replace(_mark_of(place), json.dumps(names.get(file, file), ensure_ascii=False)[1:-1])
        return text


def _mark_of(place: int) -> str:
    return f"@file {place}@"


def moved(text: str, before: Path, after: Path) -> str:
    """The text of a job in the folder `before` as it is in `after`: its paths lead to the same files."""
    from pzt_ident.job.edit import edited

    job = Job.from_text(text, before, plugins=True)
    return edited(job, job.effects, after)
