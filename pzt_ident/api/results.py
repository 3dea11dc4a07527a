"""The identified model in a folder of results."""

from __future__ import annotations

from pathlib import Path

from pzt_ident.api.exporting import A_RESULT, of_fit, of_improvement, of_json
from pzt_ident.api.identification import load
from pzt_ident.control.export.identified import Identified
from pzt_ident.errors import InputError


def identified_in(path: Path, plugins: bool = False) -> Identified:
    """The model of a folder of `pzt-ident run`, `improve` or `Fit.save`, or of an exported JSON.

    Raises InputError where there is none.
    """
    if path.is_file():
        return of_json(path)
    if (path / "improvement.json").is_file():
        return of_improvement(path, plugins)
    if not (path / "result.json").is_file():
        raise InputError("holds no result", where=str(path), remedy=A_RESULT)
    return of_fit(load(path, plugins=plugins))
