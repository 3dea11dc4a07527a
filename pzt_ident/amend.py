"""A job file with other effects in it: comments, order and layout kept."""

from __future__ import annotations

import os
from collections.abc import Sequence
from io import StringIO
from pathlib import Path
from typing import Any

from pzt_ident.errors import InputError
from pzt_ident.job import Job, load_job


def add(job: Path, effect: str, out: Path) -> Job:
    """Write the job of a file with one effect more into another; the new job.

    Raises InputError where the effect is unknown, there already, or does not fit the model, and where `out` exists.
    """
    from pzt_ident.files import write_text

    before = load_job(job)
    if out.exists():
        raise InputError("exists already", where=str(out), remedy="give another file with -o")
    text = with_effects(before, (*before.effects, effect), out.parent)
    made = Job.from_text(text, out.parent, str(out))
    write_text(out, text)
    return made


def with_effects(job: Job, effects: Sequence[str], folder: Path) -> str:
    """The job's text with these effects, its paths as seen from another folder."""
    from ruamel.yaml import YAML

    yaml = YAML()
    yaml.preserve_quotes = True
    yaml.width = 120
    document: Any = yaml.load(job.text)
    found = document.get("effects")
    if found is None:
        place = list(document).index("model") + 1 if "model" in document else len(document)
        document.insert(place, "effects", list(effects))
    else:
        found[:] = [word for word in found if word in effects]
        found.extend(word for word in effects if word not in found)
    if job.folder.resolve() != folder.resolve():
        document["records"] = moved(document["records"], job.folder, folder)
    written = StringIO()
    yaml.dump(document, written)
    return written.getvalue()


def moved(item: Any, before: Path, after: Path) -> Any:
    """Every `file` below, relative to another folder; absolute paths and those with a variable stay."""
    if isinstance(item, list):
        for part in item:
            moved(part, before, after)
    elif isinstance(item, dict):
        for key, value in item.items():
            if key == "file" and isinstance(value, str):
                if not (Path(value).is_absolute() or value.startswith(("$", "~"))):
                    item[key] = os.path.relpath(before.resolve() / value, after.resolve())
            else:
                moved(value, before, after)
    return item
