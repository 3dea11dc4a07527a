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
from pathlib import Path
from typing import Any


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """A temporary path beside `path` that takes its place when the block ends without an error.

    An OSError names `path`.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".tmp")
    os.close(handle)
    beside = Path(name)
    try:
        yield beside
        beside.chmod(0o644)
        os.replace(beside, path)
    except OSError as error:
        error.filename = str(path)
        raise
    finally:
        beside.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    with replaced(path) as beside:
        beside.write_text(text, encoding="utf-8")


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


def write_json(path: Path, content: Any) -> None:
    """NaN and infinity become null: JSON has no words for them."""
    write_text(path, json.dumps(plain(content), indent=2, allow_nan=False) + "\n")


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
