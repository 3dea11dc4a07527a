"""Where a model fails, as text for the terminal."""

from __future__ import annotations

from typing import Any

import click

from pzt_ident.cli.table import number, table
from pzt_ident.diagnosis.wording import percent

Facts = dict[str, Any]


def show_misfits(residuals: Facts) -> None:
    """For every axis: size of the misfit, where it is, its worst intervals, and what follows from it."""
    table(
        ("axis", "RMSE", "noise floor", "misfit", "unit", "noise taken from"),
        [(name, *(number(axis[key]) for key in _SIZES), *_source(axis)) for name, axis in residuals["axes"].items()],
    )
    for axis in residuals["axes"].values():
        show_axis(axis)


_SIZES = ("rmse", "noise_floor", "misfit")


def _source(axis: Facts) -> tuple[str, str]:
    return axis["unit"], axis["noise_source"]


def show_axis(axis: Facts) -> None:
    if rows := [row for view in axis["views"] for row in bin_rows(view)]:
        table((f"axis {axis['axis']} by", "where most is", "of misfit", "of samples", f"RMSE [{axis['unit']}]"), rows)
    if axis["worst"]:
        rows = [
            (item["record"], number(item["start"]), number(item["end"]), percent(item["share"]), number(item["rmse"]))
            for item in axis["worst"]
        ]
        table(("worst intervals of", "from [s]", "to [s]", "of misfit", f"RMSE [{axis['unit']}]"), rows)
    for sentence in axis["sentences"]:
        click.echo(f"{axis['axis']}: {sentence}")


def bin_rows(view: Facts) -> list[tuple[str, ...]]:
    """The bins with the three largest shares of the misfit; none where all samples are in one bin."""
    filled = [item for item in view["bins"] if item["samples"] > 0]
    largest = sorted((item for item in filled if item["share"] >= 0.05), key=lambda item: -item["share"])[:3]
    if len(filled) < 2:
        return []
    return [(view["name"] if item is largest[0] else "", *_cells(item)) for item in largest]


def _cells(item: Facts) -> tuple[str, ...]:
    return item["label"], percent(item["share"]), percent(item["samples"]), number(item["rmse"])
