"""The list of figures of a run, and their files."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

from pzt_ident.data.signals import Trace
from pzt_ident.errors import RunError
from pzt_ident.files import replaced
from pzt_ident.report import density_figures
from pzt_ident.report import misfit_figures as misfit
from pzt_ident.report import residual_figures as residual
from pzt_ident.report import search_figures as search
from pzt_ident.report import signal_figures as signal
from pzt_ident.report import staircase_figures as staircase
from pzt_ident.report.room import make_room
from pzt_ident.report.sentences import USE_NAMES, distributed_parameters
from pzt_ident.report.style import COLUMN, PAGE, file_content, style
from pzt_ident.run.events import Listen, nobody
from pzt_ident.run.place import HERE, Place
from pzt_ident.run.results import Results, read_folder

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Plate:
    """One figure, not drawn yet. `section`: id of its section of the report, None where the report shows the same
    interactively; `height(width)` in mm; `draw` draws into a figure of that size. `parts`: attributes that some of its
    groups have on a page, by their ids (gid)."""

    name: str
    section: str | None
    caption: str
    height: Callable[[float], float]
    draw: Callable[[Figure], None]
    parts: Mapping[str, Mapping[str, str]] = field(default_factory=dict)


def plates(results: Results) -> list[Plate]:
    """All figures of these results, in the order of the report."""
    return [
        *_staircase_plates(results),
        *_signal_plates(results),
        *_residual_plates(results),
        *misfit_plates(results),
        *(_search_plates(results) if results.result else ()),
    ]


def drawn(plate: Plate, width: float, kind: type[Figure] | None = None) -> Figure:
    """A plate `width` mm wide, on a figure of this kind."""
    with style():
        from matplotlib.figure import Figure

        figure = (kind or Figure)(figsize=(width / 25.4, plate.height(width) / 25.4))
        plate.draw(figure)
        make_room(figure)
    return figure


def render(plate: Plate, width: float, forms: Sequence[str]) -> dict[str, bytes]:
    """The file content of a figure `width` mm wide for each format in `forms` (svg, pdf)."""
    figure = drawn(plate, width)
    with style():
        return {form: file_content(figure, form) for form in forms}


def write_page_figures(results: Results, folder: Path) -> list[tuple[Plate, bytes]]:
    """Write the static figures of the page as `<name>-180mm.svg`; returns each with its content."""
    return [(plate, write_plate(plate, PAGE, ("svg",), folder)["svg"]) for plate in plates(results) if plate.section]


def write_all_figures(folders: Sequence[Path], place: Place = HERE, listen: Listen = nobody) -> None:
    """Write all figures of several results for print, SVG and PDF at 88 and 180 mm, side by side; `listen` is told of
    each. Raises RunError where one cannot be drawn."""
    tasks = [
        (f"{folder}: {number}", (folder, number))
        for folder in folders
        for number in range(len(plates(read_folder(folder))))
    ]
    done = 0

    def note(name: str, result: object) -> None:
        nonlocal done
        done += 1
        listen({"event": "figures", "of": len(tasks), "done": done, "folder": ""})

    failed = place.run_all(draw_figure, (), tasks, nobody, note)
    for name, reason in failed.items():
        raise RunError(f"{name}: {reason}")


@lru_cache(maxsize=1)
def _results(folder: Path) -> Results:
    return read_folder(folder)


def draw_figure(tell: Listen, folder: Path, number: int) -> None:
    """Entry of a worker: a figure of the results in a folder."""
    for _ in _written([plates(_results(folder))[number]], folder / "figures"):
        pass


def write_misfit_figures(results: Results, folder: Path) -> Iterator[Plate]:
    """Write the figures of the misfit, SVG and PDF at 88 and 180 mm. Yields each one that is written."""
    return _written(misfit_plates(results), folder)


def _written(selection: Iterable[Plate], folder: Path) -> Iterator[Plate]:
    for plate in selection:
        for width in (COLUMN, PAGE):
            write_plate(plate, width, ("svg", "pdf"), folder)
        yield plate


def write_plate(plate: Plate, width: int, forms: Sequence[str], folder: Path) -> dict[str, bytes]:
    contents = render(plate, width, forms)
    for form, content in contents.items():
        with replaced(folder / f"{plate.name}-{width}mm.{form}") as temporary:
            temporary.write_bytes(content)
    return contents


def slug(text: str) -> str:
    """`text` as part of a file name."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:40]


def _staircase_plates(results: Results) -> Iterator[Plate]:
    if results.improvement:
        yield Plate(
            "staircase",
            None,
            "RMSE on the identification and on the validation records after each step, and the noise floor.",
            staircase.height,
            partial(staircase.draw, improvement=results.improvement),
        )


def _signal_plates(results: Results) -> Iterator[Plate]:
    floors = results.floors
    bins = max(150, min(600, 2400 // max(len(results.traces), 1)))
    for place, trace in enumerate(results.traces, start=1):
        yield Plate(
            "-".join(filter(None, (f"time-{place}", slug(trace.record), slug(trace.axis)))),
            None,
            f"Measured and modelled response of axis {trace.axis} and the residual: {trace.record} "
            f"({USE_NAMES[trace.use]}).",
            signal.time_height,
            partial(signal.draw_time, trace=trace, noise=floors.get(trace.axis), bins=bins),
        )
    for axis, traces in _by_axis(results):
        yield Plate(
            f"loops-{slug(axis)}",
            None,
            f"Measured and modelled response of axis {axis} against the drive.",
            partial(signal.records_height, records=len(traces)),
            partial(signal.draw_loops, traces=traces, points=3 * bins),
        )


def _residual_plates(results: Results) -> Iterator[Plate]:
    floors = results.floors
    for axis, traces in _by_axis(results):
        height = partial(signal.records_height, records=len(traces))
        yield Plate(
            f"residual-drive-{slug(axis)}",
            "residuals",
            f"Residual of axis {axis} against the drive, separately for rising and falling drive: median, and the "
            "band that contains 90 % of the samples.",
            height,
            partial(residual.draw_branches, traces=traces, noise=floors.get(axis)),
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
        "Distribution of the residual over the scored samples.",
        partial(residual.histogram_height, axes=len(results.axes)),
        partial(residual.draw_histogram, traces=results.traces, noise=floors),
    )


def misfit_plates(results: Results) -> Iterator[Plate]:
    """The figures of each axis that has a misfit above its noise floor."""
    for axis, traces in _by_axis(results):
        axis_misfit = results.misfit.get("axes", {}).get(axis, {})
        if not axis_misfit.get("misfit"):
            continue
        yield Plate(
            f"misfit-shares-{slug(axis)}",
            "misfit",
            f"Share of the squared misfit of axis {axis} above the noise in each bin (bar), and share of the samples "
            "(of the bandwidth, for frequency and lines) in it (tick). Where the bar exceeds the tick, the misfit is "
            "above average.",
            partial(misfit.shares_height, misfit=axis_misfit),
            partial(misfit.draw_shares, misfit=axis_misfit),
        )
        if crossed := axis_misfit["map"]:
            yield Plate(
                f"misfit-map-{slug(axis)}",
                "misfit",
                f"RMSE of axis {axis} by {crossed['rows']} and {crossed['columns']}, the two quantities on which the "
                "misfit depends most; the numbers are shares of the squared misfit in %. Grey: no samples.",
                partial(misfit.map_height, misfit=axis_misfit),
                partial(misfit.draw_misfit_map, misfit=axis_misfit),
            )
        if worst := misfit.traces_of_worst(axis_misfit, traces):
            yield Plate(
                f"misfit-worst-{slug(axis)}",
                None,
                f"The segments with the largest share of the misfit of axis {axis}: in time, and on the measured loop.",
                partial(misfit.worst_height, records=len(worst)),
                partial(misfit.draw_worst, misfit=axis_misfit, traces=worst),
            )


def _search_plates(results: Results) -> Iterator[Plate]:
    if search.optimizers(results):
        yield Plate(
            "convergence",
            "convergence",
            "Best RMSE on the identification records so far, before the local polish: median and quartiles over the "
            "repeats of each optimizer.",
            search.convergence_height,
            partial(search.draw_convergence, results=results),
        )
    if free := search.free_parameters(results):
        yield Plate(
            "estimates",
            "parameters",
            "Estimates of each free parameter from all runs, relative to its bounds. A parameter whose estimates "
            "scatter over the full range is not determined by the data. The scale is logarithmic (log) where the "
            "bounds span two decades or more.",
            partial(search.estimates_height, parameters=len(free)),
            partial(search.draw_estimates, results=results),
        )
    for name, entries in distributed_parameters(results).items():
        yield Plate(
            f"density-{slug(name)}",
            "parameters",
            f"{name} of the best run over the drive value to which each parameter belongs.",
            density_figures.height,
            partial(density_figures.draw, name=name, entries=entries),
        )
    names, _ = search.correlation(results)
    if names:
        yield Plate(
            "correlation",
            "correlations",
            "Correlations of the best run's estimates; grey: not defined.",
            partial(search.correlation_height, longest=max(map(len, names)), parameters=len(names)),
            partial(search.draw_correlation, results=results),
        )


def _by_axis(results: Results) -> list[tuple[str, list[Trace]]]:
    return [(axis, [trace for trace in results.traces if trace.axis == axis]) for axis in results.axes]
