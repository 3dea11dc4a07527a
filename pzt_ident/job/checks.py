"""What the parts of a job must be to agree with each other and with the registries; faults are noted, not raised."""

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
from pzt_ident.model.registry import blocks, optimizers, word_of

if TYPE_CHECKING:
    from pzt_ident.data.record import Channel, Source
    from pzt_ident.job.sections import Channels, Choice, Limits, Stopping

MOST_STEPS = 100  # of the simulation in a sample


def _records(document: Document, sources: tuple[Source, ...], earlier: Earlier) -> None:
    if all(source.use != "identify" for source in sources):
        document.fault(("records",), "no record to identify from", "give at least one record `use: identify`")
    names: set[str] = set()
    for i, source in enumerate(sources):
        at: Loc = ("records", i)
        for word, least in (("settle", 0), ("decimate", 1), ("run_in", 0), ("steps", 1)):
            if getattr(source, word) < least:
                document.fault((*at, word), f"{document.source((*at, word))} is too small", f"give at least {least}")
        if source.sample_rate is not None and source.sample_rate <= 0:
            document.fault((*at, "sample_rate"), f"{source.sample_rate:g} Hz", "give a rate above 0 Hz")
        if source.steps > MOST_STEPS:
            document.fault((*at, "steps"), f"{source.steps} steps a sample", f"give at most {MOST_STEPS}")
        for word, stretch in (("rows", source.rows), ("time", source.time)):
            _stretch(document, (*at, word), stretch)
        if source.name is not None and source.name in names:
            document.fault((*at, "name"), f"duplicate record name {source.name!r}", "name each record differently")
        names |= {source.name} if source.name is not None else set()


def _stretch(document: Document, at: Loc, stretch: tuple[float | None, float | None] | None) -> None:
    if stretch is None:
        return
    first, last = stretch
    if first is not None and first < 0:
        document.fault((*at, 0), f"{document.source((*at, 0))} is before the start", "count from 0")
    if last is not None and last <= (first or 0):
        message = f"ends at {document.source((*at, 1))}, at or before its start"
        document.fault(at, message, "write [first, last], the earlier first")


def _channels(document: Document, channels: Channels, earlier: Earlier) -> None:
    alone = not any(source.channels for source in earlier.get("records", ()))
    places: list[tuple[Loc, Channel | None]] = [(("channels", "time"), channels.time)]
    seen: dict[str, Channel | None] = {}
    for name, axis in channels.axes.items():
        at: Loc = ("channels", "axes", name)
        if not name.isidentifier() or name in blocks.words():
            document.fault(at, f"{name!r} cannot name an axis", "use letters and digits, such as x", at_key=True)
        places += [((*at, "drive"), axis.drive), ((*at, "response"), axis.response)]
        if alone and axis.drive == axis.response:
            document.fault((*at, "response"), "is the same channel as the drive", "name the measured displacement")
        twin = next((other for other in seen if alone and axis.response and seen[other] == axis.response), None)
        if twin:
            document.fault((*at, "response"), f"is the same channel as that of axis {twin}", "give each axis its own")
        seen[name] = axis.response
    for at, channel in places:
        if channel is not None:
            _channel(document, at, channel, alone)
    if all(axis.response is None for axis in channels.axes.values()):
        document.fault(("channels", "axes"), "no axis has a response", "give at least one axis a `response`")


def _channel(document: Document, at: Loc, channel: Channel, alone: bool) -> None:
    if alone and all(getattr(channel, word) is None for word in ("name", "column", "dataset", "index", "file")):
        document.fault(at, "names no channel", "give a header text, or `column`, `dataset` or `index`")
    if channel.column is not None and channel.column < 1:
        document.fault((*at, "column"), f"there is no column {channel.column}", "columns count from 1")
    if channel.unit is not None:
        _unit(document, (*at, "unit"), channel.unit)


def _unit(document: Document, at: Loc, unit: str) -> None:
    try:
        units.factor(unit)
    except InputError as error:
        document.fault(at, error.message, error.remedy)


def _model(document: Document, items: tuple[str | Choice, ...], earlier: Earlier) -> None:
    if not items:
        document.fault(("model",), "the model has no block", "list at least one, see `pzt-ident list blocks`")
    folders: dict[str, str] = {}
    operators = [word for word in blocks.usable() if not blocks.is_effect(word)]
    for i, item in enumerate(items):
        word, at = word_of(item), document.reach(("model", i, "name"))
        if word not in blocks:
            document.fault(at, f"unknown block {word!r}", nearest(word, operators))
            continue
        folder = blocks.folder(word)
        if blocks.is_effect(word):
            document.fault(at, f"{word!r} is an effect", f"move it to `effects: [{word}]`")
        elif folder in folders:
            message = f"{word!r} beside {folders[folder]!r}: two blocks of {folder}"
            document.fault(at, message, "keep one of the two")
        elif not isinstance(item, str):
            _settings(document, ("model", i), item, blocks[word].formed(item.settings).make)
        folders[folder] = word


def _plugins(document: Document, files: tuple[str, ...], earlier: Earlier) -> None:
    for i, file in enumerate(files):
        if not document.plugins:
            document.fault(("plugins", i), f"{file} would run as code", "read it, then add --plugins to the command")
            continue
        path = document.folder / file
        with _noted(document, ("plugins", i), str(path)):
            plug(path)
    for i, word in enumerate(Path(file).stem for file in files):
        if document.plugins and word in blocks:
            with _noted(document, ("plugins", i)):
                check_loaded(blocks[word], blocks)


@contextmanager
def _noted(document: Document, at: Loc, known: str = "") -> Iterator[None]:
    """An error becomes a fault at a place, with where it was found unless that is known."""
    try:
        yield
    except InputError as error:
        where = "" if error.where in ("", known) else f"{error.where}: "
        document.fault(at, where + error.message, error.remedy)


def _rule_out(document: Document, words: tuple[str, ...], earlier: Earlier) -> None:
    for i, word in enumerate(words):
        if word not in blocks.effects():
            document.fault(("rule_out", i), f"unknown effect {word!r}", nearest(word, blocks.effects()))
        elif word in earlier.get("effects", ()):
            document.fault(("rule_out", i), f"{word!r} is among the `effects` too", "keep it in one of the two")


def _effects(document: Document, words: tuple[str, ...], earlier: Earlier) -> None:
    chosen = blocks.formed(earlier.get("model", ()))
    terms = {declared.effect for block in chosen for declared in block.parameters().values() if declared.effect}
    known = terms | set(blocks.effects())
    for i, word in enumerate(words):
        at: Loc = ("effects", i)
        if word in words[:i]:
            document.fault(at, f"duplicate effect {word!r}", "keep one of the two")
        elif word not in known and word in blocks:
            document.fault(at, f"{blocks[word].name!r} is not an effect", f"move it to `model: [{word}]`")
        elif word not in known:
            document.fault(at, f"unknown effect {word!r}", nearest(word, known))
        elif word in blocks and "model" in earlier and word not in terms and _is(word, "Term"):
            owners = [block.name for block in blocks if any(p.effect == word for p in block.parameters().values())]
            message = f"no block of this model has a term for {word!r}"
            document.fault(at, message, f"put one of these into `model`: {', '.join(owners)}")
        elif word in blocks and "channels" in earlier and len(earlier["channels"].axes) < 2 and _is(word, "Coupling"):
            document.fault(at, f"{word!r} needs a second axis", "give the other axis, at least its `drive`")


def _is(word: str, kind: str) -> bool:
    from pzt_ident.model import block

    return issubclass(blocks[word], getattr(block, kind))


def _shared(document: Document, names: tuple[str, ...], earlier: Earlier) -> None:
    if not {"model", "effects"} <= set(earlier):
        return
    with suppress(InputError):  # a setting of a block, noted where it stands
        chosen = blocks.chain((*earlier["model"], *earlier["effects"]))
        known = [f"{block.name}.{word}" for block in chosen for word in block.parameters()]
        for i, name in enumerate(names):
            if name not in known:
                document.fault(("shared", i), f"unknown parameter {name!r}", nearest(name, known))


def _optimizers(document: Document, choices: tuple[Choice, ...], earlier: Earlier) -> None:
    if not choices:
        document.fault(("optimizers",), "no optimizer", "list at least one, see `pzt-ident list optimizers`")
    names = [choice.name for choice in choices]
    for i, choice in enumerate(choices):
        at: Loc = ("optimizers", i)
        if choice.name not in optimizers:
            named = document.reach((*at, "name"))
            document.fault(named, f"unknown optimizer {choice.name!r}", nearest(choice.name, optimizers.words()))
            continue
        if choice.name in names[:i]:
            document.fault(at, f"{choice.name!r} twice", "keep one; compare its settings in a job each")
        _settings(document, at, choice, optimizers[choice.name].make)


def _settings(document: Document, at: Loc, choice: Choice, made: Callable[..., Any]) -> None:
    for loc, error in _complaints(choice, made):
        document.fault((*at, *loc), error.message, error.remedy, at_key=error.message.startswith("unknown setting"))


def _complaints(choice: Choice, made: Callable[..., Any]) -> Iterator[tuple[Loc, InputError]]:
    """What is said to each setting by itself; to all of them together where each is right by itself."""
    silent = True
    for word, value in choice.settings.items():
        try:
            made(**{word: value})
        except InputError as error:
            if error.where == f"{choice.name}.{word}" or error.message.startswith("unknown setting"):
                silent = False
                yield (word,), error
    if silent:
        try:
            made(**choice.settings)
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
