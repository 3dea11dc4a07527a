"""What a user sees, and which effects show it: measured on what each effect leaves on the standard drives."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from pzt_ident.atlas.stage import LEVELS, SPAN, STROKE, Array, drives
from pzt_ident.atlas.traces import Traced, traced
from pzt_ident.model.registry import blocks

SHOWN = 0.35  # strength from which an effect is listed


class Symptom(NamedTuple):
    """A sentence, and its strength in the traces of an effect, from 0 to 1."""

    sentence: str
    strength: Callable[[Traced], float]


def rests(traces: Traced) -> float:
    return traces.size("rest") / traces.largest


def goes_on(traces: Traced) -> float:
    """The change from the beginning to the end of the holds over that of the whole record."""
    drive, left = drives()["holds"], traces.left["holds"]
    still = np.flatnonzero(np.diff(drive.u) != 0)
    starts = [group[-1] + 1 for group in np.split(still, np.flatnonzero(np.diff(still) > 1) + 1)]
    hold = int(20 / drive.dt)
    pieces = [left[start : start + hold] for start in starts[: len(LEVELS)]]
    moved = [abs(piece[-50:].mean() - piece[:10].mean()) for piece in pieces if piece.size > 100]
    return float(min(1.0, 2 * np.mean(moved) / (np.ptp(left) or 1))) * _present(traces, "holds")


def bends(traces: Traced) -> float:
    """The share of what is left on slow loops that is one function of the drive with few changes of sign."""
    curve, share = _function_of(drives()["loops"].u, traces.left["loops"])
    return share * (_crossings(curve) < RIPPLES) * _present(traces, "loops")


def ripples(traces: Traced) -> float:
    """The share that is one function of the displacement with many changes of sign."""
    curve, share = _function_of(traces.bare["loops"], traces.left["loops"])
    return share * (_crossings(curve) >= RIPPLES) * _present(traces, "loops")


def branches(traces: Traced) -> float:
    """The share of what is left on the outer loop that has the other sign on the other branch."""
    loops, left = drives()["loops"].u, traces.left["loops"]
    rise, fall = slice(1000, 1500), slice(500, 1000)
    assert loops[1000] == loops.min() and loops[500] == loops[1500] == loops.max()
    up, down = left[rise], left[fall][::-1]
    odd = np.sum((up - down) ** 2) / (2 * np.sum(up**2 + down**2) or 1)
    return float(odd) * _present(traces, "loops")


def rate(traces: Traced) -> float:
    """How differently slow loops and fast ones along the same path are left, or how much only steps leave."""
    if not {"fast", "loops"} <= traces.left.keys():
        return 0.0
    apart = float(np.sqrt(np.mean((traces.left["fast"] - traces.left["loops"]) ** 2)) / STROKE)
    return max(min(1.0, apart / traces.largest), _more(traces, "steps", "loops"))


def high(traces: Traced) -> float:
    return _more(traces, "sweep", "loops")


def line(traces: Traced) -> float:
    """The share of the spectrum under a sine that is between its harmonics."""
    left = traces.left["tone"]
    power = np.abs(np.fft.rfft(left * np.hanning(left.size))) ** 2
    order = np.fft.rfftfreq(left.size, drives()["tone"].dt) / 10
    between = (np.abs(order - np.round(order)) > 0.12) & (order > 0.5)
    return float(power[between].sum() / (power[order > 0.5].sum() or 1)) * _present(traces, "tone")


def other_axis(traces: Traced) -> float:
    return _more(traces, "other", "loops")


def amplitude(traces: Traced) -> float:
    """How differently the slope of what is left goes with the drive in small loops and in large ones."""
    small, large = (np.polyfit(drives()[name].u, traces.left[name], 1)[0] for name in ("small", "loops"))
    return float(min(1.0, abs(small - large) * SPAN / (8 * traces.largest * STROKE)))


def later(traces: Traced) -> float:
    """How much of what is left on equal periods goes with the drive in the first of them otherwise than in the last."""
    u, left = drives()["tone"].u, traces.left["tone"]
    third = u.size // 3
    first, last = (np.polyfit(u[part], left[part], 1)[0] for part in (slice(third), slice(-third, None)))
    moved = abs(first - last) / 2 * np.std(u)
    return float(min(1.0, moved / (np.std(left) or 1))) * _present(traces, "tone")


RIPPLES, BINS = 8, 100  # changes of sign over the range, and bins of it

SYMPTOMS = (
    Symptom("The stage moves though nothing is driven.", rests),
    Symptom("The stage goes on moving while the drive holds still.", goes_on),
    Symptom("Slow loops and fast ones do not fit one model: the residual changes with the rate.", rate),
    Symptom("The loop is wider or narrower than the model's: the residual changes sign with the direction.", branches),
    Symptom("The residual is one bent curve over the drive, the same on both branches.", bends),
    Symptom("The residual is a ripple along the displacement, the same on both branches.", ripples),
    Symptom("The gain differs between small loops and large ones.", amplitude),
    Symptom("The gain differs between the first of equal loops and the last.", later),
    Symptom("Slow loops fit, but a small multisine does not: lag, phase or resonance.", high),
    Symptom("The spectrum has a line that is no harmonic of the drive.", line),
    Symptom("The stage moves with the drive of another axis.", other_axis),
)


def table() -> list[tuple[str, list[tuple[str, float]]]]:
    """Each symptom with the effects that show it, the clearest first."""
    rows = []
    for symptom in SYMPTOMS:
        strengths = [(word, symptom.strength(traced(word))) for word in blocks.effects()]
        seen = [(word, strength) for word, strength in strengths if strength >= SHOWN]
        rows.append((symptom.sentence, sorted(seen, key=lambda item: -item[1])))
    return rows


def _present(traces: Traced, drive: str) -> float:
    """Near 1 where a drive shows the effect about as well as any, near 0 where it hides it."""
    return min(1.0, 3 * traces.size(drive) / traces.largest)


def _more(traces: Traced, drive: str, other: str) -> float:
    """Near 1 where what is left is much larger on one drive than on another."""
    a, b = traces.size(drive), traces.size(other)
    return max(0.0, 1 - 1.5 * b / a) * _present(traces, drive) if a > 0 else 0.0


def _function_of(x: Array, left: Array) -> tuple[Array, float]:
    """The mean over both branches in BINS bins of a signal, and its share of the power."""
    bins = np.minimum(((x - x.min()) / np.ptp(x) * BINS).astype(int), BINS - 1)
    mean = np.bincount(bins, left, BINS) / np.maximum(np.bincount(bins, minlength=BINS), 1)
    return mean, float(np.sum(mean[bins] ** 2) / (np.sum(left**2) or 1))


def _crossings(curve: Array) -> int:
    return int(np.sum(np.diff(np.sign(curve[np.abs(curve) > 0.1 * np.abs(curve).max()])) != 0))
