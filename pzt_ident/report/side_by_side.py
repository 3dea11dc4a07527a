"""Several results on one page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pzt_ident.data.notation import number, quantity, unit
from pzt_ident.files import write_text
from pzt_ident.report.page import POINTS, rendered, stairs
from pzt_ident.report.tables import Cell, Table, table, write_tables
from pzt_ident.report.traces import packed
from pzt_ident.report.words import listed, together, verdict
from pzt_ident.run.results import Results, read_folder


def write_side_by_side(folders: Sequence[Path], page: Path) -> Path:
    """Write the results of these folders as one page, and its tables into a folder of the same name beside it.

    Models of the same samples are shown in the same figures. Raises InputError where a folder holds no result.
    """
    results = dict(zip(labels(folders), map(read_folder, folders), strict=True))
    tables = {made.name: made for made in (summary(results), parameters(results))}
    write_tables(tables, page.with_suffix(""))
    improved = {name: own for name, own in results.items() if own.improvement}
    drawn = [stairs(own, f"stairs-{place}") | {"title": name} for place, (name, own) in enumerate(improved.items())]
    models = {name: own.traces for name, own in results.items()}
    content = {"records": packed(models, POINTS[0]), "floors": shared_floors(results), "stairs": drawn}
    verdicts = {name: verdict(own) for name, own in results.items()}
    words: dict[str, Any] = {"results": results, "tables": tables, "stairs": drawn, "verdicts": verdicts}
    write_text(page, rendered("side_by_side.html", "Side by side", content, lead=lead(results), **words))
    return page


def labels(folders: Sequence[Path]) -> list[str]:
    """The folders' last names, as many as it takes to tell them apart."""
    parts = [folder.resolve().parts for folder in folders]
    for count in range(1, max(map(len, parts)) + 1):
        found = ["/".join(own[-count:]) for own in parts]
        if len(set(found)) == len(found):
            return found
    return [f"{place}: {folder.name}" for place, folder in enumerate(folders, start=1)]


def lead(results: dict[str, Results]) -> str:
    """Which result leaves the least, on records the fit never saw where all have such."""
    use = "identify" if any(own.rmse["validate"] is None for own in results.values()) else "validate"
    if len({(own.unit, *own.units) for own in results.values()}) > 1:
        return "The responses are of different axes or in different units: their errors cannot be ranked."
    best = min(results, key=lambda name: results[name].rmse[use] or 0.0)
    where = "on records the fit never saw" if use == "validate" else "on the records it was fitted to"
    size = f"{quantity(results[best].rmse[use], results[best].unit, 3)} RMS{together(results[best].units)}"
    return f"{best} leaves least {where}: {size}."


def shared_floors(results: dict[str, Results]) -> dict[str, float | None]:
    """The noise floor of each axis on which the results agree, in its unit."""
    found: dict[str, set[tuple[str, float | None]]] = {}
    for own in results.values():
        for axis, floor in own.floors.items():
            found.setdefault(axis, set()).add((own.units[axis], floor))
    return {axis: next(iter(pairs))[1] for axis, pairs in found.items() if len(pairs) == 1}


def summary(results: dict[str, Results]) -> Table:
    """One row a result: what it leaves, and what that cost where it was searched for."""
    rows = [
        {
            "result": name,
            "job": own.name,
            **own.rmse,
            "unit": own.unit,
            "axes": f"{listed(own.units)}{' together' * (len(own.units) > 1)}",
            "noise_floor": own.floor or None,
            "run": own.result["best"]["run"] if own.result else "",
            "seconds": own.result["best"]["seconds"] if own.result else None,
            "effects": ", ".join(own.improvement.get("effects", ())),
        }
        for name, own in results.items()
    ]
    cells: dict[str, Cell] = {
        "result": lambda row: row["result"],
        "job": lambda row: row["job"],
        "identify": lambda row: number(row["identify"]),
        "validate": lambda row: number(row["validate"]),
        "noise floor": lambda row: number(row["noise_floor"], 3),
        "unit": lambda row: unit(row["unit"]) or "1",
        "of axis": lambda row: row["axes"],
        "best run": lambda row: row["run"],
        "time [s]": lambda row: number(row["seconds"], 3),
        "effects added": lambda row: row["effects"],
    }
    return table("results", rows, cells, {"result", "job", "unit", "of axis", "best run", "effects added"}, {})


def parameters(results: dict[str, Results]) -> Table:
    """One row a parameter, one column a result."""
    values = {name: own.parameters for name, own in results.items()}
    names = dict.fromkeys(key for found in values.values() for key in found)
    rows = [
        {
            "parameter": key,
            "unit": next(found[key]["unit"] for found in values.values() if key in found),
            **{name: found.get(key, {}).get("value") for name, found in values.items()},
        }
        for key in names
    ]
    cells: dict[str, Cell] = {"parameter": lambda row: row["parameter"], "unit": lambda row: unit(row["unit"])}
    cells |= {name: lambda row, name=name: number(row[name], 5) for name in results}  # type: ignore[misc]
    return table("parameters", rows, cells, {"parameter", "unit"}, {})
