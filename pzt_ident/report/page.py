"""The page: one HTML file that needs nothing else, no network and no script."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from pzt_ident.files import write_text
from pzt_ident.report import numbers
from pzt_ident.report.figures import Plate, write_page_figures
from pzt_ident.report.inline import inline
from pzt_ident.report.results import read_results
from pzt_ident.report.tables import make_tables, write_tables
from pzt_ident.report.words import findings, listed, verdict

if TYPE_CHECKING:
    from jinja2 import Template
    from markupsafe import Markup


def write_report(folder: Path) -> Path:
    """Write `report.html`, `tables/` and the SVG of each figure in `figures/` of a finished run's folder.

    Returns the path of the page, which is written last. Raises InputError where the folder holds no finished run.
    """
    results = read_results(folder)
    tables = make_tables(results)
    write_tables(tables, results.folder / "tables")
    drawn = write_page_figures(results, results.folder / "figures")
    sections: dict[str, list[tuple[Plate, Markup]]] = {}
    for plate, svg in drawn:
        sections.setdefault(plate.section, []).append((plate, inline(svg, plate.name)))
    page = template("template.html").render(
        results=results,
        result=results.result,
        tables=tables,
        figures=sections,
        verdict=verdict(results),
        misfits=list(results.misfit.get("axes", {}).values()),
        findings=findings(results),
        failed_simulations=sum(run["failed_simulations"] for run in results.result["runs"]),
        optimizers=listed(row["optimizer"] for row in results.result["league"]),
    )
    write_text(results.folder / "report.html", page)
    return results.folder / "report.html"


def template(name: str) -> Template:
    """A page of this folder, with the look that all of them share."""
    from jinja2 import Environment, StrictUndefined
    from markupsafe import Markup

    folder = files("pzt_ident.report")
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    css = Markup(folder.joinpath("page.css").read_text(encoding="utf-8"))
    environment.globals.update(zip=zip, css=css)
    environment.filters.update(quantity=numbers.quantity, count=numbers.count, number=numbers.number)
    return environment.from_string(folder.joinpath(name).read_text(encoding="utf-8"))
