"""Slow twins of the homogenized energy model: every domain a relay, and every coercive field a play."""

import numpy as np
from scipy.special import erf, ndtri

from twins.prandtl_ishlinskii_twin import play


def relays(field, coercive, interaction, poled=0.0):
    """Share of domains up less share down: relays of thresholds +-Ec - EI, all pairs of the two arrays alike.

    Smith et al. (stage mechanisms), eqs. 7 and 14, in the limit of no saturation in the interaction field. Taken from
    the virgin state (up where EI > 0) to `poled` and from there to the first sample.
    """
    up = np.broadcast_to(interaction > 0, (len(coercive), len(interaction)))
    shares = []
    for e in [poled, *field]:
        effective = e + interaction
        up = np.where(effective >= coercive[:, None], True, np.where(effective <= -coercive[:, None], False, up))
        shares.append(2 * up.mean() - 1)
    return np.array(shares[1:])


def plays(field, coercive, readout, poled=0.0):
    """Mean over the coercive fields of the readout of their plays."""
    return np.mean([readout(play([poled, *field], half))[1:] for half in coercive], axis=0)


def quantiles(nodes):
    """Of the standard normal, at nodes of equal probability."""
    return ndtri((np.arange(nodes) + 0.5) / nodes)


def homogenized_energy(
    field, gain, remanence, coercive, spread, interaction, quadratic=0.0, poled=0.0, bias=0.0, nodes=64
):
    """a1 (P - P_R) + a2 (P - P_R)^2, by plays with the normal distribution as readout."""
    field, poled = np.asarray(field) - bias, poled - bias
    fields = coercive * np.exp(spread * quantiles(nodes))
    share = plays(field, fields, lambda p: erf(p / np.sqrt(2) / interaction), poled)
    worth = field + remanence * (share - 1)
    return gain * worth + quadratic * worth**2
