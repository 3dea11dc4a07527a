"""The figures of a run: which there are, and their files."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from pzt_ident.data.signals import Trace
from pzt_ident.files import replaced
from pzt_ident.report import density_figures
from pzt_ident.report import misfit_figures as misfit
from pzt_ident.report import residual_figures as residual
from pzt_ident.report import search_figures as search
from pzt_ident.report import signal_figures as signal
from pzt_ident.report import staircase_figures as staircase
from pzt_ident.report.style import COLUMN, PAGE, saved, style
from pzt_ident.report.words import standing
from pzt_ident.run.results import Results

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Plate:
    """One figure to be drawn at any width: `section` is where it stands in the report, none where that shows the same
    to be looked into; `caption` is what is below it."""

    name: str
    section: str | None
    caption: str
    height: Callable[[float], float]
    draw: Callable[[Figure], None]


def plates(results: Results) -> list[Plate]:
    """Every figure that these results have, in the order of the report."""
    return [
        *_staircase_plates(results),
        *_signal_plates(results),
        *_residual_plates(results),
        *misfit_plates(results),
        *(_search_plates(results) if results.result else ()),
    ]


def drawn(plate: Plate, width: float, kind: type[Figure] | None = None) -> Figure:
    """A plate `width` mm wide, on a figure of this kind."""
    from matplotlib.figure import Figure

    with style():
        figure = (kind or Figure)(figsize=(width / 25.4, plate.height(width) / 25.4))
        plate.draw(figure)
    return figure


def render(plate: Plate, width: float, forms: Sequence[str]) -> dict[str, bytes]:
    """A plate drawn `width` mm wide, as the content of a file of each form, svg or pdf."""
    figure = drawn(plate, width)
    with style():
        return {form: saved(figure, form) for form in forms}


def write_page_figures(results: Results, folder: Path) -> list[tuple[Plate, bytes]]:
    """Write every figure that the page shows as SVG, `<name>-180mm.svg`; returns them."""
    return [(plate, _write(plate, PAGE, ("svg",), folder)["svg"]) for plate in plates(results) if plate.section]


def write_paper_figures(results: Results, folder: Path) -> Iterator[Plate]:
    """Write every figure as a paper needs it, SVG and PDF at 88 and 180 mm. Yields what is done."""
    return _written(plates(results), folder)


def write_misfit_figures(results: Results, folder: Path) -> Iterator[Plate]:
    """Write the figures of the misfit, SVG and PDF at 88 and 180 mm. Yields what is done."""
    return _written(misfit_plates(results), folder)


def _written(chosen: Iterable[Plate], folder: Path) -> Iterator[Plate]:
    for plate in chosen:
        for width in (COLUMN, PAGE):
            _write(plate, width, ("svg", "pdf"), folder)
        yield plate


def _write(plate: Plate, width: int, forms: Sequence[str], folder: Path) -> dict[str, bytes]:
    drawn = render(plate, width, forms)
    for form, content in drawn.items():
        with replaced(folder / f"{plate.name}-{width}mm.{form}") as beside:
            beside.write_bytes(content)
    return drawn


def slug(text: str) -> str:
    """`text` as part of a file name."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:40]


def _staircase_plates(results: Results) -> Iterator[Plate]:
    if results.improvement:
        yield Plate(
            "staircase",
            None,
            "RMSE after each step on the records that were fitted and on those that the fit never saw, and the noise "
            "floor.",
            staircase.height,
            partial(staircase.draw, improvement=results.improvement),
        )


def _signal_plates(results: Results) -> Iterator[Plate]:
    floor = results.floors
    bins = max(150, min(600, 2400 // max(len(results.traces), 1)))
    for place, trace in enumerate(results.traces, start=1):
        yield Plate(
            "-".join(filter(None, (f"time-{place}", slug(trace.record), slug(trace.axis)))),
            None,
            f"Response of axis {trace.axis}, measured and modelled, and the residual: {trace.record} ({trace.use}).",
            signal.time_height,
            partial(signal.draw_time, trace=trace, noise=floor.get(trace.axis), bins=bins),
        )
    for axis, traces in _by_axis(results):
        yield Plate(
            f"loops-{slug(axis)}",
            None,
            f"Response against drive of axis {axis}, measured and modelled.",
            partial(signal.records_height, records=len(traces)),
            partial(signal.draw_loops, traces=traces, points=3 * bins),
        )


def _residual_plates(results: Results) -> Iterator[Plate]:
    floor = results.floors
    for axis, traces in _by_axis(results):
        height = partial(signal.records_height, records=len(traces))
        yield Plate(
            f"residual-drive-{slug(axis)}",
            "residuals",
            f"Residual of axis {axis} against the drive, rising and falling drive apart: median, and the band that "
            "holds 90 % of the samples.",
            height,
            partial(residual.draw_branches, traces=traces, noise=floor.get(axis)),
        )
        yield Plate(
            f"residual-loop-{slug(axis)}",
            None,
            f"Mean residual of axis {axis} along the measured loop.",
            height,
            partial(residual.draw_map, traces=traces),
        )
    yield Plate(
        "residual-spread",
        "residuals",
        "Spread of the scored residuals.",
        partial(residual.histogram_height, axes=len(results.axes)),
        partial(residual.draw_histogram, traces=results.traces, noise=floor),
    )


def misfit_plates(results: Results) -> Iterator[Plate]:
    """Of each axis that has a misfit."""
    for axis, traces in _by_axis(results):
        found = results.misfit.get("axes", {}).get(axis, {})
        if not found.get("misfit"):
            continue
        yield Plate(
            f"misfit-shares-{slug(axis)}",
            "misfit",
            f"Share of the squared misfit of axis {axis} above the noise in each bin, and share of the samples (of the "
            "bandwidth, for frequency and lines) in it. A bar that reaches beyond its tick misfits more than its due.",
            partial(misfit.shares_height, misfit=found),
            partial(misfit.draw_shares, misfit=found),
        )
        if found["map"]:
            yield Plate(
                f"misfit-map-{slug(axis)}",
                "misfit",
                f"RMSE of axis {axis} where {found['map']['rows']} and {found['map']['columns']}, which tell most, "
                "cross; the number is the share of the misfit, %. Grey: no samples.",
                partial(misfit.map_height, misfit=found),
                partial(misfit.draw_misfit_map, misfit=found),
            )
        if failing := misfit.failing(found, traces):
            yield Plate(
                f"misfit-worst-{slug(axis)}",
                None,
                f"The stretches with most of the misfit of axis {axis}: in time, and on the measured loop.",
                partial(misfit.worst_height, records=len(failing)),
                partial(misfit.draw_worst, misfit=found, traces=failing),
            )


def _search_plates(results: Results) -> Iterator[Plate]:
    yield Plate(
        "convergence",
        "convergence",
        "Best RMSE on the identify records so far, before the polish: median and quartiles over the repeats of each "
        "optimizer.",
        search.convergence_height,
        partial(search.draw_convergence, results=results),
    )
    if free := search.free_parameters(results):
        yield Plate(
            "estimates",
            "parameters",
            "Where every run put each free parameter between its bounds. A parameter whose estimates scatter over the "
            "whole box is one that the data do not determine. Logarithmic (log) where the bounds span two decades or "
            "more.",
            partial(search.estimates_height, parameters=len(free)),
            partial(search.draw_estimates, results=results),
        )
    for name, entries in standing(results).items():
        yield Plate(
            f"density-{slug(name)}",
            "parameters",
            f"{name} of the best run over the drive that each stands for.",
            density_figures.height,
            partial(density_figures.draw, name=name, entries=entries),
        )
    names, _ = search.correlation(results)
    if names:
        yield Plate(
            "correlation",
            "correlations",
            "Correlations of the best run's estimates; grey where there is none to give.",
            partial(search.correlation_height, longest=max(map(len, names)), parameters=len(names)),
            partial(search.draw_correlation, results=results),
        )


def _by_axis(results: Results) -> list[tuple[str, list[Trace]]]:
    return [(axis, [trace for trace in results.traces if trace.axis == axis]) for axis in results.axes]
