"""Slow twin of the Prandtl-Ishlinskii operator: a loop over plays and samples."""

import numpy as np


def play(drive, half_width, memory=0.0):
    """p_k = max(u_k - r, min(u_k + r, p_(k-1))), from the memory before the first sample (0 is virgin)."""
    result = []
    for u in drive:
        memory = max(u - half_width, min(u + half_width, memory))
        result.append(memory)
    return np.array(result)


def prandtl_ishlinskii(drive, gain, weights, half_widths):
    """gain u + sum_i w_i F_i[u] with F_i the play of half-width r_i, virgin at the start.

    Kuhnen (2003), Eur. J. Control 9, 407.
    """
    total = gain * np.asarray(drive, float)
    for weight, half_width in zip(weights, half_widths, strict=True):
        total = total + weight * play(drive, half_width)
    return total
