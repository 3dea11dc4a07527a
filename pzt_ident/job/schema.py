"""The job file as a frozen, typed model. All its faults are reported at once, each with file, line, column, key, value
and remedy."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, ValidationError, ValidationInfo, field_validator

from pzt_ident.data.record import Source
from pzt_ident.errors import InputError, nearest
from pzt_ident.job import checks
from pzt_ident.job.chain import CachedChain, ChainParts
from pzt_ident.job.document import Document, Fault, reject
from pzt_ident.job.faults import add_faults, without
from pzt_ident.job.normalise import long_form
from pzt_ident.job.plugins import plug
from pzt_ident.job.sections import Channels, Choice, Item, Limits, Repeats, Setting, Stopping
from pzt_ident.model.contract import check_loaded
from pzt_ident.model.registry import blocks

if TYPE_CHECKING:
    from pzt_ident.model.chain import Chain


class Job(BaseModel):
    """What to identify from which records, and how. Made by `load_job` or `Job.from_text`.

    text: as the user wrote it. folder: the one that paths in the job are relative to.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    plugins: Annotated[
        tuple[str, ...], Field(description="Python files of your own: effects, optimizers, readers.")
    ] = ()
    name: Annotated[
        str,
        Field(pattern=r"^\w([\w .+-]*\w)?$", description="Results go to `results/NAME`; the file's name if not given."),
    ] = ""
    records: Annotated[tuple[Source, ...], Field(description="The measurements.")]
    channels: Annotated[Channels, Field(description="Which columns are time, drives and responses.")]
    model: Annotated[tuple[Item, ...], Field(description="Blocks: a hysteresis operator, alone or with mechanics.")]
    effects: Annotated[
        tuple[str, ...], Field(description="Effects beside the model, such as `creep` or `creep.voltage`.")
    ] = ()
    rule_out: Annotated[
        tuple[str, ...], Field(description="Effects that the rig cannot have: no diagnosis names them.")
    ] = ()
    shared: Annotated[tuple[str, ...], Field(description="Parameters with one value for all axes.")] = ()
    parameters: Annotated[
        dict[str, Setting],
        Field(description="Bounds or values of parameters, by name: `bouc_wen.gain`, of one axis `x.bouc_wen.gain`."),
    ] = {}
    optimizers: Annotated[
        tuple[Choice, ...], Field(description="The searches; all get the evaluations of the first.")
    ] = (Choice("pso"),)
    repeats: Annotated[Repeats, Field(description="Searches of each optimizer, from different random starts.")] = 1
    seed: Annotated[int, Field(ge=0, description="The same seed gives the same result.")] = 0
    polish: Annotated[bool, Field(description="Whether least squares go on from where a search ended.")] = True
    stop: Annotated[Stopping, Field(description="What ends a search before its evaluations are spent.")] = Stopping()
    limits: Annotated[Limits, Field(description="What a proposed drive may do.")] = Limits()

    _text: str = PrivateAttr("")
    _file: str = PrivateAttr("")
    _folder: Path = PrivateAttr(Path())
    _cached_chain: CachedChain = PrivateAttr(default_factory=CachedChain)

    @field_validator("*")
    @classmethod
    def _checked(cls, section: Any, info: ValidationInfo[Document]) -> Any:
        if check := checks.SECTIONS.get(info.field_name or ""):
            check(info.context, section, info.data)
        return section

    @classmethod
    def from_text(cls, text: str, folder: Path = Path(), file: str = "job.yaml", plugins: bool = False) -> Job:
        """Read a job from its YAML text. `file` names it in errors, and names a job without a name. With `plugins`, the
        files of code that it lists are loaded.

        Raises InputError that lists every fault.
        """
        document = Document(text, file, folder, plugins)
        job = cls._read(document)
        if job is None or document.faults:
            reject(file, document.faults)
        job._text, job._file, job._folder, job._cached_chain = text, file, folder, document.chain
        return job

    @contextmanager
    def placed(self) -> Iterator[None]:
        """An error inside about what the job says names its file, and the line of the key where there is one."""
        try:
            yield
        except InputError as error:
            if not self._file or error.where in {
                name for source in self.records for name in (source.file, source.name)
            }:
                raise
            raise self._placed(error) from None

    def _placed(self, error: InputError) -> InputError:
        document = Document(self._text, self._file)
        for loc in (tuple(error.where.split(".")), ("parameters", error.where)):
            if document.reach(loc) == loc:
                document.fault(loc, error.message, error.remedy)
                return document.faults[-1].error(self._file)
        where = ": ".join(filter(None, (self._file, error.where)))
        return InputError(error.message, where=where, remedy=error.remedy)

    @classmethod
    def _read(cls, document: Document) -> Job | None:
        """The job, or None with every fault added to the document."""
        if not isinstance(document.data, dict):
            kind = "empty" if document.data is None else "a list" if isinstance(document.data, list) else "one value"
            advice = "write `name: ...`, `records: ...` and so on"
            reject(document.file, [Fault(1, 1, "", f"the job is {kind}", advice)])
        return cls._validated(document, {"name": _folder_name(document.file)} | long_form(document))

    @classmethod
    def _validated(cls, document: Document, data: dict[str, Any]) -> Job | None:
        """The job, or None with every fault added to the document; what cannot be read is removed to check the rest."""
        try:
            return cls.model_validate_json(json.dumps(data), context=document)
        except ValidationError as error:
            add_faults(document, error, cls.model_json_schema())
            readable = without(data, [item["loc"] for item in error.errors()])
        with suppress(ValidationError):
            cls.model_validate_json(json.dumps(readable), context=document)
        return None

    @property
    def text(self) -> str:
        return self._text

    @property
    def folder(self) -> Path:
        return self._folder

    @property
    def chain(self) -> Chain:
        """Its blocks and effects in signal order; built once, while the job is checked."""
        return self._cached_chain.of(
            ChainParts.of((*self.model, *self.effects), self.channels.axes, self.shared, self.parameters)
        )

    @property
    def hash(self) -> str:
        """Eight hexadecimal digits that change with what the job says, not with its layout."""
        content = json.dumps(self.model_dump(mode="json"), sort_keys=True)
        return hashlib.sha256(content.encode()).hexdigest()[:8]

    def __hash__(self) -> int:
        return hash(self.hash)


def _folder_name(file: str) -> str:
    return re.sub(r"[^\w .+-]+", "-", Path(file).stem).strip(" .+-") or "job"


def load_job(path: Path, plugins: bool = False) -> Job:
    """Read a job file, see `Job.from_text`. Raises InputError that lists every fault, or says that there is no file."""
    path = Path(path)
    return Job.from_text(_text_of(path), path.parent, str(path), plugins)


def load_plugins(path: Path) -> None:
    """Load a Python file, or those that a job lists, whatever else is wrong with the job."""
    if path.suffix == ".py":
        plug(path)
        if path.stem in blocks:
            check_loaded(blocks[path.stem], blocks)
        return
    document = Document(_text_of(path), str(path), path.parent, plugins=True)
    Job._read(document)
    if faults := [fault for fault in document.faults if fault.key.startswith("plugins")]:
        reject(str(path), faults)
    if not document.data.get("plugins"):
        raise InputError("lists no `plugins`", where=str(path), remedy="give a job that does, or the Python file")


def _text_of(path: Path) -> str:
    if path.is_dir():
        raise InputError("is a folder", where=str(path), remedy=f"give the job file, such as {path / 'job.yaml'}")
    if not path.exists():
        job_files = [item.name for item in path.parent.glob("*.y*ml")] if path.parent.is_dir() else []
        remedy = nearest(path.name, job_files) if job_files else "`pzt-ident init DIR` writes a job to start from"
        raise InputError("no such file", where=str(path), remedy=remedy)
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise InputError(error.strerror or str(error), where=str(path), remedy="make it readable") from None
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = raw[: error.start].rpartition(b"\n")
        line, column = raw.count(b"\n", 0, error.start) + 1, len(before[2]) + 1
        message = f"byte 0x{raw[error.start]:02x} is not UTF-8"
        reject(str(path), [Fault(line, column, "", message, "save the file as UTF-8")])
