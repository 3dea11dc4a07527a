"""Spectrum of the residual, and frequency response of the stage and of its model."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.notation import unit
from pzt_ident.data.signals import Trace
from pzt_ident.run.results import read_results

Array = NDArray[np.float64]
SEGMENTS = 8  # of a record, half overlapping
MOVED = 1e-6  # of the largest power of the drive: below it says nothing of a response
MOST = 2000  # points of a spectrum
ON_PAPER = 600  # points of all spectra of a report


def spectra(run: Path) -> dict[str, Any]:
    """Of each record and axis: amplitude density of the residual, unit/sqrt(Hz), and the quotient of the cross spectrum
    of drive and response over the power of the drive (H1), measured and of the model, with the coherence; None where
    the drive has no power. Welch (1967), Hann windows."""
    return {"records": [spectrum_of(trace) for trace in read_results(run).traces]}


def printed_spectra(traces: Sequence[Trace]) -> list[dict[str, Any]]:
    """Of each trace, with few points and digits, for a page that holds all it shows."""
    most = max(ON_PAPER // max(len(traces), 1), 60)
    return [{key: _rounded(content) for key, content in spectrum_of(trace, most).items()} for trace in traces]


def _rounded(content: Any) -> Any:
    if isinstance(content, dict):
        return {key: _rounded(value) for key, value in content.items()}
    return [float(f"{value:.4g}") for value in content] if isinstance(content, np.ndarray) else content


def spectrum_of(trace: Trace, most: int = MOST) -> dict[str, Any]:
    scored = slice(int(np.argmax(trace.scored)), None)
    drive, response, model = (getattr(trace, name)[scored] for name in ("drive", "response", "model"))
    residual = trace.residual[scored]
    rate = (trace.time.size - 1) / float(trace.time[-1] - trace.time[0])
    size = min(residual.size, max(8, 2 * residual.size // (SEGMENTS + 1)))
    frequency = np.fft.rfftfreq(size, 1 / rate)
    spectra = densities([drive, residual, response, model], [(0, 0), (1, 1), (2, 2), (0, 2), (0, 3)], size, rate)
    power, residual_power, response_power = spectra[:3].real
    cross_spectra = dict(zip(("measured", "model"), spectra[3:], strict=True))
    lines = np.unique(np.geomspace(1, frequency.size - 1, min(most, frequency.size - 1)).astype(int))
    driven = power[lines] > MOVED * power.max()
    spectrum: dict[str, Any] = {
        "name": trace.record,
        "use": trace.use,
        "axis": trace.axis,
        "unit": unit(trace.unit),
        "driveUnit": unit(trace.drive_unit),
        "frequency": frequency[lines],
        "residual": np.sqrt(residual_power[lines]),
        "coherence": where(
            driven, np.abs(cross_spectra["measured"][lines]) ** 2 / (power * response_power)[lines].clip(1e-300)
        ),
    }
    for name, cross in cross_spectra.items():
        quotient = cross[lines] / power[lines].clip(1e-300)
        spectrum[name] = {
            "amplitude": where(driven, np.abs(quotient)),
            "phase": where(driven, np.degrees(np.angle(quotient))),
        }
    return spectrum


def densities(
    signals: Sequence[Array], pairs: Sequence[tuple[int, int]], size: int, rate: float
) -> NDArray[np.complex128]:
    """One-sided cross spectral densities of pairs of signals, the products of their units over Hz: (pairs, lines). Of
    half overlapping segments of so many samples, one after the other. Welch (1967); SciPy's module takes a second to
    import."""
    sums, starts = (
        np.zeros((len(pairs), size // 2 + 1), complex),
        range(0, signals[0].size - size + 1, size - size // 2),
    )
    for start in starts:
        lines = transforms(np.array([values[start : start + size] for values in signals]))
        for place, (first, second) in enumerate(pairs):
            sums[place] += lines[first].conj() * lines[second]
    sums *= 2 / (len(starts) * rate)
    return sums


def transforms(values: Array) -> NDArray[np.complex128]:
    """Fourier transforms of signals (signals, samples), each less its straight line and under a Hann window of unit
    power: (signals, lines)."""
    size = values.shape[1]
    time = np.arange(size) - (size - 1) / 2
    slopes = values @ time / max(time @ time, 1e-300)
    level = values - values.mean(axis=1, keepdims=True) - np.outer(slopes, time)
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(size) / size)
    lines = np.fft.rfft(level * window / np.sqrt((window @ window).clip(1e-300)), axis=1)
    lines[:, [0] if size % 2 else [0, -1]] /= np.sqrt(2)  # of a real signal they come once
    return lines


def where(driven: NDArray[np.bool_], values: Array) -> Array:
    """NaN where the drive has no power."""
    return np.where(driven, values, np.nan)
