"""Slow twins of thermal activation: the kernel by quadrature and in closed form, and relays stepped without a table."""

import numpy as np
from scipy.integrate import quad
from scipy.special import dawsn, erf, erfcx, ndtr, ndtri


def energies(field, eta, remanence, inflection):
    """The Gibbs energy of the branch up and of the one in the middle. Smith et al. (stage mechanisms), eq. 1."""
    up = lambda p: 0.5 * eta * (p - remanence) ** 2 - field * p  # noqa: E731
    middle = lambda p: 0.5 * eta * (inflection - remanence) * (p**2 / inflection - remanence) - field * p  # noqa: E731
    return up, middle


def by_quadrature(field, eta, remanence, inflection, per_kt, shell):
    """(<P+>, p+- T) of the Boltzmann density, eqs. 9 and 10; per_kt is V / kT."""
    up, middle = energies(field, eta, remanence, inflection)
    width = 1 / np.sqrt(per_kt * eta)
    top = max(inflection, remanence + field / eta)
    zero = up(top)

    def integral(function, low, high):
        return quad(function, low, high, epsabs=0, epsrel=1e-12, limit=400)[0]

    ends = inflection, top + 40 * width
    whole = integral(lambda p: np.exp(-per_kt * (up(p) - zero)), *ends)
    first = integral(lambda p: (p - inflection) * np.exp(-per_kt * (up(p) - zero)), *ends)
    through = integral(lambda p: np.exp(-per_kt * (middle(p) - zero)), inflection - shell, inflection)
    return inflection + first / whole, through / (through + whole)


def closed_form(field, eta, remanence, inflection, per_kt, shell):
    """The same by erfcx and Dawson's function D: N = (D(y1) - exp(y0^2 - y1^2) D(y0)) / q."""
    width = 1 / np.sqrt(per_kt * eta)
    at = remanence + field / eta
    tail = erfcx((inflection - at) / width / np.sqrt(2))
    bend = eta * (remanence - inflection) / inflection
    q = np.sqrt(per_kt * bend / 2)
    y1, y0 = q * (inflection + field / bend), q * (inflection - shell + field / bend)
    through = (dawsn(y1) - np.exp(y0**2 - y1**2) * dawsn(y0)) / q
    return at + width * np.sqrt(2 / np.pi) / tail, through / (through + width * np.sqrt(np.pi / 2) * tail)


def thermal(field, dt, eta, remanence, coercive, spread, interaction, width, dwell, poled, nodes=64, bins=64):
    """P over the field, domain by domain, with the rates in closed form at every sample; width is s.

    The same nodes as the model: equal probabilities below eta P_R, and bins of interaction fields over eight sigma.
    """
    limit = eta * remanence
    below = ndtr(np.log(limit / coercive) / spread)
    fields = coercive * np.exp(spread * ndtri((np.arange(nodes) + 0.5) / nodes * below))[:, None]
    step = 8 * interaction / bins
    edges = step * np.arange(-bins // 2, bins // 2 + 1)
    centre = (edges[1:] + edges[:-1]) / 2
    weight = below * np.diff(ndtr(edges / interaction)) / erf(4 / np.sqrt(2)) / nodes
    inflection, per_kt = remanence - fields / eta, 1 / (eta * width**2)
    start = plays_of(field[0], fields, poled)
    up = np.clip((edges[1:] + start) / step, 0, 1)
    before, result = field[0], []
    for now in field:
        middle, before = (before + now) / 2, now
        with np.errstate(over="ignore", invalid="ignore"):
            rates = [
                np.nan_to_num(closed_form(sign * (middle + centre), eta, remanence, inflection, per_kt, 0.1 * width)[1])
                for sign in (1, -1)
            ]
            here, there = (
                closed_form(sign * (now + centre), eta, remanence, inflection, per_kt, 0.1 * width)[0]
                for sign in (1, -1)
            )
        both = np.maximum(sum(rates), 1e-300) / dwell
        rest = rates[1] / np.maximum(sum(rates), 1e-300)
        up = rest + (up - rest) * np.exp(-both * dt) if result else up
        switching = up * (here - (now + centre) / eta) - (1 - up) * (there + (now + centre) / eta)
        result.append(now / eta + np.sum(switching @ weight))
    return np.array(result)


def plays_of(first, fields, poled):
    return np.maximum(first - fields, np.minimum(first + fields, np.clip(0.0, poled - fields, poled + fields)))
