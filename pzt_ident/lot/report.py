"""The report on a lot as one self-contained HTML file, and a page a device that it leads to."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import quote

from pzt_ident.data.notation import alike, number, percent, unit
from pzt_ident.errors import InputError
from pzt_ident.files import write_text
from pzt_ident.lot.cells import odd_cells
from pzt_ident.lot.figures import plates
from pzt_ident.lot.identification import in_a_line
from pzt_ident.lot.outcome import Lot, read_lot
from pzt_ident.lot.sentences import far, findings, in_setup, lead, unfinished
from pzt_ident.lot.statistics import Quantity
from pzt_ident.lot.table import FOR_PARQUET, faults_in, folder_of, missing_in, read_devices, tables_in, write_table
from pzt_ident.report.figures import Plate, write_plate
from pzt_ident.report.inline import inline
from pzt_ident.report.page import environment as page_environment
from pzt_ident.report.page import web_file
from pzt_ident.report.style import COLUMN, PAGE
from pzt_ident.report.words import atlas_beside, named
from pzt_ident.run.events import Listen, nobody
from pzt_ident.run.place import HERE, Place

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup

    Figures = Mapping[str | None, list[tuple[Plate, Markup]]]  # by their sections

MOST_PAGES = 500
MOST_LINES = 2000
"""Devices in the table of the page: those that stand out first."""


class Served(NamedTuple):
    """What the workbench adds to the page: styles, the address of a module that keeps it up to date, and its words."""

    css: str
    module: str
    worded: Callable[[str], str]


def write_fleet_report(folder: Path, *, place: Place = HERE, listen: Listen = nobody) -> Path:
    """Write `report.html`, `figures/`, and the page of each device that has none, or of those that stand out where
    there are many; of a fleet that is not finished, too. Returns the page.

    Raises InputError where the folder holds no fleet.
    """
    if not place.shares_disk:
        raise InputError("draws on this machine", where="fleet report", remedy="write --on local:N")
    lot = read_lot(folder)
    write_table(folder, read_devices(folder))
    undrawn = draw_pages(lot, place, listen)
    for plate in plates(lot):
        write_plate(plate, COLUMN, ("svg", "pdf"), folder / "figures")
    drawn = figures(lot, lambda plate: write_plate(plate, PAGE, ("svg", "pdf"), folder / "figures")["svg"])
    write_text(folder / "report.html", page(lot, drawn, undrawn=undrawn))
    return folder / "report.html"


def figures(lot: Lot, draw: Callable[[Plate], bytes]) -> Figures:
    """The figures of the page by their sections. draw: a plate as SVG."""
    sections: dict[str | None, list[tuple[Plate, Markup]]] = {}
    for plate in plates(lot):
        sections.setdefault(plate.section, []).append((plate, inline(draw(plate), plate.name, plate.parts)))
    return sections


def draw_pages(lot: Lot, place: Place, listen: Listen) -> list[str]:
    """Draw the page of each device that needs one; returns a sentence for each that cannot be drawn, which is told."""
    shown = [row["device"] for row in lot.done]
    if len(shown) > MOST_PAGES:
        outside = {finding.device for finding in lot.findings}
        shown = [row["device"] for row in lot.done if row["device"] in outside or row["verdict"] != "adequate"]
        shown = shown[:MOST_PAGES]
    stale = {name: path for name in shown if not is_drawn(path := folder_of(lot.folder, name))}
    drawn = 0

    def tell(done: int) -> None:
        listen({"event": "pages", "of": len(stale), "done": done, "folder": ""})

    def note(name: str, result: Any) -> None:
        nonlocal drawn
        drawn += 1
        tell(drawn)

    tasks = ((name, (path,)) for name, path in stale.items())
    failed = place.run_all(draw_page, (), tasks, nobody, note) if stale else {}
    sentences = [f"{name} has no page: {in_a_line(failed[name])}" for name in stale if name in failed]
    for sentence in sentences:
        listen({"event": "undrawn", "said": sentence})
    return sentences


def is_drawn(folder: Path) -> bool:
    """Whether the page of a device is there and newer than its results."""
    page, row = folder / "report.html", folder / "device.json"
    return page.exists() and page.stat().st_mtime >= row.stat().st_mtime


def draw_page(tell: Any, folder: Path) -> None:
    """Entry of a worker: the page of a device, without the figures that take long."""
    from pzt_ident.report.page import write_report
    from pzt_ident.run.misfit import compare

    for results in (folder, folder / "improved"):
        if results.is_dir():
            compare(results, results)
            write_report(results, static=False)


def page(lot: Lot, figures: Figures, served: Served | None = None, undrawn: Sequence[str] = ()) -> str:
    """The report, or, where it is `served`, the same with the devices on one screen with what is said of them. undrawn:
    why devices have no page."""
    from markupsafe import Markup

    said = [*map(served.worded, findings(lot))] if served else [*unfinished(lot), *undrawn, *findings(lot)]
    outside, quantities = far(lot), [quantity_line(lot, item) for item in lot.quantities]
    names = [*lot.missing, *(fault for row in lot.done for fault in faults_in(row)), *(line[0] for line in quantities)]
    script = files("pzt_ident.lot").joinpath("lot.js").read_text(encoding="utf-8")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return (
        environment()
        .get_template("lot.html")
        .render(
            title=lot.statement["job_name"],
            content=Markup("{}"),
            script=Markup(script),
            allowed=Markup(f"'sha256-{digest}'" + " 'self'; connect-src 'self'" * bool(served)),
            css=Markup(web_file("page.css") + (served.css if served else "")),
            served=served,
            lot=lot,
            lead=lead(lot),
            findings=said,
            far=outside,
            words=named([*said, *(kind for _, kind, _ in outside), *names], {}),
            atlas=atlas_beside(lot.folder),
            effects=lot.missing,
            figures=figures,
            quantities=quantities,
            header=header(lot),
            tables=tables_in(lot.folder),
            for_parquet=FOR_PARQUET,
            taken_as_words=list(taken_as_words(lot)),
            lines=list(device_lines(lot)),
            page_of={row["device"]: page_of(lot, row["device"]) for row in lot.rows},
        )
    )


@cache
def environment() -> Environment:
    from jinja2 import ChoiceLoader, PackageLoader

    base = page_environment()
    assert base.loader
    return base.overlay(loader=ChoiceLoader([base.loader, PackageLoader("pzt_ident", "lot")]))


def page_of(lot: Lot, name: str, part: str = "") -> str:
    """Where the page of a device is, as a link; empty where there is none."""
    path = folder_of(lot.folder, name) / part / "report.html"
    return quote(path.relative_to(lot.folder).as_posix()) if path.exists() else ""


def quantity_line(lot: Lot, quantity: Quantity) -> list[str]:
    """Name, unit, median, spread, its share of the median, extremes, error of a single device, and of how many."""
    values = quantity.values[quantity.usable]
    relative = percent(quantity.spread / abs(quantity.median), 1) if quantity.usable.any() and quantity.median else "–"
    median, *ends = alike([quantity.median, values.min(), values.max()]) if values.size else ["–", "–", "–"]
    error = number(quantity.own_error, 2) if quantity.own_error else "–"
    cells = [median, number(quantity.spread, 2), relative, *ends, error]
    return [quantity.name, unit(quantity.unit) or "1", *cells, f"{values.size} of {quantity.present.sum()}"]


def header(lot: Lot) -> list[tuple[str, bool]]:
    """The headings of the table of devices, and which are above words."""
    words = ["verdict", *(["effects"] if lot.statement["improve"] else [])]
    shown = [(f"{quantity.name} [{unit(quantity.unit) or '1'}]", False) for quantity in lot.quantities]
    return [("device", True), *given_columns(lot).items(), *((word, True) for word in words), *shown]


def given_columns(lot: Lot) -> dict[str, bool]:
    """The columns that are known of the devices, and which are of words."""
    columns = dict.fromkeys((name for row in lot.rows for name in row["columns"]), False)
    return {name: any(isinstance(row["columns"].get(name), str) for row in lot.rows) for name in columns}


def taken_as_words(lot: Lot) -> Iterator[str]:
    """A sentence for each column of words of which most cells are numbers or dates: why."""
    devices = [row["device"] for row in lot.rows]
    for name in dict.fromkeys(name for row in lot.rows for name in row["columns"]):
        values = [row["columns"].get(name) for row in lot.rows]
        words = ["" if value is None else str(value) for value in values]
        if any(isinstance(value, str) for value in values) and (odd := odd_cells(words, ".,") or odd_cells(words)):
            yield f"{odd.sentence(name, devices)}."


def shown_devices(lot: Lot) -> set[str]:
    """The devices in the table of the page: all, or of many those that stand out and the first of the others."""
    far = [finding.device for finding in lot.findings]
    above = [row["device"] for row in lot.done if row["verdict"] != "adequate"]
    return {*list(dict.fromkeys([*far, *above, *(row["device"] for row in lot.done)]))[:MOST_LINES]}


def device_lines(lot: Lot) -> Iterator[dict[str, Any]]:
    """A line a device: its cells, and which of them are out of line."""
    columns = given_columns(lot)
    outside = {(finding.device, finding.quantity) for finding in lot.findings}
    shown = shown_devices(lot)
    place = {row["device"]: index for index, row in enumerate(lot.done)}
    for row in lot.rows:
        name, index = row["device"], place.get(row["device"])
        if index is None or name not in shown:
            continue
        found = ", ".join([*missing_in(row), *in_setup(row)])
        words = [row["verdict"], *([found] if lot.statement["improve"] else [])]
        values = [
            (
                number(quantity.values[index]),
                float(quantity.values[index]),
                (name, quantity.name) in outside,
                bool(quantity.usable[index]),
            )
            for quantity in lot.quantities
        ]
        known = [(_cell(row["columns"].get(column)), is_word) for column, is_word in columns.items()]
        improved = page_of(lot, name, "improved")
        yield {"device": name, "known": known, "words": words, "values": values, "improved": improved}


def _cell(value: Any) -> str:
    return "" if value is None else number(value) if isinstance(value, float) else str(value)
