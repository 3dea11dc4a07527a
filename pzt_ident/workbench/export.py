"""The model of a step for other programs, as an archive."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

from pzt_ident.errors import InputError
from pzt_ident.workbench.downloads import archive
from pzt_ident.workbench.session import Session


def exported(session: Session, form: dict[str, Any]) -> Path:
    """A file, or an archive of several. Raises InputError where the step has no result or the format is unknown."""
    from pzt_ident.api.controlled import written
    from pzt_ident.run.identified import read_identified

    step, to = session.step(), str(form["to"])
    if not (step / "run" / "result.json").exists():
        raise InputError("this step has no result yet", remedy="run it first")
    identified = read_identified(step / "run", session.plugins)
    folder = step / "export" / "files"
    shutil.rmtree(folder, ignore_errors=True)
    paths = written(identified, folder, to, str(form.get("precision", "double")), form.get("rate"))
    run, out = session.again(step / "run"), session.again(step / "export" / to)
    session.log(["pzt-ident", "export", run, "--to", to, "--out", out, *session.plugins_flag])
    if len(paths) == 1:
        return paths[0]
    return archive(folder, step / "export" / f"{identified.word}-{to}.zip")
