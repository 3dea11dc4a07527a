"""The pictures of a word: loop, steps and spectrum, each on the standard drive on which it shows most."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.atlas.drawing import WIDTH, Curve, Panel, drawing
from pzt_ident.atlas.shown import shown
from pzt_ident.atlas.stage import PERIOD, SPAN, STROKE, Array, drives
from pzt_ident.atlas.traces import Traced, traced
from pzt_ident.model.registry import blocks, word_of

Complex = NDArray[np.complex128]

LOOPS, STEPS, SWEEPS = ("loops", "fast", "other"), ("holds", "steps", "rest"), ("sweep", "other_sweep")
MAIN, STRIP = 150, 62
SMALL, LOWER = 236, 0.65  # width of a small picture, and share of the heights of a large one
STYLES = ("bare", "with")
ROUNDING = 1e-9  # of the usual gain
FLAT = 0.02  # least change of a frequency response, or of the lines of a spectrum, that is worth its picture
NEARLY = 0.8  # of the largest change, from which the drive that comes first is taken
HIDDEN = 1e-3  # of the stroke: a change that is not seen
DENSE = 200  # swings in one picture that the eye no longer tells apart


class View(NamedTuple):
    """What a picture shows; change: how much the word changes it, 1 for all of it."""

    name: str
    caption: str
    change: float
    panels: list[Panel]
    x_label: str
    log: bool = False


class Picture(NamedTuple):
    """An SVG with its caption; name: prefix of the ids of its curves; change: as of its view."""

    svg: str
    caption: str
    change: float
    name: str


@cache
def pictures(item: str) -> list[Picture]:
    """Loop, steps and spectrum of an item."""
    return [_picture(view, f"{item}-{view.name}") for view in views(item)]


@cache
def small_pictures(item: str) -> list[Picture]:
    """The same, small; their curves have no ids."""
    low = [
        view._replace(panels=[panel._replace(height=round(LOWER * panel.height)) for panel in view.panels])
        for view in views(item)
    ]
    return [_picture(view, "", SMALL) for view in low]


def _picture(view: View, name: str, width: int = WIDTH) -> Picture:
    svg = drawing(view.panels, view.x_label, name, view.caption, view.log, width)
    return Picture(svg, view.caption, view.change, name)


@cache
def views(item: str) -> list[View]:
    """Loop, steps and spectrum of an item."""
    traces, effect = traced(item), blocks.is_effect(word_of(item))
    of_loop, of_steps = _clearest(traces, LOOPS), _clearest(traces, STEPS, ("tone", "other"))
    found = [_loop(traces, of_loop, effect), _steps(traces, of_steps, effect), _spectrum(item, traces)]
    return [view for view in found if view]


def change(traces: Traced, name: str) -> float:
    return float(np.abs(traces.with_it[name] - traces.bare[name]).max() / STROKE)


def _clearest(traces: Traced, names: tuple[str, ...], others: tuple[str, ...] = ()) -> str:
    """The first drive on which the item shows nearly as much as on any, and not as a black band if there is a choice;
    one of the others where it shows on none."""
    possible = [name for name in names if name in traces.with_it]
    drawable = [name for name in possible if _swings(traces, name) < DENSE] or possible
    largest = max((change(traces, name) for name in drawable), default=0.0)
    if largest < HIDDEN and others:
        return _clearest(traces, others)
    return next(name for name in drawable if change(traces, name) >= NEARLY * largest)


def _swings(traces: Traced, name: str) -> int:
    difference = traces.with_it[name] - traces.bare[name]
    return int(np.sum(np.diff(np.sign(difference[np.abs(difference) > 0.1 * np.abs(difference).max()])) != 0))


def _displacements(traces: Traced, name: str) -> list[Array]:
    """Without the item and with it, um from where the stage rests without it."""
    return [1e6 * (y[name] - traces.bare[name][0]) for y in (traces.bare, traces.with_it)]


def _strip(traces: Traced, name: str, x: Array, effect: bool) -> Panel:
    label = "left after a refit, nm" if effect else "difference, nm"
    return Panel(
        [Curve("zero", x[[0, -1]] if x.size else x, np.zeros(2)), Curve("left", x, 1e9 * traces.left[name])],
        label,
        STRIP,
    )


def _loop(traces: Traced, name: str, effect: bool) -> View:
    drive = drives()[name]
    curves = [Curve(style, drive.u, y) for style, y in zip(STYLES, _displacements(traces, name), strict=True)]
    strip = _strip(traces, name, drive.u, effect)
    strip = strip._replace(curves=[Curve("zero", np.array([0, SPAN]), np.zeros(2)), strip.curves[1]])
    panels = [Panel(curves, "displacement, µm", MAIN), strip]
    return View("loop", f"Loop: {drive.title}", change(traces, name), panels, "drive, V")


def _steps(traces: Traced, name: str, effect: bool) -> View:
    drive = drives()[name]
    scale, unit = (1e3, "ms") if drive.time[-1] < 1 else (1.0, "s")
    t = scale * drive.time
    curves = [Curve(style, t, y) for style, y in zip(STYLES, _displacements(traces, name), strict=True)]
    panels = [Panel(curves, "displacement, µm", MAIN), _strip(traces, name, t, effect)]
    return View("steps", f"In time: {drive.title}", change(traces, name), panels, f"time, {unit}")


def _spectrum(item: str, traces: Traced) -> View | None:
    """The frequency response on a sweep, or the spectrum under one sine where that tells more."""
    sweeps = [name for name in SWEEPS[: shown(item).stage.axes] if name in traces.with_it]
    responses = {name: [frequency_response(name, y[name]) for y in (traces.bare, traces.with_it)] for name in sweeps}
    changes = {name: _shape_change(*pair) for name, pair in responses.items()}
    best = max(changes, key=lambda name: changes[name], default="")
    lines = _line_change(traces) if "tone" in traces.with_it else 0.0
    if best and changes[best] >= max(lines, FLAT) and _repeats(best, traces, changes[best]):
        return _bode(best, responses[best], changes[best])
    return _lines(traces, lines) if lines else None


def frequencies(name: str) -> tuple[Array, Complex]:
    """Frequencies of the lines of a multisine, Hz, and the spectrum there of the last period of its drive."""
    drive = drives()[name]
    spectrum = _last_period(name, drive.other if name == "other_sweep" else drive.u)
    lines = np.flatnonzero(np.abs(spectrum) > 0.1 * np.abs(spectrum[1:]).max())
    lines = lines[lines > 0]
    return lines / PERIOD, spectrum[lines]


def frequency_response(name: str, y: Array, before: int = 0) -> Complex:
    """Displacement over the drive of the multisine at its lines, m/V, complex; so many periods before the last."""
    f, of_drive = frequencies(name)
    return _last_period(name, y, before)[np.round(f * PERIOD).astype(int)] / of_drive


def _last_period(name: str, signal: Array, before: int = 0) -> Complex:
    """Spectrum of a period at the end, less the line on which the signal has moved in it."""
    samples = round(PERIOD / drives()[name].dt)
    last = signal[signal.size - (before + 1) * samples - 1 :][: samples + 1]
    return np.fft.rfft(last[1:] - (last[-1] - last[0]) * np.arange(1, samples + 1) / samples)


def _repeats(name: str, traces: Traced, size: float) -> bool:
    """Whether what changes a frequency response by this much is the same in the period before."""
    last, previous = (frequency_response(name, traces.with_it[name], before) for before in (0, 1))
    return bool(np.linalg.norm(last - previous) < size / 2 * np.linalg.norm(last))


def _shape_change(bare: Complex, with_it: Complex) -> float:
    """Relative change of a frequency response, but for its gain; of none, the gain that appears over the usual one."""
    if np.abs(bare).max() < ROUNDING * STROKE / SPAN:
        return float(np.median(np.abs(with_it)) / (STROKE / SPAN))
    gain = np.abs(np.vdot(bare, with_it)) / np.vdot(bare, bare).real
    return float(np.linalg.norm(with_it - gain * bare) / np.linalg.norm(bare))


def _bode(name: str, pair: list[Complex], size: float) -> View:
    drive, f = drives()[name], frequencies(name)[0]
    gains, phases = [], []
    for style, response in zip(STYLES, pair, strict=True):
        known = np.abs(response) > ROUNDING * STROKE / SPAN
        gains.append(Curve(style, f[known], 1e9 * np.abs(response[known])))
        phases.append(Curve(style, f[known], np.degrees(np.unwrap(np.angle(response[known])))))
    panels = [Panel(gains, "gain, nm/V", MAIN, True), Panel(phases, "phase, degrees", STRIP)]
    return View("spectrum", f"Frequency response: {drive.title}", size, panels, "frequency, Hz", True)


def _line_change(traces: Traced) -> float:
    """Relative change of the spectrum under a sine, beside its first line."""
    bare, with_it = (_amplitudes(y["tone"]) for y in (traces.bare, traces.with_it))
    first = int(np.argmax(bare))
    away = np.abs(np.arange(bare.size) - first) > 4
    return float(np.linalg.norm((with_it - bare)[away]) / bare[first])


def _amplitudes(y: Array) -> Array:
    """Of the lines from 1.5 to 125 Hz, half a hertz apart, m, in the last two seconds, by a Hann window."""
    last = y[-2000:]
    return 4 * np.abs(np.fft.rfft((last - last.mean()) * np.hanning(last.size)))[3:251] / last.size


def _lines(traces: Traced, size: float) -> View:
    drive, f = drives()["tone"], np.arange(3, 251) / 2
    curves = []
    for style, y, shift in zip(STYLES, (traces.bare, traces.with_it), (-0.4, 0.4), strict=True):
        sizes = 1e9 * _amplitudes(y["tone"])
        tall = np.flatnonzero(sizes > 0.5)
        x, top = np.repeat(f[tall] + shift, 3), np.column_stack([0 * tall + 0.5, sizes[tall], 0 * tall + 0.5]).ravel()
        curves.append(Curve(style, np.concatenate([[0], x, [126]]), np.concatenate([[0.5], top, [0.5]])))
    panel = Panel(curves, "amplitude, nm", MAIN + STRIP + 10, True)
    return View("spectrum", f"Spectrum: {drive.title}", size, [panel], "frequency, Hz")
