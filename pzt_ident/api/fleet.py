"""One job on many devices, as an object."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pzt_ident.api.arguments import path_of, writable
from pzt_ident.api.identification import load
from pzt_ident.lot.outcome import Lot, read_lot
from pzt_ident.lot.table import folder_of, frame_of

if TYPE_CHECKING:
    import pandas as pd


class Fleet:
    """What a job came to on many devices; all of it is in `folder`."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._lot: Lot = read_lot(folder)

    @property
    def devices(self) -> pd.DataFrame:
        """A line a device: parameters with intervals of 95 %, errors, verdict, effects; units stand in the headings."""
        return frame_of(iter(self._lot.rows))

    @property
    def broken(self) -> dict[str, str]:
        """Why each device that could not be identified could not."""
        return {row["device"]: row["reason"] for row in self._lot.broken}

    @property
    def out_of_line(self) -> dict[str, list[str]]:
        """What is unusual about each device that is out of line, the furthest first."""
        sentences: dict[str, list[str]] = {}
        for finding in self._lot.findings:
            sentences.setdefault(finding.device, []).append(finding.sentence)
        return sentences

    def fit(self, device: str, plugins: bool = False) -> Any:
        """That of a device, as `pzt_ident.load` reads it. Raises InputError where it has none."""
        return load(self.results(device), plugins=plugins)

    def results(self, device: str) -> Path:
        """The folder of a device, for every command that takes one."""
        return folder_of(self.folder, device)

    def report(self, processes: int | None = None) -> Path:
        """Draw the report on all devices; returns the page."""
        from pzt_ident.lot.report import write_fleet_report
        from pzt_ident.run.place import Local

        with writable(self.folder):
            return write_fleet_report(self.folder, place=Local(processes))

    def __str__(self) -> str:
        return "\n".join(self._lot.sentences())

    __repr__ = __str__


def fleet(
    job: str | Path,
    devices: str | Path | Sequence[str | Path],
    out: str | Path,
    *,
    improve: bool = False,
    budget: float | None = None,
    on: str = "local",
    plugins: bool = False,
) -> Fleet:
    """Identify the model of a job file on every device, by the steps of `pzt-ident fleet`.

    devices: patterns of folders (`lot/*/`) or files (`lot/*.csv`), or tables with a column `file` or `folder` and what
    else is known of a device. out: the folder of results; what was done in it is not done again. improve: diagnose
    each, in `budget` seconds of work. on: where to run, such as `local:4` or `tcp://scheduler:8786`.

    Raises InputError where the job, a table or a pattern is wrong; devices with faults are `broken`.
    """
    from pzt_ident.job.schema import load_job
    from pzt_ident.lot.identify import fleet
    from pzt_ident.run.place import place_of

    patterns = [devices] if isinstance(devices, str | Path) else list(devices)
    names = [str(path_of(pattern, "devices")) + "/" * str(pattern).endswith("/") for pattern in patterns]
    folder, place = path_of(out, "out"), place_of(on)
    with writable(folder):
        return Fleet(
            fleet(load_job(path_of(job, "job"), plugins), names, folder, improve=improve, budget=budget, place=place)
        )
