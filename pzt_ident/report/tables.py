"""The tables of a run: numbers for a computer (CSV), and the same as text for a reader (page, LaTeX)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pzt_ident.data.notation import bounds, count, number, percent, quantity, short, unit, with_error
from pzt_ident.data.over_axes import together
from pzt_ident.files import write_text
from pzt_ident.report.latex import tabular
from pzt_ident.run.events import step_name
from pzt_ident.run.results import Results

if TYPE_CHECKING:
    import pandas as pd

Cell = Callable[[Mapping[str, Any]], str]


@dataclass(frozen=True, eq=False)
class Table:
    """`data` has the numbers, a unit in the heading where there is one; `text` has what is printed. `words` are
    the printed columns set flush left, numbers being flush right."""

    name: str
    data: pd.DataFrame
    text: pd.DataFrame
    words: frozenset[str]


def make_tables(results: Results) -> dict[str, Table]:
    """Those that these results have, by name: the league of optimizers, every run, the best run's parameters and the
    records of a run; the candidates of a diagnosis; the steps of an improvement and the parameters before and after."""
    made = [league, runs, parameters, records] if results.result else []
    made += [candidates] * bool(results.diagnosis) + [steps, changes] * bool(results.improvement)
    return {table.name: table for table in (make(results) for make in made)}


def write_tables(tables: Mapping[str, Table], folder: Path) -> None:
    """Write `<name>.csv` and `<name>.tex` (a booktabs tabular) of each into the folder."""
    for table in tables.values():
        write_text(folder / f"{table.name}.csv", table.data.to_csv(index=False, lineterminator="\n"))
        write_text(folder / f"{table.name}.tex", tabular(table.text, table.words))


def league(results: Results) -> Table:
    """One row an optimizer: its own result before the polish, what it cost, and the result after the polish."""
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
        "evaluations to 1\u00a0%": lambda row: count(row["evaluations_to_1_percent_median"]),
        "success": lambda row: percent(row["success"]),
    }
    if len(results.result["league"]) > 1:
        cells["behind the first in"] = lambda row: (
            f"{row['leader_ahead']} of {row['pairs']}" if row.get("pairs") else "–"
        )
        cells["sign test p"] = lambda row: number(row["sign_test"], 2) if row.get("pairs") else "–"
    return table(
        "league", results.result["league"], cells, {"optimizer"}, _heads(results, *rmse, s=("seconds_median",))
    )


def runs(results: Results) -> Table:
    """One row a finished run, RMSE over the identify and over the validate records, before and after the polish."""
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
        pooled("identify", results): lambda row: number(row["identify"]),
        pooled("validate", results): lambda row: number(row["validate"]),
        pooled("identify before polish", results): lambda row: number(row["identify_before_polish"]),
        pooled("validate before polish", results): lambda row: number(row["validate_before_polish"]),
        "evaluations": lambda row: count(row["evaluations"]),
        "in the polish": lambda row: count(row["polish_evaluations"]),
        "evaluations to 1\u00a0%": lambda row: count(row["evaluations_to_1_percent"]),
        "time [s]": lambda row: number(row["seconds"], 3),
        "CPU [s]": lambda row: number(row["cpu_seconds"], 3),
        "failed simulations": lambda row: count(row["failed_simulations"]),
        "stopped by": lambda row: row["stopped_by"],
    }
    heads = _heads(results, *flat, s=("seconds", "cpu_seconds"))
    return table("runs", rows, cells, {"run", "stopped by"}, heads)


def parameters(results: Results) -> Table:
    """One row a parameter of the best run: value with standard error, bounds, and what the data say about it."""
    keys = ("value", "standard_error", "unit", "lower", "upper", "verdict", "note")
    rows = [
        {"parameter": name, **{key: entry.get(key) for key in keys}}
        for name, entry in results.best["parameters"].items()
    ]
    cells: dict[str, Cell] = {
        "parameter": lambda row: row["parameter"],
        "value": lambda row: with_error(row["value"], row["standard_error"]),
        "unit": lambda row: unit(row["unit"]),
        "bounds": lambda row: bounds(row["lower"], row["upper"]),
        "verdict": lambda row: row["verdict"],
    }
    if any(row["note"] for row in rows):
        cells["note"] = lambda row: row["note"] or ""
    return table("parameters", rows, cells, {"parameter", "unit", "verdict", "note"}, {})


def records(results: Results) -> Table:
    """One row a record: its use, size, RMSE of the best run per axis in its own unit, and the hash of its file."""
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
        "use": lambda row: row["use"],
        "samples": lambda row: count(row["samples"]),
        "rate [Hz]": lambda row: short(row["sample_rate"], 6),
        "not scored [s]": lambda row: short(row["settle"]),
        **errors,
        "file": lambda row: row["file"],
        "SHA-256": lambda row: row["sha256"][:16],
    }
    heads = {f"rmse_{axis}": f"rmse_{axis} [{results.units[axis]}]" for axis in axes}
    heads |= _heads(results, s=("settle",), Hz=("sample_rate",))
    return table("records", rows, cells, {"record", "use", "file", "SHA-256"}, heads)


def candidates(results: Results) -> Table:
    """One row an effect that was considered, best first."""
    rows = [
        {
            **{key: item[key] for key in ("effect", "decision", "explained", "visibility", "physics", "remedy")},
            "expected": expected(item["expected"], item.get("units", {})),
            "alike": ", ".join(word for word in item["class"] if word != item["effect"]),
            **(item["rmse"] or dict.fromkeys(("identify", "validate"))),
        }
        for item in results.diagnosis["candidates"]
    ]
    cells: dict[str, Cell] = {
        "effect": lambda row: row["effect"],
        "decision": lambda row: row["decision"],
        "explains": lambda row: percent(row["explained"]),
        "expected": lambda row: row["expected"],
        "visibility": lambda row: number(row["visibility"], 2),
        "cannot be told from": lambda row: row["alike"],
        pooled("identify", results): lambda row: number(row["identify"]),
        pooled("validate", results): lambda row: number(row["validate"]),
        "what it is": lambda row: row["physics"],
    }
    words = {"effect", "decision", "expected", "cannot be told from", "what it is"}
    return table("candidates", rows, cells, words, _heads(results, "identify", "validate"))


def expected(values: Mapping[str, float], units: Mapping[str, str], most: int = 3) -> str:
    """The first parameters of an effect and the values that they would take."""
    said = [f"{short_name(name)} {quantity(value, units.get(name, '1'), 3)}" for name, value in values.items()]
    return ", ".join([*said[:most], "…"] if len(said) > most else said)


def short_name(name: str) -> str:
    """A parameter without its block: `x.creep.tau` is `x.tau`."""
    *axis, _, last = name.split(".")
    return ".".join([*axis, last])


def steps(results: Results) -> Table:
    """One row a stair: what was added or taken back, and what the model leaves after it."""
    rows = [
        {
            "step": step_name(step),
            **step["rmse"],
            "floors": step["rmse"]["identify"] / results.improvement["floor"],
            **{key: step.get(key) for key in ("expected", "explained")},
            "class": " or ".join(step["class"]),
        }
        for step in results.improvement["steps"]
    ]
    rows[0]["explained"] = None
    cells: dict[str, Cell] = {
        "step": lambda row: row["step"],
        pooled("identify", results): lambda row: number(row["identify"]),
        pooled("validate", results): lambda row: number(row["validate"]),
        "noise floors": lambda row: number(row["floors"], 3),
        "expected to explain": lambda row: percent(row["expected"]),
        "explained": lambda row: percent(row["explained"]),
        "these data say": lambda row: row["class"],
    }
    return table("steps", rows, cells, {"step", "these data say"}, _heads(results, "identify", "validate"))


def changes(results: Results) -> Table:
    """One row a parameter of the improved model, before and after."""
    first, last = (results.improvement["steps"][place]["parameters"] for place in (0, -1))
    rows = [
        {
            "parameter": name,
            "unit": item["unit"],
            "as_given": first.get(name, {}).get("value"),
            "improved": item["value"],
        }
        for name, item in last.items()
    ]
    cells: dict[str, Cell] = {
        "parameter": lambda row: row["parameter"],
        "as given": lambda row: number(row["as_given"], 5),
        "improved": lambda row: number(row["improved"], 5),
        "unit": lambda row: unit(row["unit"]),
    }
    return table("changes", rows, cells, {"parameter", "unit"}, {})


def table(
    name: str, rows: list[dict[str, Any]], cells: dict[str, Cell], words: set[str], heads: dict[str, str]
) -> Table:
    import pandas as pd

    text = pd.DataFrame([{title: str(cell(row)) for title, cell in cells.items()} for row in rows], columns=list(cells))
    data = pd.DataFrame(rows).rename(columns=heads)
    return Table(name, data, text, frozenset(words))


def pooled(name: str, results: Results) -> str:
    """The heading of a number over all axes, as it is printed."""
    return f"{name}{together(results.units)} [{unit(results.unit) or 1}]"


def _heads(results: Results, *keys: str, **others: tuple[str, ...]) -> dict[str, str]:
    """Headings with units: `keys` are over all axes, the others go by their unit."""
    own = {key: f"{key} [{of}]" for of, names in others.items() for key in names}
    return {key: f"{key}{together(results.units)} [{results.unit}]" for key in keys} | own


def _pair(rmse: Mapping[str, float | None]) -> tuple[float | None, float | None]:
    return rmse["identify"], rmse["validate"]
