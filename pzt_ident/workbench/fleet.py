"""A lot of devices beside a session: its page, kept up to date, and a session of each device."""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable, Mapping
from importlib.resources import files
from pathlib import Path
from shutil import copytree, ignore_patterns
from threading import Lock
from types import MappingProxyType
from typing import Any, NamedTuple

from pzt_ident.errors import InputError, nearest
from pzt_ident.files import write_text
from pzt_ident.job.edit import edited
from pzt_ident.job.schema import load_job
from pzt_ident.lot.outcome import Lot, read_lot
from pzt_ident.lot.table import CSV, PARQUET, folder_of
from pzt_ident.workbench.session import Session
from pzt_ident.workbench.wording import in_page_words

SEEN = ("fleet.json", "devices.json", "devices")  # what changes in the folder of a fleet as it goes on
DRAWN_ANEW = 20  # times what a drawing took, after which the figures of a running fleet are drawn again
STYLES = {"report": ("plots.css",), "workbench": ("fleet.css",)}
GIVEN = (CSV, PARQUET, "job.yaml")
NOT_OF_THE_RUN = ignore_patterns("improved", "device.json", "report.html", "figures", "tables")


class Figures(NamedTuple):
    """By section, drawn when the folder had this stamp; to be drawn again from the time `due` on."""

    stamp: str = ""
    drawn: Mapping[str | None, Any] = MappingProxyType({})
    due: float = 0.0


class Fleet:
    """The fleet in a folder, finished or not. key: of the address of its page, which cannot be guessed."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.key = folder, secrets.token_urlsafe(24)
        self._lock = Lock()
        self._known: dict[str, tuple[str, Any]] = {}
        self._drawing, self._figures = Lock(), Figures()

    @property
    def url(self) -> str:
        return f"/lot/{self.key}"

    @property
    def version(self) -> str:
        """Another one whenever there is more to be shown."""
        return f"{self._stamp} {self._figures.stamp}"

    @property
    def _stamp(self) -> str:
        paths = (self.folder / name for name in SEEN)
        return " ".join(str(path.stat().st_mtime_ns) if path.exists() else "" for path in paths)

    @property
    def begun(self) -> bool:
        return (self.folder / "devices.json").exists()

    @property
    def lot(self) -> Lot:
        """Raises InputError where the fleet has not been begun."""
        return self._once("lot", lambda: read_lot(self.folder))

    @property
    def facts(self) -> dict[str, Any]:
        """The version, and how many devices there are, are done and are broken; 0 before it has been begun."""
        lot = self.lot if self.begun else Lot(self.folder, {}, [])
        counts = {"of": len(lot.rows), "done": len(lot.done), "broken": len(lot.broken)}
        return {"version": self.version, "url": self.url} | counts

    @property
    def page(self) -> str:
        """The report on the lot for the workbench, whose atlas it leads to."""
        return self._once("page", self._drawn)

    def _once(self, name: str, make: Callable[[], Any]) -> Any:
        """What is made of the folder, made again once that has changed."""
        with self._lock:
            version = self.version
            if self._known.get(name, ("",))[0] != version:
                self._known[name] = version, make()
            return self._known[name][1]

    def _drawn(self) -> str:
        from pzt_ident.lot.report import Served, page

        css = "".join(_css(package, name) for package, names in STYLES.items() for name in names)
        html = page(read_lot(self.folder), self._figures.drawn, Served(css, "/web/fleet.js", in_page_words))
        return html.replace('href="#word-', 'target="_blank" href="/atlas#word-')

    def draw(self) -> None:
        """Draw the figures where they are old; those of a fleet that is running seldom."""
        from pzt_ident.lot.report import figures
        from pzt_ident.report.figures import render
        from pzt_ident.report.style import COLUMN

        if not self.begun or not self._drawing.acquire(blocking=False):
            return
        try:
            stamp, lot, begun = self._stamp, self.lot, time.monotonic()
            running = len(lot.done) + len(lot.broken) < len(lot.rows)
            if self._figures.stamp == stamp or (running and begun < self._figures.due):
                return
            drawn = figures(lot, lambda plate: render(plate, COLUMN, ("svg",))["svg"])
            now = time.monotonic()
            self._figures = Figures(stamp, drawn, now + DRAWN_ANEW * (now - begun))
        finally:
            self._drawing.release()

    def given(self, name: str) -> Path:
        """A file of the fleet. Raises InputError for any other."""
        path = self.folder / name
        if name not in GIVEN or not path.exists():
            raise InputError(f"{name!r} cannot be had of this lot")
        return path

    def session(self, name: str, root: Path, folder: Path, plugins: bool) -> Session:
        """The session of a device below `folder`; its first step is the device's run, as the fleet left it. Raises
        InputError for a device that was not identified."""
        rows = {row["device"]: row for row in self.lot.done}
        if name not in rows:
            broken = {row["device"]: row["reason"] for row in self.lot.broken}
            raise InputError(broken.get(name, f"unknown device {name!r}"), remedy=nearest(name, rows))
        home = folder_of(self.folder, name)
        session = Session(root, folder / f"{home.name} {rows[name]['key'][:8]}", plugins)
        if not session.steps:
            session.open(home / "job.yaml")
            session.keep(1, device=name)
            take_over(home, session.step(), plugins)
        return session


def take_over(home: Path, step: Path, plugins: bool) -> None:
    """Copy the results of a device into a step: its run, and the improvement with the job that it ended with."""
    from pzt_ident.run.misfit import compare

    copytree(home, step / "run", ignore=NOT_OF_THE_RUN)
    compare(step / "run", step / "run")
    if not (home / "improved").is_dir():
        return
    copytree(home / "improved", step / "improved", ignore=NOT_OF_THE_RUN)
    job = load_job(home / "improved" / "improved.yaml", plugins)
    write_text(step / "improved" / "improved.yaml", edited(job, job.effects, step / "improved"))


def to_adopt(session: Session) -> bool:
    """Whether the session of a device has an improvement that has not become steps yet."""
    step = session.folder / "steps" / "1"
    begun = len(session.steps) > 1 or (step / "diagnosis").exists()
    return not begun and (step / "improved" / "improvement.json").exists()


def _css(package: str, name: str) -> str:
    return files(f"pzt_ident.{package}").joinpath("web", name).read_text(encoding="utf-8")
