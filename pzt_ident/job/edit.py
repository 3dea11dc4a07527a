"""Edit a job file: other effects, another model; comments, order and layout are kept."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from io import StringIO
from pathlib import Path
from typing import Any

from pzt_ident.errors import InputError, nearest
from pzt_ident.job.schema import Job, load_job
from pzt_ident.model.registry import blocks, word_of


def add(job: Path, effect: str, out: Path, plugins: bool = False, start: Path | None = None) -> Job:
    """Write the job with one more effect into the new file `out`; returns the new job. start: the folder of a diagnosis
    that tried it; the job then has the steps of the simulation, and the axes without the effect, of that fit.

    Raises InputError where the effect is unknown, in the job already or does not fit the model, and where `out` exists.
    """
    before = load_job(job, plugins)
    if word_of(effect) in map(word_of, before.effects):
        raise InputError(f"{word_of(effect)!r} is in its effects already", where=str(job), remedy="add another effect")
    if word_of(effect) not in blocks:
        raise InputError(f"unknown effect {effect!r}", remedy=nearest(effect, blocks.effects()))
    return _write(before, (*before.effects, effect), None, out, plugins, **(tried(start, effect) if start else {}))


def tried(folder: Path, effect: str) -> dict[str, Any]:
    """What the fit in which a diagnosis tried an effect has beside it, as `edited` takes it; empty where it did not."""
    path = folder / "diagnosis.json"
    try:
        candidates = json.loads(path.read_text(encoding="utf-8"))["candidates"] if path.is_file() else []
    except (ValueError, KeyError):
        remedy = "run `pzt-ident diagnose` again"
        raise InputError("is not as `pzt-ident diagnose` writes it", where=str(path), remedy=remedy) from None
    for candidate in candidates:
        if candidate.get("parameters") and effect in (candidate["effect"], candidate["item"]):
            return {key: candidate[key] for key in ("steps", "values") if candidate.get(key)}
    return {}


def remove(job: Path, effect: str, out: Path, plugins: bool = False) -> Job:
    """Write the job without one of its effects into the new file `out`; returns the new job.

    Raises InputError where it is not among them, and where `out` exists.
    """
    before = load_job(job, plugins)
    remaining = [item for item in before.effects if effect not in (item, word_of(item))]
    if len(remaining) == len(before.effects):
        raise InputError(f"{effect!r} is not in its effects", where=str(job), remedy=_effects_there(before.effects))
    return _write(before, remaining, None, out, plugins)


def model(job: Path, words: Sequence[str], out: Path, plugins: bool = False) -> Job:
    """Write the job with these blocks as its model into the new file `out`; returns the new job. A block keeps its
    settings.

    Raises InputError where the blocks are no model, and where `out` exists.
    """
    before = load_job(job, plugins)
    return _write(before, before.effects, words, out, plugins)


def _effects_there(effects: Sequence[str]) -> str:
    return f"it has {', '.join(effects)}" if effects else "it has none"


def _write(
    before: Job, effects: Sequence[str], words: Sequence[str] | None, out: Path, plugins: bool, **more: Any
) -> Job:
    from pzt_ident.files import write_text

    if out.exists():
        raise InputError("exists already", where=str(out), remedy="give another file with -o")
    text = edited(before, effects, out.parent, words, **more)
    new_job = Job.from_text(text, out.parent, str(out), plugins)
    write_text(out, text)
    return new_job


def edited(
    job: Job,
    effects: Sequence[str],
    folder: Path,
    words: Sequence[str] | None = None,
    steps: Sequence[int] = (),
    values: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    parameters: Mapping[str, Mapping[str, Any]] | None = None,
    sections: Mapping[str, Any] | None = None,
    switched: Mapping[str, Sequence[bool | None]] | None = None,
) -> str:
    """The job's text with these effects, and with paths relative to another folder.

    words: the blocks of the model, where it changes. steps: of the simulation in a sample, for every record.
    values: of parameters that are fixed from now on. bounds: of parameters where they change.
    parameters: what the job says of some from now on, `bounds` or `value`. sections: other sections, whole.
    switched: settings that are on, for every record, such as `denoise_drive`.
    """
    from ruamel.yaml import YAML

    yaml = YAML()
    yaml.preserve_quotes = True
    yaml.width = 10_000
    document: Any = yaml.load(job.text)
    _set_effects(document, effects)
    if words is not None:
        document["model"][:] = _items(document["model"], words)
    _set_records(document, job, steps, switched or {})
    ends = {name: [float(f"{low:.6g}"), float(f"{high:.6g}")] for name, (low, high) in (bounds or {}).items()}
    given = document.get("parameters") or {}
    for name in ends.keys() & given.keys():
        given[name]["bounds"][:] = ends[name]
    _drop_parameters(document, job, effects, words)
    settings = {name: {"value": value} for name, value in (values or {}).items()} | dict(parameters or {})
    settings |= {name: {"bounds": pair} for name, pair in ends.items() if name not in given}
    if settings:
        _set_parameters(document, settings)
    for name, content in (sections or {}).items():
        document[name] = _flow(content)
    if job.folder.resolve() != folder.resolve():
        _rebase_files(document, job.folder, folder)
    yaml.indent(**_indents(document))
    text = StringIO()
    yaml.dump(document, text)
    return text.getvalue()


def _set_records(document: Any, job: Job, steps: Sequence[int], switched: Mapping[str, Sequence[bool | None]]) -> None:
    for record, source, count in zip(document["records"], job.records, steps, strict=False):
        if count != source.steps:
            record["steps"] = count
    for word, each in switched.items():
        for record, source, on in zip(document["records"], job.records, each, strict=False):
            if on is not None and on != getattr(source, word):
                record[word] = on


def _set_effects(document: Any, effects: Sequence[str]) -> None:
    from ruamel.yaml.comments import CommentedSeq

    if "effects" not in document:
        document.insert(list(document).index("model") + 1, "effects", CommentedSeq())
    listed = document["effects"]
    if not listed:
        listed.fa.set_flow_style()
    for word in [word for word in listed if word not in effects]:
        listed.remove(word)
    listed.extend(word for word in effects if word not in listed)


def _drop_parameters(document: Any, job: Job, effects: Sequence[str], words: Sequence[str] | None) -> None:
    """Take out what the job says of parameters of blocks and effects that it no longer has."""
    before = {*map(word_of, job.model), *map(word_of, job.effects)}
    gone = before - {*map(word_of, job.model if words is None else words), *map(word_of, effects)}
    for name in list(document.get("parameters") or {}):
        block, _, word = name.rpartition(".")
        owner = block.rpartition(".")[2]
        parameter = blocks[owner].parameters().get(word) if owner in blocks else None
        if owner in gone or (parameter and parameter.effect_word in gone):
            del document["parameters"][name]
    if "parameters" in document and not document["parameters"]:
        del document["parameters"]


def _set_parameters(document: Any, settings: Mapping[str, Mapping[str, Any]]) -> None:
    from ruamel.yaml.comments import CommentedMap

    if not document.get("parameters"):
        document.pop("parameters", None)
        document.insert(list(document).index("effects") + 1, "parameters", CommentedMap())
    for name, content in settings.items():
        document["parameters"][name] = _flow(content)


def _flow(content: Any) -> Any:
    """Mappings and lists as they are written on one line; a list of mappings has a line for each."""
    from ruamel.yaml.comments import CommentedMap, CommentedSeq

    if isinstance(content, Mapping):
        node: Any = CommentedMap({key: _flow(value) for key, value in content.items()})
    elif isinstance(content, list | tuple):
        node = CommentedSeq([_flow(value) for value in content])
    else:
        return content
    if not any(isinstance(value, Mapping) for value in content):
        node.fa.set_flow_style()
    return node


def _items(items: Sequence[Any], words: Sequence[str]) -> list[Any]:
    """The blocks of these words, as they stand in the model where they are in it."""
    known = {item if isinstance(item, str) else item["name"]: item for item in items}
    return [known.get(word, word) for word in words]


def _indents(document: Any) -> dict[str, int]:
    """The indentation of the mappings and lists of the job."""
    axes, records = document["channels"], document["records"]
    mapping = 2 if axes.fa.flow_style() else axes.lc.col
    dash = 0 if records.fa.flow_style() else records.lc.col
    return {"mapping": mapping, "sequence": dash + 2, "offset": dash}


def _rebase_files(item: Any, before: Path, after: Path) -> None:
    """Make every `file` in an item, and all `plugins`, relative to the folder `after`; absolute paths and those with a
    variable stay."""
    if isinstance(item, list):
        for part in item:
            _rebase_files(part, before, after)
    elif isinstance(item, dict):
        for key, value in item.items():
            if key == "file" and isinstance(value, str):
                item[key] = _rebased(value, before, after)
            elif key == "plugins":
                value[:] = [_rebased(file, before, after) for file in value]
            else:
                _rebase_files(value, before, after)


def _rebased(path: str, before: Path, after: Path) -> str:
    if Path(path).is_absolute() or path.startswith(("$", "~")):
        return path
    return os.path.relpath(before.resolve() / path, after.resolve())
