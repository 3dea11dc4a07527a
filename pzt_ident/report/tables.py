"""The tables of a run: as numbers (CSV) and as printed text (page, LaTeX)."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pzt_ident.data.notation import bounds, count, number, percent, quantity, short, unit, with_error
from pzt_ident.data.over_axes import together
from pzt_ident.files import write_text
from pzt_ident.report.latex import tabular
from pzt_ident.report.sentences import USE_NAMES
from pzt_ident.run.events import explains, step_name
from pzt_ident.run.results import Results

Columns = dict[str, list[Any]]
Cell = Callable[[Mapping[str, Any]], str]


@dataclass(frozen=True, eq=False)
class Table:
    """`data`: columns of numbers by heading, with units in the headings. `text`: the same as printed. `words`: the
    columns of `text` that are set flush left; numbers are set flush right."""

    name: str
    data: Columns
    text: Columns
    words: frozenset[str]


def make_tables(results: Results) -> dict[str, Table]:
    """All tables of these results by name: league of optimizers, runs, parameters of the best run and records (run);
    candidates (diagnosis); steps and changes of parameters (improvement)."""
    makers = [league, runs, parameters, records] if results.result else []
    makers += [candidates] * bool(results.diagnosis) + [steps, changes] * bool(results.improvement)
    return {table.name: table for table in (make(results) for make in makers)}


def write_tables(tables: Mapping[str, Table], folder: Path) -> None:
    """Write `<name>.csv` and `<name>.tex` (a booktabs tabular) of each into the folder."""
    for table in tables.values():
        write_text(folder / f"{table.name}.csv", comma_separated(table.data))
        write_text(folder / f"{table.name}.tex", tabular(table.text, table.words))


def comma_separated(columns: Columns) -> str:
    """CSV with the digits that give each number again, and nothing where there is none."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([columns, *zip(*columns.values(), strict=True)])
    return text.getvalue()


def league(results: Results) -> Table:
    """One row per optimizer: its RMSE before the polish, its cost, and the RMSE after the polish."""
    rmse = ("rmse_median", "rmse_lower_quartile", "rmse_upper_quartile", "rmse_best", "polished_rmse_median")
    cells: dict[str, Cell] = {
        "optimizer": lambda row: row["optimizer"],
        "runs": lambda row: count(row["runs"]),
        pooled("RMSE median", results): lambda row: number(row["rmse_median"]),
        pooled("quartiles", results): lambda row: (
            f"{number(row['rmse_lower_quartile'])} to {number(row['rmse_upper_quartile'])}"
        ),
        pooled("best", results): lambda row: number(row["rmse_best"]),
        pooled("median after polish", results): lambda row: number(row["polished_rmse_median"]),
        "time [s]": lambda row: number(row["seconds_median"], 3),
        "evaluations": lambda row: count(row["evaluations"]),
        "evaluations to within 1\u00a0%": lambda row: count(row["evaluations_to_1_percent_median"]),
        "success": lambda row: percent(row["success"]),
        "success after polish": lambda row: percent(row.get("polished_success")),
    }
    if len(results.result["league"]) > 1:
        cells["worse than first"] = lambda row: f"{row['leader_ahead']} of {row['pairs']}" if row.get("pairs") else "–"
        cells["sign test p"] = lambda row: number(row["sign_test"], 2) if row.get("pairs") else "–"
    return table(
        "league",
        results.result["league"],
        cells,
        {"optimizer"},
        _headings(results, *rmse, s=("seconds_median", "cpu_seconds_median")),
    )


def runs(results: Results) -> Table:
    """One row per finished run: RMSE on the identification and validation records before and after the polish."""
    flat = ("identify", "validate", "identify_before_polish", "validate_before_polish")
    rows = [
        {
            **{key: run[key] for key in ("run", "optimizer", "repeat")},
            **dict(zip(flat, (*_pair(run["rmse"]), *_pair(run["rmse_before_polish"])), strict=True)),
            **{key: run[key] for key in ("evaluations", "polish_evaluations", "evaluations_to_1_percent")},
            **{key: run[key] for key in ("seconds", "cpu_seconds", "failed_simulations", "stopped_by")},
        }
        for run in results.result["runs"]
    ]
    cells: dict[str, Cell] = {
        "run": lambda row: row["run"],
        pooled("identification RMSE", results): lambda row: number(row["identify"]),
        pooled("validation RMSE", results): lambda row: number(row["validate"]),
        pooled("identification RMSE before polish", results): lambda row: number(row["identify_before_polish"]),
        pooled("validation RMSE before polish", results): lambda row: number(row["validate_before_polish"]),
        "evaluations": lambda row: count(row["evaluations"]),
        "polish evaluations": lambda row: count(row["polish_evaluations"]),
        "evaluations to within 1\u00a0%": lambda row: count(row["evaluations_to_1_percent"]),
        "time [s]": lambda row: number(row["seconds"], 3),
        "CPU [s]": lambda row: number(row["cpu_seconds"], 3),
        "failed simulations": lambda row: count(row["failed_simulations"]),
        "stopped by": lambda row: row["stopped_by"],
    }
    headings = _headings(results, *flat, s=("seconds", "cpu_seconds"))
    return table("runs", rows, cells, {"run", "stopped by"}, headings)


def parameters(results: Results) -> Table:
    """One row per parameter of the best run: value with standard error, bounds, and whether the data determine it."""
    keys = ("value", "standard_error", "unit", "lower", "upper", "verdict", "note")
    rows = [
        {"parameter": name, **{key: entry.get(key) for key in keys}}
        for name, entry in results.best["parameters"].items()
    ]
    for row in rows:
        row["low"], row["high"] = interval_of(results.best["parameters"][row["parameter"]]) or (None, None)
    cells: dict[str, Cell] = {
        "parameter": lambda row: row["parameter"],
        "value": lambda row: with_error(row["value"], row["standard_error"]),
        "95 % interval": lambda row: "" if row["low"] is None else f"{number(row['low'])} to {number(row['high'])}",
        "unit": lambda row: unit(row["unit"]),
        "bounds": lambda row: bounds(row["lower"], row["upper"]),
        "verdict": lambda row: row["verdict"],
    }
    if any(row["note"] for row in rows):
        cells["note"] = lambda row: row["note"] or ""
    return table("parameters", rows, cells, {"parameter", "unit", "verdict", "note"}, {})


def interval_of(entry: Mapping[str, Any]) -> tuple[float, float] | None:
    """The 95 % interval of a parameter: as stated, else from its standard error; None if it has none."""
    if stated := entry.get("interval"):
        return stated[0], stated[1]
    error = entry.get("standard_error")
    return (entry["value"] - 1.96 * error, entry["value"] + 1.96 * error) if error else None


def records(results: Results) -> Table:
    """One row per record: its use, size, RMSE of the best run by axis in the axis' unit, and the hash of its file."""
    keys = ("name", "use", "samples", "sample_rate", "settle")
    axes = list(dict.fromkeys(axis for record in results.result["records"] for axis in record["rmse"]))
    rows = [
        {
            **{key: record[key] for key in keys},
            **{f"rmse_{axis}": record["rmse"].get(axis) for axis in axes},
            **{key: record[key] for key in ("file", "sha256")},
        }
        for record in results.result["records"]
    ]
    errors: dict[str, Cell] = {
        f"RMSE {axis} [{unit(results.units[axis]) or 1}]": lambda row, key=f"rmse_{axis}": number(row[key])  # type: ignore[misc]
        for axis in axes
    }
    cells: dict[str, Cell] = {
        "record": lambda row: row["name"],
        "use": lambda row: USE_NAMES[row["use"]],
        "samples": lambda row: count(row["samples"]),
        "rate [Hz]": lambda row: short(row["sample_rate"], 6),
        "not scored [s]": lambda row: short(row["settle"]),
        **errors,
        "file": lambda row: row["file"],
        "SHA-256": lambda row: row["sha256"][:16],
    }
    headings = {f"rmse_{axis}": f"rmse_{axis} [{results.units[axis]}]" for axis in axes}
    headings |= _headings(results, s=("settle",), Hz=("sample_rate",))
    return table("records", rows, cells, {"record", "use", "file", "SHA-256"}, headings)


def candidates(results: Results) -> Table:
    """One row per effect that was considered, best first."""
    rows = [
        {
            "effect": item.get("item", item["effect"]),
            **{key: item[key] for key in ("decision", "explained", "visibility", "physics", "remedy")},
            "expected": expected(item["expected"], item.get("units", {})),
            "alike": ", ".join(word for word in item["class"] if word != item["effect"]),
            **(item["rmse"] or dict.fromkeys(("identify", "validate"))),
        }
        for item in results.diagnosis["candidates"]
    ]
    cells: dict[str, Cell] = {
        "effect": lambda row: row["effect"],
        "decision": lambda row: row["decision"],
        "explained misfit": lambda row: percent(row["explained"]),
        "estimate": lambda row: row["expected"],
        "visibility": lambda row: number(row["visibility"], 2),
        "indistinguishable from": lambda row: row["alike"],
        pooled("identification RMSE", results): lambda row: number(row["identify"]),
        pooled("validation RMSE", results): lambda row: number(row["validate"]),
        "physics": lambda row: row["physics"],
    }
    words = {"effect", "decision", "estimate", "indistinguishable from", "physics"}
    return table("candidates", rows, cells, words, _headings(results, "identify", "validate"))


def expected(values: Mapping[str, float], units: Mapping[str, str], most: int = 3) -> str:
    """The estimated values of the first `most` parameters of an effect, as printed."""
    texts = [f"{short_name(name)} {quantity(value, units.get(name, '1'), 3)}" for name, value in values.items()]
    return ", ".join([*texts[:most], "…"] if len(texts) > most else texts)


def short_name(name: str) -> str:
    """The name of a parameter without its block: `x.tau` for `x.creep.tau`."""
    *axis, _, last = name.split(".")
    return ".".join([*axis, last])


def steps(results: Results) -> Table:
    """One row per step: the effect added or removed, the RMSE after it, and the explained share of the misfit."""
    rows = [
        {
            "step": step_name(step),
            **step["rmse"],
            "floors": step["rmse"]["identify"] / results.improvement["floor"],
            "expected": step.get("expected"),
            "explained": step["explained"] if explains(step) else None,
            "promised": (step.get("promised") or {}).get("identify"),
            "note": step.get("note") or "",
            "class": " or ".join(step["class"]),
        }
        for step in results.improvement["steps"]
    ]
    cells: dict[str, Cell] = {
        "step": lambda row: row["step"],
        pooled("identification RMSE", results): lambda row: number(row["identify"]),
        pooled("validation RMSE", results): lambda row: number(row["validate"]),
        "RMSE in noise floors": lambda row: number(row["floors"], 3),
        "predicted share": lambda row: percent(row["expected"]),
        "explained share": lambda row: percent(row["explained"]),
        "supported by the data": lambda row: row["class"],
    }
    if any(row["promised"] for row in rows):
        cells[pooled("promised RMSE", results)] = lambda row: number(row["promised"])
    if any(row["note"] for row in rows):
        cells["note"] = lambda row: row["note"]
    headings = _headings(results, "identify", "validate", "promised")
    return table("steps", rows, cells, {"step", "supported by the data", "note"}, headings)


def changes(results: Results) -> Table:
    """One row per parameter of the improved model: its value before and after."""
    first, last = (results.improvement["steps"][place]["parameters"] for place in (0, -1))
    rows = [
        {
            "parameter": name,
            "unit": item["unit"],
            "as_given": first.get(name, {}).get("value"),
            "as_given_standard_error": first.get(name, {}).get("standard_error"),
            "improved": item["value"],
            "standard_error": item.get("standard_error"),
        }
        for name, item in last.items()
    ]
    cells: dict[str, Cell] = {
        "parameter": lambda row: row["parameter"],
        "as given": lambda row: with_error(row["as_given"], row["as_given_standard_error"]),
        "improved": lambda row: with_error(row["improved"], row["standard_error"]),
        "unit": lambda row: unit(row["unit"]),
    }
    return table("changes", rows, cells, {"parameter", "unit"}, {})


def table(
    name: str, rows: list[dict[str, Any]], cells: dict[str, Cell], words: set[str], headings: dict[str, str]
) -> Table:
    """`cells`: the printed text of a row by column; `headings`: CSV headings by key of a row."""
    text = {title: [str(cell(row)) for row in rows] for title, cell in cells.items()}
    keys = dict.fromkeys(key for row in rows for key in row)
    data = {headings.get(key, key): [row.get(key) for row in rows] for key in keys}
    return Table(name, data, text, frozenset(words))


def pooled(name: str, results: Results) -> str:
    """The printed heading of a number over all axes."""
    return f"{name}{together(results.units)} [{unit(results.unit) or 1}]"


def _headings(results: Results, *keys: str, **keys_by_unit: tuple[str, ...]) -> dict[str, str]:
    """CSV headings by key: `keys` hold errors over all axes, the others have the unit that is their keyword."""
    with_units = {key: f"{key} [{unit}]" for unit, names in keys_by_unit.items() for key in names}
    return {key: f"{key}{together(results.units)} [{results.unit}]" for key in keys} | with_units


def _pair(rmse: Mapping[str, float | None]) -> tuple[float | None, float | None]:
    return rmse["identify"], rmse["validate"]
