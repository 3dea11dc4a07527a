"""The page: one HTML file that needs nothing else and loads nothing."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pzt_ident.data import notation as numbers
from pzt_ident.data.notation import listed
from pzt_ident.data.over_axes import together
from pzt_ident.files import plain, write_text
from pzt_ident.report.figures import Plate, write_page_figures
from pzt_ident.report.inline import inline
from pzt_ident.report.tables import make_tables, write_tables
from pzt_ident.report.traces import packed
from pzt_ident.report.words import findings, verdict
from pzt_ident.run.events import step_name
from pzt_ident.run.results import Results, read_folder

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup

LARGEST = 295_000  # bytes; where the page would be larger, its signals are thinned
POINTS = (7000, 4000, 2000)  # of all records together
MODULES = ("parts.js", "signals.js", "plane.js", "explorer.js", "staircase.js", "report.js")


def write_report(folder: Path) -> Path:
    """Write `report.html`, `tables/` and the SVG of each figure in `figures/` of a finished run, diagnosis or
    improvement.

    Returns the path of the page, which is written last. Raises InputError where the folder holds no result.
    """
    results = read_folder(folder)
    tables = make_tables(results)
    write_tables(tables, results.folder / "tables")
    drawn = write_page_figures(results, results.folder / "figures")
    sections: dict[str | None, list[tuple[Plate, Markup]]] = {}
    for plate, svg in drawn:
        sections.setdefault(plate.section, []).append((plate, inline(svg, plate.name)))
    words = {
        "results": results,
        "result": results.result,
        "tables": tables,
        "figures": sections,
        "together": together(results.units),
        "verdict": verdict(results),
        "misfits": list(results.misfit.get("axes", {}).values()),
        "findings": findings(results),
        "failed_simulations": sum(run["failed_simulations"] for run in results.result.get("runs", ())),
        "optimizers": listed(row["optimizer"] for row in results.result["league"]) if results.result else "",
    }
    content = {"floors": results.floors, "stairs": [stairs(results, "stairs")] if results.improvement else []}
    page = ""
    for points in POINTS:
        content["records"] = packed(results.models, points)
        page = rendered("report.html", results.name, content, **words)
        if len(page.encode()) < LARGEST:
            break
    write_text(results.folder / "report.html", page)
    return results.folder / "report.html"


def stairs(results: Results, place: str) -> dict[str, Any]:
    """The steps of an improvement as the page draws them, into the element with the id `place`."""
    found = results.improvement
    steps = [{"name": step_name(step), **step["rmse"]} for step in found["steps"]]
    said = {"unit": numbers.unit(found["unit"]) or "1", "together": together(results.units)}
    return {"place": place, "steps": steps, "floor": found["floor"], **said}


def rendered(name: str, title: str, content: dict[str, Any], **words: Any) -> str:
    """A page of this folder with the look and the scripts that all of them share; `content` is what these draw."""
    from markupsafe import Markup

    data = json.dumps(plain(content), separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    scripts = [web("uplot/uPlot.iife.min.js"), module()]
    allowed = " ".join(f"'sha256-{base64.b64encode(hashlib.sha256(s.encode()).digest()).decode()}'" for s in scripts)
    css = "\n".join(web(sheet) for sheet in ("page.css", "plots.css", "uplot/uPlot.min.css"))
    return (
        environment()
        .get_template(name)
        .render(
            title=title,
            content=Markup(data),
            scripts=[Markup(script) for script in scripts],
            allowed=Markup(allowed),
            css=Markup(css),
            **words,
        )
    )


def web(name: str) -> str:
    return files("pzt_ident.report").joinpath("web", name).read_text(encoding="utf-8")


def module() -> str:
    """The page's modules as one: without what they import from each other and export, comments and indents."""
    whole = "\n".join(web(name) for name in MODULES)
    return re.sub(
        r"^import .*;\n|^export (?=async|function|class|const)|^ *(//.*|/\*\*[^/]*\*/)\n|^ +",
        "",
        whole,
        flags=re.MULTILINE,
    )


@cache
def environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    loader = PackageLoader("pzt_ident", "report")
    made = Environment(loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    made.globals.update(zip=zip)
    made.filters.update(quantity=numbers.quantity, count=numbers.count, number=numbers.number)
    made.filters.update(percent=numbers.percent, spelled=numbers.spelled)
    return made
