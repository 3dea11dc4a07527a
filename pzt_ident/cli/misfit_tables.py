"""Where a model fails, as text for the terminal."""

from __future__ import annotations

from typing import Any

import click

from pzt_ident.cli.table import number, table
from pzt_ident.diagnosis.wording import percent

Facts = dict[str, Any]


def show_misfits(found: Facts) -> None:
    """For every axis: how much, where, the worst stretches, and what to read from it."""
    table(
        ("axis", "RMSE", "noise floor", "misfit", "unit", "noise taken from"),
        [(name, *(number(axis[key]) for key in _SIZES), *_source(axis)) for name, axis in found["axes"].items()],
    )
    for axis in found["axes"].values():
        show_axis(axis)


_SIZES = ("rmse", "noise_floor", "misfit")


def _source(axis: Facts) -> tuple[str, str]:
    return axis["unit"], axis["noise_source"]


def show_axis(axis: Facts) -> None:
    if rows := [row for view in axis["views"] for row in part_rows(view)]:
        table((f"axis {axis['axis']} by", "where most is", "of misfit", "of samples", f"RMSE [{axis['unit']}]"), rows)
    if axis["worst"]:
        rows = [
            (one["record"], number(one["start"]), number(one["end"]), percent(one["share"]), number(one["rmse"]))
            for one in axis["worst"]
        ]
        table(("worst stretches of", "from [s]", "to [s]", "of misfit", f"RMSE [{axis['unit']}]"), rows)
    for sentence in axis["sentences"]:
        click.echo(f"{axis['axis']}: {sentence}")


def part_rows(view: Facts) -> list[tuple[str, ...]]:
    """The bins with the three largest shares of the misfit, where there is a choice."""
    used = [part for part in view["bins"] if part["samples"] > 0]
    largest = sorted((part for part in used if part["share"] >= 0.05), key=lambda part: -part["share"])[:3]
    if len(used) < 2:
        return []
    return [(view["name"] if part is largest[0] else "", *cells(part)) for part in largest]


def cells(part: Facts) -> tuple[str, ...]:
    return part["label"], percent(part["share"]), percent(part["samples"]), number(part["rmse"])
