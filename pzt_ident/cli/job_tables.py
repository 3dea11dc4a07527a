"""The contents of a job and its data, as text for the terminal."""

from __future__ import annotations

from typing import Any

import click

from pzt_ident.cli.result_tables import show_notes
from pzt_ident.cli.table import grouped_by_range, number, table
from pzt_ident.data.notation import listed
from pzt_ident.data.over_axes import USE_NAMES

Facts = dict[str, Any]


def show_job(facts: Facts) -> None:
    click.echo(f"{facts['name']} ({facts['hash']}): {' -> '.join(facts['model'])}\n")
    table(
        ("record", "use", "samples", "rate [Hz]", "length [s]", "not scored [s]", "file"),
        [
            (row["name"], USE_NAMES[row["use"]], row["samples"], *(number(row[key]) for key in _TIMES), row["file"])
            for row in facts["records"]
        ],
    )
    show_notes(facts["records"])
    table(
        ("axis", "drive", "response", "noise floor", "taken from"),
        [(axis["name"], _range(axis, "drive"), _range(axis, "response"), *_floor(axis)) for axis in facts["axes"]],
    )
    table(
        ("parameter", "unit", "bounds", "what it is"),
        [(row["name"], row["unit"], _treatment(row), row["doc"]) for row in grouped_by_range(facts["parameters"])],
    )
    for note in facts["notes"]:
        click.echo(note)
    faults = f", and as faults of the set-up {listed(facts['faults'])}" if facts["faults"] else ""
    click.echo(f"a diagnosis may name {listed(facts['nameable'])}{faults}")
    for reason, words in facts["out_of_place"].items():
        click.echo(f"no diagnosis names {listed(words)}: {reason}")
    click.echo(f"runs: {' '.join(facts['runs'])}, {facts['evaluations']} evaluations in all")


_TIMES = ("sample_rate", "seconds", "settle")


def _range(axis: Facts, channel: str) -> str:
    if axis[f"{channel}_unit"] is None:
        return "not measured"
    low, high = (float(f"{end:.4g}") + 0.0 for end in axis[f"{channel}_range"])  # no -0
    return f"{low:.4g} to {high:.4g} {axis[f'{channel}_unit']}"


def _floor(axis: Facts) -> tuple[str, str]:
    if "noise_floor" not in axis:
        return "", ""
    return f"{axis['noise_floor']:.3g} {axis['response_unit']}", axis["noise_floor_source"]


def _treatment(row: Facts) -> str:
    """The search range of a parameter, or that it is fixed or solved for."""
    if not {"value", "bounds"} & set(row):
        return "solved for"
    return "fixed at {:.4g}".format(row["value"]) if "value" in row else "{:.4g} to {:.4g}".format(*row["bounds"])
