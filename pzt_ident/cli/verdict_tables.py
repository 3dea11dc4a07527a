"""A diagnosis and a staircase on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from pzt_ident.cli.result_tables import show_floors, uses
from pzt_ident.cli.table import number, table
from pzt_ident.data.over_axes import together
from pzt_ident.report.tables import expected
from pzt_ident.run.events import step_name

Facts = dict[str, Any]


def show_diagnosis(found: Facts, folder: Path) -> None:
    """The candidates that were refitted or come next, and the verdict."""
    unit, error = found["unit"], f"RMSE{together(found['units'])}"
    rows = [
        (
            item["effect"],
            f"{round(100 * item['explained'])} %",
            expected(item["expected"], item["units"]),
            f"{item['visibility']:.2f}",
            number(item["rmse"]["identify"]) if item["rmse"] else "",
            number(item["rmse"]["validate"]) if item["rmse"] else "",
            item["decision"],
        )
        for item in found["candidates"]
        if item["rmse"] or item["explained"] > 0.01
    ]
    errors = (f"{error}, identify [{unit}]", f"validate [{unit}]")
    table(("effect", "explains", "expected", "visible", *errors, "decision"), rows)
    click.echo(f"{error} [{unit}]: {uses(found['rmse'])}")
    show_floors(found)
    click.echo(found["reason"])
    _advise(found, folder)
    click.echo(f"diagnosis: {folder / 'diagnosis.json'}")


def _advise(found: Facts, folder: Path) -> None:
    best = next((item for item in found["candidates"] if item["decision"] == "missing"), None)
    if best:
        click.echo(f"{best['effect']}: {best['physics']}\non the rig: {best['remedy']}")
    if found["next_experiment"]:
        _propose(found["next_experiment"], folder)
    elif best and found["verdict"] == "inconclusive":
        click.echo(f"no drive within the limits tells them apart. On the rig: {best['separate_by']}")


def _propose(proposal: Facts, folder: Path) -> None:
    click.echo(f"to tell {' from '.join(proposal['splits'])}, run {folder / proposal['file']} ({proposal['why']})")


def show_improvement(found: Facts, folder: Path) -> None:
    """The staircase, the verdict, and where the improved job is."""
    unit, floor, error = found["unit"], found["floor"], f"RMSE{together(found['units'])}"
    rows = [
        (
            step_name(step),
            number(step["rmse"]["identify"]),
            number(step["rmse"]["validate"]),
            f"{step['rmse']['identify'] / floor:.2f}",
            "" if step["expected"] is None else f"{round(100 * min(step['expected'], 1))} %",
            f"{round(100 * step['explained'])} %" if step["added"] or step["removed"] else "",
            " or ".join(step["class"]),
        )
        for step in found["steps"]
    ]
    table(
        (
            "step",
            f"{error}, identify [{unit}]",
            f"validate [{unit}]",
            "in floors",
            "expected",
            "explained",
            "these data say",
        ),
        rows,
    )
    show_floors(found)
    click.echo(f"{found['verdict']}: {found['reason']}")
    if found["next_experiment"]:
        _propose(found["next_experiment"], folder)
    click.echo(f"improved job: {folder / 'improved.yaml'}")
    if (folder / "report.html").exists():
        click.echo(f"report: {folder / 'report.html'}")
