"""A job file with other effects or another model in it: comments, order and layout kept."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from io import StringIO
from pathlib import Path
from typing import Any

from pzt_ident.errors import InputError, nearest
from pzt_ident.job.schema import Job, load_job
from pzt_ident.model.registry import blocks


def add(job: Path, effect: str, out: Path, plugins: bool = False) -> Job:
    """Write the job of a file with one effect more into another; the new job.

    Raises InputError where the effect is unknown, there already, or does not fit the model, and where `out` exists.
    """
    before = load_job(job, plugins)
    if effect in before.effects:
        raise InputError(f"{effect!r} is in its effects already", where=str(job), remedy="add another effect")
    if effect not in blocks:
        raise InputError(f"unknown effect {effect!r}", remedy=nearest(effect, blocks.effects()))
    return _write(before, (*before.effects, effect), None, out, plugins)


def remove(job: Path, effect: str, out: Path, plugins: bool = False) -> Job:
    """Write the job of a file without one of its effects into another; the new job.

    Raises InputError where it is not among them, and where `out` exists.
    """
    before = load_job(job, plugins)
    if effect not in before.effects:
        raise InputError(f"{effect!r} is not in its effects", where=str(job), remedy=_there(before.effects))
    return _write(before, [word for word in before.effects if word != effect], None, out, plugins)


def model(job: Path, words: Sequence[str], out: Path, plugins: bool = False) -> Job:
    """Write the job of a file with these blocks as its model into another; the new job. A block keeps its settings.

    Raises InputError where the blocks are no model, and where `out` exists.
    """
    before = load_job(job, plugins)
    return _write(before, before.effects, words, out, plugins)


def _there(effects: Sequence[str]) -> str:
    return f"it has {', '.join(effects)}" if effects else "it has none"


def _write(before: Job, effects: Sequence[str], words: Sequence[str] | None, out: Path, plugins: bool) -> Job:
    from pzt_ident.files import write_text

    if out.exists():
        raise InputError("exists already", where=str(out), remedy="give another file with -o")
    text = edited(before, effects, out.parent, words)
    made = Job.from_text(text, out.parent, str(out), plugins)
    write_text(out, text)
    return made


def edited(
    job: Job,
    effects: Sequence[str],
    folder: Path,
    words: Sequence[str] | None = None,
    steps: Sequence[int] = (),
    values: Mapping[str, float] | None = None,
) -> str:
    """The job's text with these effects, its paths as seen from another folder; with these blocks where `words` are
    given, `steps` a sample of each record, where they are not the job's, and parameters fixed to `values`."""
    from ruamel.yaml import YAML
    from ruamel.yaml.comments import CommentedMap, CommentedSeq

    yaml = YAML()
    yaml.preserve_quotes = True
    yaml.width = 10_000
    document: Any = yaml.load(job.text)
    if "effects" not in document:
        document.insert(list(document).index("model") + 1, "effects", CommentedSeq())
    if values and not document.get("parameters"):
        document.pop("parameters", None)
        document.insert(list(document).index("effects") + 1, "parameters", CommentedMap())
    found = document["effects"]
    if not found:
        found.fa.set_flow_style()
    for word in [word for word in found if word not in effects]:
        found.remove(word)
    found.extend(word for word in effects if word not in found)
    if words is not None:
        document["model"][:] = _items(document["model"], words)
    for record, source, count in zip(document["records"], job.records, steps, strict=False):
        if count != source.steps:
            record["steps"] = count
    for name, value in (values or {}).items():
        document["parameters"][name] = CommentedMap(value=value)
        document["parameters"][name].fa.set_flow_style()
    if job.folder.resolve() != folder.resolve():
        moved(document, job.folder, folder)
        for i, file in enumerate(document.get("plugins", ())):
            document["plugins"][i] = seen_from(file, job.folder, folder)
    yaml.indent(**indents(document))
    written = StringIO()
    yaml.dump(document, written)
    return written.getvalue()


def _items(items: Sequence[Any], words: Sequence[str]) -> list[Any]:
    """The blocks of these words, as they stand in the model where they are in it."""
    known = {item if isinstance(item, str) else item["name"]: item for item in items}
    return [known.get(word, word) for word in words]


def indents(document: Any) -> dict[str, int]:
    """How far the job's own mappings and lists are set in."""
    axes, records = document["channels"], document["records"]
    mapping = 2 if axes.fa.flow_style() else axes.lc.col
    dash = 0 if records.fa.flow_style() else records.lc.col
    return {"mapping": mapping, "sequence": dash + 2, "offset": dash}


def moved(item: Any, before: Path, after: Path) -> None:
    """Every `file` below, relative to another folder; absolute paths and those with a variable stay."""
    if isinstance(item, list):
        for part in item:
            moved(part, before, after)
    elif isinstance(item, dict):
        for key, value in item.items():
            if key == "file" and isinstance(value, str):
                item[key] = seen_from(value, before, after)
            else:
                moved(value, before, after)


def seen_from(path: str, before: Path, after: Path) -> str:
    if Path(path).is_absolute() or path.startswith(("$", "~")):
        return path
    return os.path.relpath(before.resolve() / path, after.resolve())
