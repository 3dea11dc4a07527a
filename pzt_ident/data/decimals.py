"""The last decimal to which values were rounded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SMALLEST = 15  # decimals


def last_bit(values: NDArray[np.float64]) -> float:
    """What the last bit of the largest of the values is worth."""
    return float(np.spacing(np.abs(values).max()))


def last_decimal(values: NDArray[np.float64], most: float) -> float:
    """The coarsest power of ten up to `most` of which all values are multiples, as far as their last bit tells; 0 where
    none is."""
    for exponent in range(SMALLEST + 1):
        decimal = 10.0**-exponent
        blurred = last_bit(values) / decimal / 2
        if decimal > most or blurred >= 0.2:
            continue
        counts = values * 10.0**exponent
        if np.abs(counts - np.round(counts)).max() < 1e-3 + blurred:
            return decimal
    return 0.0
