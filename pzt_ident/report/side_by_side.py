"""Several results compared on one page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pzt_ident.data.notation import number, quantity, unit, with_error
from pzt_ident.diagnosis.ties import differ
from pzt_ident.files import write_text
from pzt_ident.report.page import POINTS, rendered, staircase
from pzt_ident.report.sentences import USE_NAMES, listed, together, verdict
from pzt_ident.report.tables import Cell, Table, table, write_tables
from pzt_ident.report.traces import packed
from pzt_ident.report.words import atlas_beside, named
from pzt_ident.run.results import Results, read_folder


def write_side_by_side(folders: Sequence[Path], page: Path) -> Path:
    """Write one page on the results of these folders, and its tables into a folder of the same name beside it.

    Models of the same samples share their figures. Raises InputError if a folder holds no result.
    """
    results = dict(zip(labels(folders), map(read_folder, folders), strict=True))
    tables = {table.name: table for table in (summary(results), parameters(results))}
    write_tables(tables, page.with_suffix(""))
    verdicts = {name: verdict(result) for name, result in results.items()}
    words = named(verdicts.values(), tables)
    improved = {name: result for name, result in results.items() if result.improvement}
    stairs = [
        staircase(result, f"stairs-{place}", words) | {"title": name}
        for place, (name, result) in enumerate(improved.items())
    ]
    models = {name: result.traces for name, result in results.items()}
    content = {"records": packed(models, POINTS[0]), "floors": shared_floors(results), "stairs": stairs}
    variables: dict[str, Any] = {"results": results, "tables": tables, "stairs": stairs, "verdicts": verdicts}
    variables |= {"words": words, "atlas": atlas_beside(page.parent)}
    write_text(page, rendered("side_by_side.html", "Side by side", content, lead=ranking(results), **variables))
    return page


def labels(folders: Sequence[Path]) -> list[str]:
    """The last parts of the folders' paths, as many as make them distinct, else numbers and names."""
    parts = [folder.resolve().parts for folder in folders]
    for count in range(1, max(map(len, parts)) + 1):
        names = ["/".join(path[-count:]) for path in parts]
        if len(set(names)) == len(names):
            return names
    return [f"{place}: {folder.name}" for place, folder in enumerate(folders, start=1)]


def ranking(results: dict[str, Results]) -> str:
    """A sentence naming the result with the lowest RMSE, on the validation records if all results have some."""
    use = "identify" if any(result.rmse["validate"] is None for result in results.values()) else "validate"
    if len({(result.unit, *result.units) for result in results.values()}) > 1:
        return "The results have different axes or units: their errors cannot be ranked."
    errors = {name: result.rmse[use] or 0.0 for name, result in results.items()}
    best = min(errors, key=lambda name: errors[name])
    floor = min(result.floor or 0.0 for result in results.values())
    size = f"{quantity(results[best].rmse[use], results[best].unit, 3)}{together(results[best].units)}"
    printed = {name: number(error) for name, error in errors.items()}
    equal = [n for n in results if printed[n] == printed[best] or not differ(errors[n], errors[best], floor)]
    if len(equal) > 1:
        return (
            f"{listed(equal)} have the lowest RMSE on the {USE_NAMES[use]} records, {size}: they differ by less than"
            " the noise leaves open."
        )
    return f"{best} has the lowest RMSE on the {USE_NAMES[use]} records: {size}."


def shared_floors(results: dict[str, Results]) -> dict[str, float | None]:
    """The noise floor of each axis, in its unit, where all results agree on it."""
    floors: dict[str, set[tuple[str, float | None]]] = {}
    for result in results.values():
        for axis, floor in result.floors.items():
            floors.setdefault(axis, set()).add((result.units[axis], floor))
    return {axis: next(iter(pairs))[1] for axis, pairs in floors.items() if len(pairs) == 1}


def summary(results: dict[str, Results]) -> Table:
    """One row per result: its RMSE, noise floor, best run and the effects that were added."""
    rows = [
        {
            "result": name,
            "job": result.name,
            **result.rmse,
            "unit": result.unit,
            "axes": f"{listed(result.units)}{' together' * (len(result.units) > 1)}",
            "noise_floor": result.floor or None,
            "run": result.result["best"]["run"] if result.result else "",
            "seconds": result.result["best"]["seconds"] if result.result else None,
            "effects": ", ".join(result.improvement.get("effects", ())),
        }
        for name, result in results.items()
    ]
    cells: dict[str, Cell] = {
        "result": lambda row: row["result"],
        "job": lambda row: row["job"],
        "identification RMSE": lambda row: number(row["identify"]),
        "validation RMSE": lambda row: number(row["validate"]),
        "noise floor": lambda row: number(row["noise_floor"], 3),
        "unit": lambda row: unit(row["unit"]) or "1",
        "axes": lambda row: row["axes"],
        "best run": lambda row: row["run"],
        "time [s]": lambda row: number(row["seconds"], 3),
        "effects added": lambda row: row["effects"],
    }
    return table("results", rows, cells, {"result", "job", "unit", "axes", "best run", "effects added"}, {})


def parameters(results: dict[str, Results]) -> Table:
    """One row per parameter, one column per result."""
    values = {name: result.parameters for name, result in results.items()}
    names = dict.fromkeys(key for entries in values.values() for key in entries)
    rows = [
        {
            "parameter": key,
            "unit": next(entries[key]["unit"] for entries in values.values() if key in entries),
            **{name: entries.get(key, {}).get("value") for name, entries in values.items()},
            **{error_of(name): entries.get(key, {}).get("standard_error") for name, entries in values.items()},
        }
        for key in names
    ]
    cells: dict[str, Cell] = {"parameter": lambda row: row["parameter"], "unit": lambda row: unit(row["unit"])}
    cells |= {name: lambda row, name=name: with_error(row[name], row[error_of(name)]) for name in results}  # type: ignore[misc]
    return table("parameters", rows, cells, {"parameter", "unit"}, {})


def error_of(name: str) -> str:
    """The column of the standard errors of a result."""
    return f"{name}, standard error"
