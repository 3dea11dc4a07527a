"""A folder of results is written by one process at a time."""

from __future__ import annotations

import errno
import os
import platform
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from pzt_ident.errors import InputError

LOCK = ".lock"
HELD = (errno.EAGAIN, errno.EACCES, errno.EDEADLK)
DENIED = (errno.EACCES, errno.EPERM, errno.EROFS)
FAR = 2**30  # beyond the text of the file, which others read


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """No other process that asks for it works in the folder meanwhile. The system frees it where this one is killed.

    Raises InputError where another one does, and names it, or where the folder cannot be written into.
    """
    with lock_of(folder) as file:
        if not taken(file):
            file.seek(0)
            raise occupied(folder, file.read().strip())
        file.truncate(0)
        file.write(f"process {os.getpid()} on {platform.node()}\n")
        file.flush()
        yield


def lock_of(folder: Path) -> IO[str]:
    """The file that is locked. Raises InputError where the folder may not be written into."""
    try:
        return (folder / LOCK).open("a+", encoding="utf-8")
    except OSError as error:
        if error.errno not in DENIED:
            raise
        problem = f"cannot be written into: {(error.strerror or 'denied').lower()}"
        raise InputError(problem, where=str(folder), remedy="give another folder with --out") from None


def occupied(folder: Path, holder: str = "") -> InputError:
    """What is said where another process works in a folder."""
    remedy = "wait until it has ended, or give another folder with --out"
    return InputError(f"{holder or 'another process'} is at work in this folder", where=str(folder), remedy=remedy)


def taken(file: IO[str]) -> bool:
    """Whether this process has the file for itself; it is not asked for where the file system has no locks."""
    try:
        if sys.platform == "win32":
            import msvcrt

            file.seek(FAR)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno not in HELD
    return True
