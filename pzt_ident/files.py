"""Files that are whole or not there: written beside, then renamed; and the folder for what can be made again."""

from __future__ import annotations

import atexit
import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from pzt_ident.errors import DamagedError


@contextmanager
def replaced(path: Path, lasting: bool = False) -> Iterator[Path]:
    """A temporary path beside `path` that takes its place when the block ends without an error. lasting: once it is on
    the disk, for what cannot be made again after a power cut.

    An OSError names `path`.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".tmp")
    os.close(handle)
    beside = Path(name)
    try:
        yield beside
        beside.chmod(0o644)
        if lasting:
            with beside.open("rb+") as file:
                os.fsync(file)
        os.replace(beside, path)
    except OSError as error:
        error.filename = str(path)
        raise
    finally:
        beside.unlink(missing_ok=True)


def write_text(path: Path, text: str, lasting: bool = False) -> None:
    with replaced(path, lasting) as beside:
        beside.write_text(text, encoding="utf-8", errors="backslashreplace")  # a path need not be UTF-8


def write_bytes(path: Path, content: bytes) -> None:
    with replaced(path) as beside:
        beside.write_bytes(content)


def read_files(folder: Path) -> dict[str, bytes]:
    """The files of a folder and its folders, by their paths in it."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def write_files(folder: Path, files: Mapping[str, bytes]) -> None:
    for name, content in files.items():
        write_bytes(folder / name, content)


def write_columns(path: Path, columns: Mapping[str, Any]) -> None:
    """Arrays under their headers as CSV that gives the same numbers again."""
    rows = zip(*(values.tolist() for values in columns.values()), strict=True)
    header = ",".join(f'"{name}"' if "," in name else name for name in columns)
    write_text(path, "\n".join([header, *(",".join(map(repr, row)) for row in rows)]) + "\n")


def write_json(path: Path, content: Any, lasting: bool = False) -> None:
    """NaN and infinity become null: JSON has no words for them."""
    write_text(path, json.dumps(plain(content), indent=2, allow_nan=False) + "\n", lasting)


DIGEST = "digest"


def write_sealed(path: Path, content: Mapping[str, Any], lasting: bool = False) -> dict[str, Any]:
    """Write a JSON object with the digest of what is in it, and return it: `read_sealed` finds every change of it."""
    facts = plain({key: value for key, value in content.items() if key != DIGEST})
    facts[DIGEST] = _digest(facts)
    write_json(path, facts, lasting)
    return dict(facts)


def read_sealed(path: Path, *keys: str) -> dict[str, Any]:
    """A JSON object, less its digest; one that was written without a digest is taken as it is.

    keys: those that it must have. Raises DamagedError where it is not as it was written.
    """
    try:
        content = json.loads(path.read_bytes().decode("utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise damaged(path, "cannot be read" if isinstance(error, OSError) else "is no JSON") from None
    if not isinstance(content, dict):
        raise damaged(path, "is no JSON object")
    written = content.pop(DIGEST, None)
    if written is not None and written != _digest(content):
        raise damaged(path, "is not as it was written")
    if missing := [key for key in keys if key not in content]:
        raise damaged(path, f"has no {missing[0]!r}")
    return content


def _digest(facts: Mapping[str, Any]) -> str:
    return sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()


def digest_of(path: Path) -> str:
    """SHA-256 of a file. Raises DamagedError where it cannot be read."""
    try:
        return sha256(path.read_bytes()).hexdigest()
    except OSError:
        raise damaged(path, "cannot be read") from None


def check_digest(path: Path, digest: str | None) -> None:
    """Raises DamagedError where a file is not the one of which this is the SHA-256."""
    if digest_of(path) != digest:
        raise damaged(path, "is not as it was written")


def damaged(path: Path, how: str) -> DamagedError:
    remedy = f"`pzt-ident resume {path.parent}` makes it again where it can"
    return DamagedError(f"is damaged: it {how}", where=str(path), remedy=remedy)


def plain(content: Any) -> Any:
    if isinstance(content, dict):
        return {str(key): plain(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [plain(value) for value in content]
    if hasattr(content, "tolist"):
        return plain(content.tolist())
    if isinstance(content, float) and (content != content or abs(content) == float("inf")):
        return None
    return content


@contextmanager
def temporary_files_in(folder: str) -> Iterator[None]:
    """What is made inside as a temporary file or folder of this process lies in `folder`."""
    before, tempfile.tempdir = tempfile.tempdir, folder
    try:
        yield
    finally:
        tempfile.tempdir = before


@cache
def cache_folder() -> Path:
    """$PZT_IDENT_CACHE, else the user's cache folder, else one for this process and those that it starts."""
    home = os.environ.get("PZT_IDENT_CACHE") or os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    try:
        chosen = Path(home).expanduser() / "pzt_ident"
        chosen.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=chosen).close()
    except (OSError, RuntimeError):  # the latter where nobody is at home
        chosen = Path(tempfile.mkdtemp(prefix="pzt_ident-")) / "pzt_ident"
        chosen.mkdir()
        atexit.register(shutil.rmtree, chosen.parent, ignore_errors=True)
        os.environ["PZT_IDENT_CACHE"] = str(chosen.parent)
        for library in ("NUMBA_CACHE_DIR", "MPLCONFIGDIR"):  # they need one too
            os.environ.setdefault(library, str(chosen))
    return chosen
