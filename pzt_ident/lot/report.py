"""The report on a lot as one self-contained HTML file, and a page a device that it leads to."""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import quote

import numpy as np

from pzt_ident.data.notation import listed, number, percent, spelled, unit
from pzt_ident.errors import InputError
from pzt_ident.files import write_text
from pzt_ident.lot.devices import Device
from pzt_ident.lot.figures import plates
from pzt_ident.lot.identify import in_a_line
from pzt_ident.lot.outcome import Lot, read_lot
from pzt_ident.lot.statistics import Difference, Quantity
from pzt_ident.lot.table import FOR_PARQUET, Row, folder_of, tables_in, write_table
from pzt_ident.report.figures import Plate, write_plate
from pzt_ident.report.inline import inline
from pzt_ident.report.page import environment as page_environment
from pzt_ident.report.page import web_file
from pzt_ident.report.style import COLUMN, PAGE
from pzt_ident.report.words import atlas_beside, named
from pzt_ident.run.collect import MOST_OF_THE_NOISE
from pzt_ident.run.events import Listen, nobody
from pzt_ident.run.place import HERE, Place

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup

    Figures = Mapping[str | None, list[tuple[Plate, Markup]]]  # by their sections

MOST_GROUPS = 4  # of which a sentence names each median
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
    write_table(folder, [Device(row["device"], {}, row["columns"]) for row in lot.rows])
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
    names = [name for row in lot.done for name in row["effects"]] + [line[0] for line in quantities]
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
            effects=lot.effects,
            figures=figures,
            quantities=quantities,
            header=header(lot),
            tables=tables_in(lot.folder),
            for_parquet=FOR_PARQUET,
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


def lead(lot: Lot) -> str:
    """The lot in a sentence."""
    done, total = len(lot.done), len(lot.rows)
    adequate = [row for row in lot.done if row["verdict"] == "adequate"]
    more = sum(bool(row["effects"]) for row in adequate)
    if not done:
        return f"None of {total} devices {'is done yet' if unfinished(lot) else 'could be identified'}."
    fit = [f"is adequate for {len(adequate) - more or 'none'} of {total} devices"]
    fit += [f"with effects added for {more} more"] * bool(more)
    fit += [f"fits {len(lot.ill_fitted)} worse than usual"] * bool(lot.ill_fitted)
    text = f"The model {listed(fit)}."
    if lot.odd:
        text += f" {len(lot.odd)} more {'is' if len(lot.odd) == 1 else 'are'} out of line."
    if lot.broken:
        text += f" {len(lot.broken)} could not be identified."
    return text


def unfinished(lot: Lot) -> list[str]:
    waiting = len(lot.rows) - len(lot.done) - len(lot.broken)
    return [f"{waiting} devices are not done: pzt-ident resume goes on with them."] if waiting else []


def findings(lot: Lot) -> Iterator[str]:
    """What a reader must know beside that."""
    above = lot.verdicts.get("above the noise", 0)
    if above and not lot.statement["improve"]:
        yield f"{above} are above the noise: the same command with --improve says why."
    coarse = [row["device"] for row in lot.done if row.get("step_change", 0.0) > MOST_OF_THE_NOISE]
    if coarse and not lot.statement["improve"]:
        yield (
            f"The step of the simulation costs {len(coarse)} of {len(lot.done)} devices more than a fifth of the noise:"
            " give the records of the job more `steps`."
        )
    for effect, names in lot.effects.items():
        yield f"{effect} is missing in {len(names)} of {len(lot.done)} devices ({percent(len(names) / len(lot.done))})."
    for trend in _distinct(lot.trends):
        quantity = next(quantity for quantity in lot.quantities if quantity.name == trend.quantity)
        sign = "grows" if trend.slope > 0 else "falls"
        column = re.search(r"\[(.+)\]", trend.column)
        per = unit(column[1]) if column else "unit"
        change = (
            f", by {number(abs(trend.slope / quantity.median) * 100, 2)}\u00a0% per {per}" if quantity.median else ""
        )
        yield f"{trend.quantity} {sign} with the {trend.column.partition(' [')[0]}{change}."
    for difference in lot.group_differences:
        if difference.clear:
            quantity = next(quantity for quantity in lot.quantities if quantity.name == difference.quantity)
            yield f"{quantity.name} differs by {difference.column}: {groups_of(difference, unit(quantity.unit))}."
    for names in lot.same_data:
        yield f"{listed(names)} have the same data: is one of them a copy?"
    undetermined = [
        quantity.name
        for quantity in lot.quantities
        if not quantity.one_sided and quantity.usable.sum() < np.isfinite(quantity.values).sum() / 2
    ]
    if undetermined:
        yield f"The data of most devices do not determine {listed(undetermined)}."


def groups_of(difference: Difference, shown: str) -> str:
    """The medians of the groups; of many groups that which stands out."""
    medians = [f"{word} {number(value)}" for word, value in difference.medians.items()]
    if len(medians) <= MOST_GROUPS:
        return f"{', '.join(medians)} {shown}".rstrip()
    furthest, usual = difference.medians[difference.furthest], difference.usual
    where = (
        f"{percent(abs(furthest / usual - 1))} {'above' if furthest > usual else 'below'}" if usual > 0 else "not at"
    )
    return f"{difference.furthest} is {where} the median of all, {number(furthest)} {shown}".rstrip()


def _distinct(trends: Iterable[Any]) -> list[Any]:
    """The clear trends, of each quantity the clearest."""
    first: dict[str, Any] = {}
    for trend in trends:
        if trend.clear:
            first.setdefault(trend.quantity, trend)
    return list(first.values())


def far(lot: Lot) -> list[tuple[str, str, str]]:
    """Devices out of line: first those whose parameters are, then those that the model does not fit; what and why."""
    why: dict[str, list[str]] = {}
    for finding in lot.findings:
        why.setdefault(finding.device, []).append(spelled(finding.sentence))
    rows = {row["device"]: row for row in lot.done}
    noisy = {name for name in lot.odd if all(finding.of_fit for finding in lot.findings if finding.device == name)}
    kinds = [(name, "noise" if name in noisy else _odd(rows[name])) for name in lot.odd]
    kinds += [(name, _misfit(rows[name])) for name in lot.ill_fitted]
    return [(name, kind, "; ".join(why[name])) for name, kind in kinds]


def _odd(row: Row) -> str:
    """What is known of a device that the model fits with unusual parameters."""
    return f"parameters, misses {listed(row['effects'])}" if row["effects"] else "parameters"


def _misfit(row: Row) -> str:
    """What is known of a device that the model does not fit."""
    if row["effects"]:
        return f"misses {listed(row['effects'])}"
    return f"may miss {listed(row['suspects'])}" if row["suspects"] else "fits worse"


def quantity_line(lot: Lot, quantity: Quantity) -> list[str]:
    """Name, unit, median, spread, its share of the median, extremes, error of a single device, and of how many."""
    values = quantity.values[quantity.usable]
    relative = percent(quantity.spread / abs(quantity.median), 1) if quantity.usable.any() and quantity.median else "–"
    ends = [number(values.min()), number(values.max())] if values.size else ["–", "–"]
    error = number(quantity.own_error, 2) if quantity.own_error else "–"
    cells = [number(quantity.median), number(quantity.spread, 2), relative, *ends, error]
    return [quantity.name, unit(quantity.unit) or "1", *cells, f"{values.size} of {len(lot.done)}"]


def header(lot: Lot) -> list[str]:
    """The headings of the table of devices."""
    columns = dict.fromkeys(name for row in lot.rows for name in row["columns"])
    shown = [f"{quantity.name} [{unit(quantity.unit) or '1'}]" for quantity in lot.quantities]
    return ["device", *columns, "verdict", *(["effects"] if lot.statement["improve"] else []), *shown]


def shown_devices(lot: Lot) -> set[str]:
    """The devices in the table of the page: all, or of many those that stand out and the first of the others."""
    far = [finding.device for finding in lot.findings]
    above = [row["device"] for row in lot.done if row["verdict"] != "adequate"]
    return {*list(dict.fromkeys([*far, *above, *(row["device"] for row in lot.done)]))[:MOST_LINES]}


def device_lines(lot: Lot) -> Iterator[dict[str, Any]]:
    """A line a device: its cells, and which of them are out of line."""
    columns = dict.fromkeys(name for row in lot.rows for name in row["columns"])
    outside = {(finding.device, finding.quantity) for finding in lot.findings}
    shown = shown_devices(lot)
    place = {row["device"]: index for index, row in enumerate(lot.done)}
    for row in lot.rows:
        name, index = row["device"], place.get(row["device"])
        if index is None or name not in shown:
            continue
        words = [row["verdict"], *([", ".join(row["effects"])] if lot.statement["improve"] else [])]
        values = [
            (
                number(quantity.values[index]),
                float(quantity.values[index]),
                (name, quantity.name) in outside,
                bool(quantity.usable[index]),
            )
            for quantity in lot.quantities
        ]
        known = [_cell(row["columns"].get(column)) for column in columns]
        improved = page_of(lot, name, "improved")
        yield {"device": name, "known": known, "words": words, "values": values, "improved": improved}


def _cell(value: Any) -> str:
    return "" if value is None else number(value) if isinstance(value, float) else str(value)
