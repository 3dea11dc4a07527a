"""A diagnosis and a staircase on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from pzt_ident.cli.result_tables import rmse_by_use, show_floors
from pzt_ident.cli.table import number, table
from pzt_ident.data.notation import listed
from pzt_ident.data.over_axes import together
from pzt_ident.report.tables import expected
from pzt_ident.run.events import explains, step_name, verdict_line

Facts = dict[str, Any]


def show_diagnosis(diagnosis: Facts, folder: Path) -> None:
    """The candidates that were refitted or explain more than 1 % of the misfit, and the verdict."""
    unit, error = diagnosis["unit"], f"RMSE{together(diagnosis['units'])}"
    rows = [
        (
            item.get("item", item["effect"]),
            f"{round(100 * item['explained'])} %",
            expected(item["expected"], item["units"]),
            f"{item['visibility']:.2f}",
            number(item["rmse"]["identify"]) if item["rmse"] else "",
            number(item["rmse"]["validate"]) if item["rmse"] else "",
            item["decision"],
        )
        for item in diagnosis["candidates"]
        if item["rmse"] or item["explained"] > 0.01
    ]
    errors = (f"{error}, identification [{unit}]", f"validation [{unit}]")
    table(("effect", "explains", "estimate", "visible", *errors, "decision"), rows)
    click.echo(f"{error} [{unit}]: {rmse_by_use(diagnosis['rmse'])}")
    show_floors(diagnosis)
    click.echo(diagnosis["reason"])
    _advise(diagnosis, folder)
    click.echo(f"diagnosis: {folder / 'diagnosis.json'}")


def _advise(diagnosis: Facts, folder: Path) -> None:
    best = next((item for item in diagnosis["candidates"] if item["decision"] == "missing"), None)
    if best:
        click.echo(f"{best.get('item', best['effect'])}: {best['physics']}\non the rig: {best['remedy']}")
    if diagnosis["next_experiment"]:
        _propose(diagnosis["next_experiment"], folder)
    elif best and diagnosis["verdict"] == "inconclusive":
        click.echo(f"no drive within the limits tells them apart. On the rig: {best['separate_by']}")


def _propose(proposal: Facts, folder: Path) -> None:
    drive = f"apply the drive in {folder / proposal['file']}: {proposal['why']}"
    click.echo(f"to distinguish {listed(proposal['splits'])}, {drive}")


def show_improvement(improvement: Facts, folder: Path) -> None:
    """The staircase, the verdict, and where the improved job is."""
    unit, floor, error = improvement["unit"], improvement["floor"], f"RMSE{together(improvement['units'])}"
    rows = [
        (
            step_name(step),
            number(step["rmse"]["identify"]),
            number(step["rmse"]["validate"]),
            f"{step['rmse']['identify'] / floor:.2f}",
            "" if step["expected"] is None else f"{round(100 * min(step['expected'], 1))} %",
            f"{round(100 * step['explained'])} %" if explains(step) else "",
            " or ".join(step["class"]),
        )
        for step in improvement["steps"]
    ]
    table(
        (
            "step",
            f"{error}, identification [{unit}]",
            f"validation [{unit}]",
            "in floors",
            "expected",
            "explained",
            "these data say",
        ),
        rows,
    )
    show_floors(improvement)
    click.echo(verdict_line(improvement["verdict"], improvement["reason"]))
    if improvement["next_experiment"]:
        _propose(improvement["next_experiment"], folder)
    click.echo(f"improved job: {folder / 'improved.yaml'}")
    if (folder / "report.html").exists():
        click.echo(f"report: {folder / 'report.html'}")
