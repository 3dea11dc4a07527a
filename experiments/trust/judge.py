"""Whether what a command said of a malformed input is a sentence that helps, and whether it left anything behind."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from experiments.trust.bench import Ended

PYTHON = re.compile(r"Traceback|--debug|\b[A-Z]\w*(Error|Exception|Warning)\b|\bobject at 0x|NoneType|Warning:")
PLACE = re.compile(r":\d+:\d+:|\b(line|row|rows|column|columns|sheet|dataset|field|fields|header|byte)\b|\w+\.\w+:")


def faults_of(ended: Ended, files: Iterable[str], value: str = "") -> Iterator[str]:
    """What is wrong with a refusal: nothing where it names one of the files, a place, the value and the remedy, in
    words and not in Python's."""
    message = ended.message
    if ended.code is None:
        yield message
        return
    if ended.code != 2:
        yield f"exit code {ended.code}"
    if PYTHON.search(message):
        yield f"Python: {PYTHON.search(message)[0]}"  # type: ignore[index]
    if not any(file in message for file in files):
        yield "names no file"
    if value and value not in message:
        yield f"does not show {value!r}"
    if not re.search(r"\n  \S", message) and ended.code == 2:
        yield "names no remedy"
    if len(message) > 4000 or max(map(len, message.splitlines()), default=0) > 600:
        yield "is no sentence: too long"
    if not message.isprintable() and any(not (letter.isprintable() or letter == "\n") for letter in message):
        yield "has letters that no terminal shows"


def files_in(folder: Path) -> dict[str, int]:
    """Every path below a folder with its size."""
    return {str(path.relative_to(folder)): path.lstat().st_size for path in folder.rglob("*") if not path.is_dir()}
