"""The report as one self-contained HTML file that loads nothing else."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Collection
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pzt_ident.atlas.href import anchor
from pzt_ident.atlas.words import Word
from pzt_ident.data import notation as numbers
from pzt_ident.data.notation import listed
from pzt_ident.data.over_axes import together
from pzt_ident.files import cache_folder, plain, write_text
from pzt_ident.report.figures import Plate, write_page_figures
from pzt_ident.report.inline import inline
from pzt_ident.report.sentences import findings, headline, next_step, verdict
from pzt_ident.report.spectra import printed_spectra
from pzt_ident.report.tables import Table, make_tables, write_tables
from pzt_ident.report.traces import packed
from pzt_ident.report.words import COLUMNS, atlas_beside, coded, linked, named, place_of, without_links
from pzt_ident.run.events import step_name
from pzt_ident.run.results import Results, read_folder

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup

LARGEST = 295_000  # bytes of the page; above that its signals are thinned further
POINTS = (7000, 4000, 2000)  # samples of all records together, tried in this order
MODULES = (
    "parts",
    "signals",
    "scale",
    "colours",
    "curves",
    "plot",
    "gestures",
    "legend",
    "figure",
    "scenes",
    "explorer",
    "staircase",
    "report",
)


def write_report(folder: Path, static: bool = True) -> Path:
    """Write `report.html`, `tables/` and the SVG of each static figure in `figures/` for a finished run, diagnosis or
    improvement. static: whether there are static figures, which take twenty times as long as all else.

    Returns the path of the page, which is written last. Raises InputError if the folder holds no result.
    """
    results = read_folder(folder)
    tables = make_tables(results)
    write_tables(tables, results.folder / "tables")
    variables = _template_variables(results, tables, _figures_by_section(results) if static else {})
    variables["static"] = static
    words = variables["words"]
    stairs = [staircase(results, "stairs", words)] if results.improvement or results.result else []
    content = {"floors": results.floors, "stairs": stairs, "spectra": printed_spectra(results.traces)}
    page = ""
    for points in POINTS:
        content["records"] = packed(results.models, points)
        page = rendered("report.html", results.name, content, stairs=bool(stairs), **variables)
        if len(page.encode()) < LARGEST:
            break
    write_text(results.folder / "report.html", page)
    return results.folder / "report.html"


def _figures_by_section(results: Results) -> dict[str | None, list[tuple[Plate, Markup]]]:
    """The static figures of the page, written to `figures/` and as elements of the page."""
    sections: dict[str | None, list[tuple[Plate, Markup]]] = {}
    for plate, svg in write_page_figures(results, results.folder / "figures"):
        sections.setdefault(plate.section, []).append((plate, inline(svg, plate.name)))
    return sections


def _template_variables(results: Results, tables: dict[str, Table], figures: dict[str | None, Any]) -> dict[str, Any]:
    (first, reasons), following = headline(verdict(results)), next_step(results)
    remarks = [*reasons, *findings(results)]
    return {
        "verdict": first,
        "next_step": following,
        "findings": remarks,
        "words": named([first, following, *remarks], tables),
        "atlas": atlas_beside(results.folder),
        "results": results,
        "result": results.result,
        "tables": tables,
        "figures": figures,
        "together": together(results.units),
        "misfits": list(results.misfit.get("axes", {}).values()),
        "failed_simulations": sum(run["failed_simulations"] for run in results.result.get("runs", ())),
        "optimizers": listed(row["optimizer"] for row in results.result["league"]) if results.result else "",
    }


def staircase(results: Results, place: str, words: Collection[Word]) -> dict[str, Any]:
    """What the page's script draws of the steps of an improvement, or of a single run, into the element with the id
    `place`."""
    if improvement := results.improvement:
        names = list(map(step_name, improvement["steps"]))
        steps = [
            {"name": name, "href": place_of(name, words), **step["rmse"]}
            for name, step in zip(names, improvement["steps"], strict=True)
        ]
        unit, floor = improvement["unit"], improvement["floor"]
    else:
        steps, unit, floor = [{"name": "as given", **results.rmse}], results.unit, results.floor
    axis = {"unit": numbers.unit(unit) or "1", "together": together(results.units)}
    return {"place": place, "steps": steps, "floor": floor, **axis}


def rendered(name: str, title: str, content: dict[str, Any], **variables: Any) -> str:
    """The template `name` with styles and scripts inline; `content` (JSON) is what the scripts draw."""
    from markupsafe import Markup

    data = json.dumps(plain(content), separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    script = bundled_modules()
    allowed = f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'"
    css = "\n".join(web_file(sheet) for sheet in ("page.css", "plots.css", "report.css"))
    page = (
        environment()
        .get_template(name)
        .render(
            title=title,
            content=Markup(data),
            script=Markup(script),
            allowed=Markup(allowed),
            css=Markup(css),
            **variables,
        )
    )
    return page.encode("utf-8", "backslashreplace").decode()  # a path need not be UTF-8


def web_file(name: str) -> str:
    return files("pzt_ident.report").joinpath("web", name).read_text(encoding="utf-8")


def bundled_modules() -> str:
    """The page's JavaScript modules as one, without imports, exports, comments and indentation."""
    source = "\n".join(web_file(f"{name}.js") for name in MODULES)
    return re.sub(
        r"^import .*;\n|^export (?=async|function|class|const)|^ *(//.*|/\*\*[^/]*\*/)\n|^ +",
        "",
        source,
        flags=re.MULTILINE,
    )


@cache
def environment() -> Environment:
    from jinja2 import Environment, FileSystemBytecodeCache, PackageLoader, StrictUndefined

    env = Environment(
        loader=PackageLoader("pzt_ident", "report"),
        bytecode_cache=FileSystemBytecodeCache(str(cache_folder()), "%s.page"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    env.globals.update(zip=zip, anchor=anchor, linked_columns=COLUMNS)
    env.filters.update(linked=linked, coded=coded, without_links=without_links, listed=listed)
    env.filters.update(quantity=numbers.quantity, count=numbers.count, number=numbers.number)
    env.filters.update(percent=numbers.percent, spelled=numbers.spelled)
    return env
