"""Slow twins of the homogenized energy model: every domain a relay, and every coercive field a play."""

import numpy as np
from scipy.special import erf, ndtri
from scipy.stats import norm

from twins.prandtl_ishlinskii_twin import play


def relays(field, coercive, interaction, poled=0.0, shares=None):
    """Share of domains up less share down: relays of thresholds +-Ec - EI, of the coercive fields with these shares.

    Smith et al. (stage mechanisms), eqs. 7 and 14, in the limit of no saturation in the interaction field. Taken from
    the virgin state (up where EI > 0) to `poled` and from there to the first sample.
    """
    up = np.broadcast_to(interaction > 0, (len(coercive), len(interaction)))
    found = []
    for e in [poled, *field]:
        effective = e + interaction
        up = np.where(effective >= coercive[:, None], True, np.where(effective <= -coercive[:, None], False, up))
        found.append(2 * np.average(up.mean(axis=1), weights=shares) - 1)
    return np.array(found[1:])


def plays(field, coercive, readout, poled=0.0, shares=None):
    """Mean over the coercive fields, of these shares, of the readout of their plays."""
    return np.average([readout(play([poled, *field], half))[1:] for half in coercive], axis=0, weights=shares)


def quantiles(nodes):
    """Of the standard normal, at nodes of equal probability."""
    return ndtri((np.arange(nodes) + 0.5) / nodes)


def rule(nodes):
    """Places in units of the standard deviation, half as far apart again as the quantiles, and the shares of a normal
    density there."""
    places = 1.5 * quantiles(nodes)
    weights = norm.pdf(places) / norm.pdf(places / 1.5)
    return places, weights / weights.sum()


def homogenized_energy(
    field, gain, remanence, coercive, spread, interaction, quadratic=0.0, poled=0.0, bias=0.0, nodes=64
):
    """a1 (P - P_R) + a2 (P - P_R)^2, by plays with the normal distribution as readout."""
    field, poled = np.asarray(field) - bias, poled - bias
    places, shares = rule(nodes)
    fields = coercive * np.exp(spread * places)
    share = plays(field, fields, lambda p: erf(p / np.sqrt(2) / interaction), poled, shares)
    worth = field + remanence * (share - 1)
    return gain * worth + quadratic * worth**2
