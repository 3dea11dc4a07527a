"""The demonstration: a measurement of a virtual stage, simulated by code that shares nothing with the package, in which
two effects are hidden."""

from __future__ import annotations

import json
import os
import sys
from importlib.resources import files
from pathlib import Path
from typing import Any

HIDDEN = "hidden.json"


def write_demo(folder: Path) -> Path:
    """Write the records and the job, which has no effects, into a folder; returns the path of the job.

    Raises InputError, and writes nothing, where one of the files exists already.
    """
    from pzt_ident.job.example import write_shipped

    return write_shipped("demo", folder, without=(HIDDEN,))[0]


def hidden() -> list[dict[str, Any]]:
    """The truth, which is not in the job: effect, strength and unit of every effect in the measurement."""
    return list(json.loads(files("pzt_ident.job").joinpath("examples", "demo", HIDDEN).read_text(encoding="utf-8")))


def show_in_browser(page: Path | str) -> bool:
    """Open a file or an address in the user's browser; False where there is none with a window."""
    import webbrowser

    windows = sys.platform in ("darwin", "win32") or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return bool(windows) and webbrowser.open(page if isinstance(page, str) else page.resolve().as_uri())
