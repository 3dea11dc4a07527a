"""The files of a step that the page gives away."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from pzt_ident.errors import InputError, nearest
from pzt_ident.files import write_text
from pzt_ident.job.edit import edited
from pzt_ident.workbench.session import Session
from pzt_ident.workbench.session_results import gathered

PLACES = {
    "job.yaml": "job.yaml",
    "result.json": "run/result.json",
    "history.csv": "run/history.csv",
    "signals.nc": "run/signals.nc",
    "residuals.json": "run/residuals.json",
    "diagnosis.json": "diagnosis/diagnosis.json",
    "next_experiment.csv": "diagnosis/next_experiment.csv",
    "drive.csv": "control/drive.csv",
    "control.csv": "control/control.csv",
    "control.json": "control/control.json",
    "tracking.svg": "control/tracking.svg",
    "tracking.pdf": "control/tracking.pdf",
}
"""Files of a step by the name under which they are given."""

FIGURES = "figures.zip"
FOLDERS = {FIGURES: "figures", "tables.zip": "tables"}
"""Folders of a report, packed when they are asked for."""


def names(session: Session) -> list[str]:
    """Of all that can be had of the current step."""
    if not session.at:
        return []
    step = session.step()
    present = [name for name, place in PLACES.items() if (step / place).exists()]
    return present + (list(FOLDERS) if (step / "run" / "result.json").exists() else [])


def path_of(session: Session, name: str) -> Path:
    """The file of a name; tables are made first. Raises InputError for what is not there."""
    present = names(session)
    if name not in present:
        raise InputError(f"{name!r} cannot be had of this step", remedy=nearest(name, present) if present else "")
    step = session.step()
    if name in FOLDERS:
        return packed_folder(session, name)
    if name == "job.yaml":
        job, path = session.job(), step / "job-to-take.yaml"
        write_text(path, edited(job, job.effects, session.root))
        return path
    return step / PLACES[name]


def packed_folder(session: Session, name: str) -> Path:
    """Figures as PDF and SVG at two widths, as they were drawn, or tables as CSV and LaTeX, in an archive."""
    from pzt_ident.report.tables import make_tables, write_tables
    from pzt_ident.run.results import read_folder

    run = gathered(session)
    if name != FIGURES:
        write_tables(make_tables(read_folder(run)), run / FOLDERS[name])
    return archive(run / FOLDERS[name], session.step() / name)


def archive(folder: Path, path: Path) -> Path:
    """A folder as a zip file."""
    with tempfile.TemporaryDirectory(dir=path.parent) as scratch:
        packed = shutil.make_archive(str(Path(scratch) / "packed"), "zip", folder)
        Path(packed).replace(path)
    return path
