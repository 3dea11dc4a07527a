"""The result of a run on the terminal."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import click

from pzt_ident.cli.progress import failure_message
from pzt_ident.cli.table import number, table
from pzt_ident.data.over_axes import over_uses, together, weighed


def show_result(result: dict[str, Any], folder: Path) -> None:
    """The league of optimizers, the parameters of the best run, the noise floor, and the path of the report."""
    unit, best = result["unit"], result["best"]
    error = f"RMSE{together(result['units'])} [{unit}]"
    table(
        ("optimizer", "runs", *(f"{each} [{unit}]" for each in _LEAGUE.values()), "time [s]"),
        [
            (row["optimizer"], row["runs"], *(number(row.get(key)) for key in _LEAGUE), number(row["seconds_median"]))
            for row in result["league"]
        ],
    )
    table(
        ("parameter", "value", "standard error", "unit", "verdict"),
        [
            (name, number(item["value"]), number(item["standard_error"]), item["unit"], item["verdict"])
            for name, item in best["parameters"].items()
        ],
    )
    click.echo(f"{error}: {rmse_by_use(best['rmse'])} ({best['run']})")
    show_floors(result)
    worst, floor = max(error for error in best["rmse"].values() if error is not None), result["floor"]
    if worst > MUCH * floor > 0:
        job = folder / "job.yaml"
        click.echo(f"It leaves {worst / floor:.1f} noise floors: `pzt-ident improve {job}` says what is missing.")
    show_notes(result["records"])
    for run in result["failed_runs"]:
        click.echo(failure_message(run))
    page = folder / "report.html"
    click.echo(f"report: {page}" if page.exists() else f"results: {folder}")


def show_floors(facts: dict[str, Any]) -> None:
    """The noise floor of each axis; of several axes, also that of all together and how they are weighed."""
    units = facts["units"]
    for axis, floor in facts["noise_floor"].items():
        click.echo(f"noise floor of {axis} [{units[axis]}]: {number(floor)}")
    if len(units) > 1:
        click.echo(f"noise floor{together(units)} [{facts['unit']}]: {number(facts['floor'])}")
    for sentence in weighed(units):
        click.echo(sentence)


def show_notes(records: Iterable[dict[str, Any]]) -> None:
    """The notes of each record, and an empty line behind them."""
    notes = [f"{record['name']}: {note}" for record in records for note in record["notes"]]
    click.echo("".join(f"{note}\n" for note in notes), nl=bool(notes))


_LEAGUE = {
    "rmse_best": "best",
    "rmse_median": "median",
    "polished_rmse_best": "best polished",
    "polished_rmse_median": "median polished",
}
MUCH = 1.5  # noise floors: what a result leaves that is told to be more than noise


def rmse_by_use(rmse: dict[str, float | None]) -> str:
    return over_uses({use: number(value) for use, value in rmse.items() if value is not None})
