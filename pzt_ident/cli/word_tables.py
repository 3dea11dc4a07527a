"""What a word in a job stands for, as text for the terminal."""

from __future__ import annotations

from typing import Any

import click

from pzt_ident.cli.table import table, together

Facts = dict[str, Any]


def show_word(found: Facts) -> None:
    click.echo(f"{found['name']} ({found['kind']})\n\n{found['doc']}\n")
    if source := found.get("source"):
        click.echo(f"{source}\n")
    if not found.get("convergent", True):
        click.echo("It comes near an optimum, but does not converge to it.\n")
    if "settings" in found:
        table(
            ("setting", "default", "from - to", "unit", "what it is"),
            [(row["name"], row["default"], _allowed(row), row["unit"], row["doc"]) for row in found["settings"]],
        )
    if "parameters" in found:
        table(
            ("parameter", "unit", "bounds", "null", "what it is"),
            [
                (row["name"], row["unit"], "{:g} to {:g}".format(*row["bounds"]), _plain(row["null"]), _meaning(row))
                for row in together(found["parameters"])
            ],
        )
        if any("drive" in row["unit"] or "response" in row["unit"] for row in found["parameters"]):
            click.echo("Bounds in units of drive and response are multiples of the data's own peak-to-peak values,")
            click.echo("those of response/drive with either sign where the response does not rise with the drive.")
    for title, key in (("Leaves the same trace as", "look_alikes"), ("To tell", "separate_by"), ("To do", "remedy")):
        if said := found.get(key):
            click.echo(f"\n{title}: {said if isinstance(said, str) else ', '.join(said)}")


def _allowed(row: Facts) -> str:
    return " or ".join(row["words"]) if "words" in row else "{:g} to {:g}".format(*row["bounds"])


def _plain(value: float | None) -> str:
    return "" if value is None else f"{value:g}"


def _meaning(row: Facts) -> str:
    """What a parameter is, and what it takes to have it searched for."""
    fixed = "" if row["value"] is None else f" Fixed at {row['value']:g} unless the job gives bounds."
    effect = "" if row["effect"] is None else f" With the effect {row['effect']} only."
    own = " Each record has its own." if row["per_record"] else ""
    form = f" With `{row['form']}` only." if row["form"] else ""
    return row["doc"] + fixed + effect + own + form
