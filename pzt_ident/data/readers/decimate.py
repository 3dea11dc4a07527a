"""Decimation without aliasing."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

STOPBAND = 60.0
"""Attenuation from the new Nyquist frequency on, dB; the passband ends at 0.8 of it."""


def decimated(signal: NDArray[np.float64], step: int, periodic: bool = False) -> NDArray[np.float64]:
    """Every `step`-th sample, (samples,), after a zero-phase low-pass with unit gain at 0 Hz (Kaiser window).

    At its ends a periodic signal is continued periodically, any other point-symmetrically: offset and slope are kept.
    """
    if step == 1:
        return signal
    from scipy.signal import firwin, kaiserord, oaconvolve

    taps, beta = kaiserord(STOPBAND, 0.2 / step)
    half = taps // 2
    window = firwin(2 * half + 1, 0.9 / step, window=("kaiser", beta), scale=True)
    padding: dict[str, Any] = {"mode": "wrap"} if periodic else {"mode": "reflect", "reflect_type": "odd"}
    extended = np.pad(signal - signal[0], half, **padding)
    return signal[0] + oaconvolve(extended, window, mode="valid")[::step]
