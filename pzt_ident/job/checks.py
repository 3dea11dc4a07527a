"""Checks of the sections of a job, by themselves, against other sections and against the registries.

A fault is added to the document, not raised.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pzt_ident.data import units
from pzt_ident.errors import InputError, nearest
from pzt_ident.job.document import Document, Loc
from pzt_ident.job.parameter_checks import Earlier, check_parameters
from pzt_ident.job.plugins import plug
from pzt_ident.model.contract import check_loaded
from pzt_ident.model.description import meant
from pzt_ident.model.registry import blocks, optimizers, word_of

if TYPE_CHECKING:
    from pzt_ident.data.record import Axis, Channel, Source
    from pzt_ident.job.sections import Channels, Choice, Limits, Stopping

MOST_STEPS = 100  # of the simulation, in one sample


def _records(document: Document, sources: tuple[Source, ...], earlier: Earlier) -> None:
    if all(source.use != "identify" for source in sources):
        document.fault(("records",), "no identification record", "give at least one record `use: identify`")
    names: set[str] = set()
    for i, source in enumerate(sources):
        loc: Loc = ("records", i)
        _file(document, loc, source.file)
        _record_numbers(document, loc, source)
        for word, limits in (("rows", source.rows), ("time", source.time)):
            _interval(document, (*loc, word), limits)
        if source.name is not None and source.name in names:
            document.fault((*loc, "name"), f"duplicate record name {source.name!r}", "name each record differently")
        names |= {source.name} if source.name is not None else set()


def _file(document: Document, loc: Loc, file: str | None) -> None:
    if file is not None and not file.strip():
        document.fault((*loc, "file"), f"{file!r} names no file", "give its path, relative to the job")


def _record_numbers(document: Document, loc: Loc, source: Source) -> None:
    for word, least in (("settle", 0), ("decimate", 1), ("run_in", 0), ("steps", 1)):
        if getattr(source, word) < least:
            document.fault((*loc, word), f"{document.source((*loc, word))} is too small", f"give at least {least}")
    if source.sample_rate is not None and source.sample_rate <= 0:
        document.fault((*loc, "sample_rate"), f"{source.sample_rate:g} Hz", "give a rate above 0 Hz")
    if source.rest_at and source.run_in:
        message = "a record of a steady state, which `run_in` says this is, does not begin at rest"
        document.fault((*loc, "rest_at"), message, "keep one of the two")
    if source.rest_at and source.decimate > 1:
        message = "a step takes one sample, and `decimate` makes that longer"
        document.fault((*loc, "rest_at"), message, "keep one of the two")
    for axis, level in (source.rest_at or {}).items():
        if level.unit is not None:
            _unit(document, document.reach((*loc, "rest_at", axis)), level.unit)
    if source.steps > MOST_STEPS:
        document.fault((*loc, "steps"), f"{source.steps} steps a sample", f"give at most {MOST_STEPS}")


def _interval(document: Document, loc: Loc, limits: tuple[float | None, float | None] | None) -> None:
    if limits is None:
        return
    first, last = limits
    if first is not None and first < 0:
        document.fault((*loc, 0), f"{document.source((*loc, 0))} is before the start", "count from 0")
    if last is not None and last <= (first or 0):
        message = f"ends at {document.source((*loc, 1))}, at or before its start"
        document.fault(loc, message, "write [first, last], the earlier first")


def _channels(document: Document, channels: Channels, earlier: Earlier) -> None:
    complete = not any(source.channels for source in earlier.get("records", ()))
    _channel(document, ("channels", "time"), channels.time, complete)
    responses: dict[Channel, str] = {}
    for name, axis in channels.axes.items():
        loc: Loc = ("channels", "axes", name)
        if not name.isidentifier() or name in blocks.words():
            document.fault(loc, f"{name!r} cannot name an axis", "use letters and digits, such as x", at_key=True)
        _channel(document, (*loc, "drive"), axis.drive, complete)
        _channel(document, (*loc, "response"), axis.response, complete)
        if complete and axis.response is not None:
            _response(document, (*loc, "response"), axis, responses.get(axis.response))
            responses.setdefault(axis.response, name)
    for i, source in enumerate(earlier.get("records", ())):
        for name in source.rest_at or ():
            if name not in channels.axes:
                loc = ("records", i, "rest_at", name)
                document.fault(loc, f"there is no axis {name!r}", nearest(name, channels.axes), at_key=True)
    if all(axis.response is None for axis in channels.axes.values()):
        document.fault(("channels", "axes"), "no axis has a response", "give at least one axis a `response`")


def _response(document: Document, loc: Loc, axis: Axis, other: str | None) -> None:
    """other: an axis that has the same response."""
    if axis.drive == axis.response:
        document.fault(loc, "is the same channel as the drive", "name the measured displacement")
    if other is not None:
        document.fault(loc, f"is the same channel as that of axis {other}", "give each axis its own")


def _channel(document: Document, loc: Loc, channel: Channel | None, complete: bool) -> None:
    """complete: whether no record adds to what the channel says."""
    if channel is None:
        return
    if complete and all(getattr(channel, word) is None for word in ("name", "column", "dataset", "index", "file")):
        document.fault(loc, "names no channel", "give a header text, or `column`, `dataset` or `index`")
    if channel.column is not None and channel.column < 1:
        document.fault((*loc, "column"), f"there is no column {channel.column}", "columns count from 1")
    if channel.unit is not None:
        _unit(document, (*loc, "unit"), channel.unit)
    _file(document, loc, channel.file)


def _unit(document: Document, loc: Loc, unit: str) -> None:
    try:
        units.factor(unit)
    except InputError as error:
        document.fault(loc, error.message, error.remedy)


def _model(document: Document, items: tuple[str | Choice, ...], earlier: Earlier) -> None:
    if not items:
        document.fault(("model",), "the model has no block", "list at least one, see `pzt-ident list blocks`")
    folders: dict[str, str] = {}
    for i, item in enumerate(items):
        word, loc = word_of(item), document.reach(("model", i, "name"))
        if word not in blocks:
            operators = [word for word in blocks.usable() if not blocks.is_effect(word)]
            document.fault(loc, f"unknown block {word!r}", meant(word, operators))
            continue
        folder = blocks.folder(word)
        if blocks.is_effect(word):
            document.fault(loc, f"{word!r} is an effect", f"move it to `effects: [{word}]`")
        elif folder in folders:
            message = f"{word!r} beside {folders[folder]!r}: two blocks of {folder}"
            document.fault(loc, message, "keep one of the two")
        elif isinstance(item, str):
            with _as_fault(document, ("model", i)):
                blocks[item]
        else:
            _settings(document, ("model", i), item, blocks[word].form_of(item.settings).make)
        folders[folder] = word
    if folders.keys() == {"start"}:
        remedy = "add one, see `pzt-ident list blocks`"
        document.fault(("model",), f"nothing responds to the drive beside {folders['start']!r}", remedy)


def _plugins(document: Document, files: tuple[str, ...], earlier: Earlier) -> None:
    for i, file in enumerate(files):
        if not document.plugins:
            document.fault(("plugins", i), f"{file} would run as code", "read it, then add --plugins to the command")
            continue
        path = document.folder / file
        with _as_fault(document, ("plugins", i), str(path)):
            plug(path)
    for i, word in enumerate(Path(file).stem for file in files):
        if document.plugins and word in blocks:
            with _as_fault(document, ("plugins", i)):
                check_loaded(blocks[word], blocks)


@contextmanager
def _as_fault(document: Document, loc: Loc, known: str = "") -> Iterator[None]:
    """Turn an error into a fault at `loc`, with the place that the error names unless that is `known`."""
    try:
        yield
    except InputError as error:
        where = "" if error.where in ("", known) else f"{error.where}: "
        document.fault(loc, where + error.message, error.remedy)


def _rule_out(document: Document, words: tuple[str, ...], earlier: Earlier) -> None:
    for i, word in enumerate(words):
        if word not in blocks.effects() and word_of(word) in blocks.effects():
            document.fault(
                ("rule_out", i), f"{word!r} is a form", f"rule out the effect with all its forms: {word_of(word)}"
            )
        elif word not in blocks.effects():
            document.fault(("rule_out", i), f"unknown effect {word!r}", nearest(word, blocks.effects()))
        elif word in map(word_of, earlier.get("effects", ())):
            document.fault(("rule_out", i), f"{word!r} is among the `effects` too", "keep it in one of the two")


def _effects(document: Document, items: tuple[str, ...], earlier: Earlier) -> None:
    hosts = blocks.forms_of(earlier.get("model", ()))
    terms = {word for block in hosts for word in block.effects() if blocks.is_effect(word)}
    known, words = terms | set(blocks.effects()), list(map(word_of, items))
    for i, word in enumerate(words):
        loc: Loc = ("effects", i)
        effect = None
        with _as_fault(document, loc):
            effect = next(iter(blocks.chain([items[i]])), None)
        if word in words[:i]:
            again = "" if items[i] in items[:i] else ", of which a form is here already"
            document.fault(loc, f"duplicate effect {word!r}{again}", "keep one of the two")
        elif word not in known and word in blocks:
            document.fault(loc, f"{blocks[word].name!r} is not an effect", f"move it to `model: [{word}]`")
        elif word not in known:
            document.fault(loc, f"unknown effect {word!r}", nearest(word, known))
        elif (
            effect
            and "model" in earlier
            and _is_kind(effect, "Term")
            and not any(block.holds(effect) for block in hosts)
        ):
            owners = [block.name for block in blocks if block.holds(effect)]
            others = [f"`{item}`" for item in blocks.forms(word) if not _is_kind(blocks[item], "Term")]
            message = f"no block of this model has a term for {items[i]!r}"
            instead = f", or write {' or '.join(others)} here" if others else ""
            document.fault(loc, message, f"put one of these into `model`: {', '.join(owners)}{instead}")
        elif effect and "channels" in earlier and len(earlier["channels"].axes) < 2 and _is_kind(effect, "Coupling"):
            document.fault(loc, f"{word!r} needs a second axis", "give the other axis, at least its `drive`")
        elif effect and _is_kind(effect, "Coupling") and effect.lacks_mechanics(hosts):
            owners = [block.name for block in blocks if effect.mechanics_in([block])]
            document.fault(
                loc, f"{items[i]!r} acts through the mechanics", f"put this into `model`: {', '.join(owners)}"
            )


def _is_kind(effect: Any, kind: str) -> bool:
    from pzt_ident.model import block

    return issubclass(effect, getattr(block, kind))


def _shared(document: Document, names: tuple[str, ...], earlier: Earlier) -> None:
    if not {"model", "effects"} <= set(earlier):
        return
    with suppress(InputError):  # a bad setting of a block, reported at the setting
        used = blocks.chain((*earlier["model"], *earlier["effects"]))
        known = [f"{block.name}.{word}" for block in used for word in block.parameters()]
        for i, name in enumerate(names):
            if name not in known:
                document.fault(("shared", i), f"unknown parameter {name!r}", nearest(name, known))


def _optimizers(document: Document, choices: tuple[Choice, ...], earlier: Earlier) -> None:
    if not choices:
        document.fault(("optimizers",), "no optimizer", "list at least one, see `pzt-ident list optimizers`")
    names = [choice.name for choice in choices]
    for i, choice in enumerate(choices):
        loc: Loc = ("optimizers", i)
        if choice.name not in optimizers:
            document.fault(
                document.reach((*loc, "name")),
                f"unknown optimizer {choice.name!r}",
                nearest(choice.name, optimizers.words()),
            )
            continue
        if choice.name in names[:i]:
            document.fault(loc, f"{choice.name!r} twice", "keep one; compare its settings in a job each")
        _settings(document, loc, choice, optimizers[choice.name].make)


def _settings(document: Document, loc: Loc, choice: Choice, make: Callable[..., Any]) -> None:
    for key, error in _setting_errors(choice, make):
        document.fault((*loc, *key), error.message, error.remedy, at_key=error.message.startswith("unknown setting"))


def _setting_errors(choice: Choice, make: Callable[..., Any]) -> Iterator[tuple[Loc, InputError]]:
    """The errors of every setting by itself; that of all together where they are right by themselves."""
    are_valid = True
    for word, value in choice.settings.items():
        try:
            make(**{word: value})
        except InputError as error:
            if error.where == f"{choice.name}.{word}" or error.message.startswith("unknown setting"):
                are_valid = False
                yield (word,), error
    if are_valid:
        try:
            make(**choice.settings)
        except InputError as error:
            yield (), error


def _stop(document: Document, stop: Stopping, earlier: Earlier) -> None:
    if stop.target is not None and stop.target.unit is not None:
        _unit(document, ("stop", "target"), stop.target.unit)


def _limits(document: Document, limits: Limits, earlier: Earlier) -> None:
    if limits.drive and limits.drive[0] >= limits.drive[1]:
        low, high = limits.drive
        document.fault(("limits", "drive"), f"[{low:g}, {high:g}] are no limits", "write [lowest, highest]")


SECTIONS: Mapping[str, Callable[[Document, Any, Earlier], None]] = {
    "plugins": _plugins,
    "records": _records,
    "channels": _channels,
    "model": _model,
    "effects": _effects,
    "rule_out": _rule_out,
    "shared": _shared,
    "parameters": check_parameters,
    "optimizers": _optimizers,
    "stop": _stop,
    "limits": _limits,
}
