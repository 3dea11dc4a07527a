"""How hysteresis grows with the rate of the drive, in every operator that it does so in."""

from math import log

from pzt_ident.model.block import expm1, log1p

RATE = 100.0  # V/s, drive rate at which `rate` changes nothing
SLOW = 0.01  # V/s, below which nothing changes with the logarithm of the rate
FASTEST = 1e5  # V/s, above which no `onset` is looked for


def rate_terms(rate, onset, exponent, dt):
    """Coefficients of `growth` for samples dt apart."""
    fast = RATE + onset
    return rate / log(10), 1 / (dt * fast), onset / fast, exponent, 1 / exponent if exponent != 0 else 0.0


def growth(distance, rate, faster, slow, exponent, root):
    """rate L of a step of length |du|, L = log10((|du/dt| + onset) / (RATE + onset)); with an exponent
    rate (10^(exponent L) - 1) / (exponent log 10)."""
    decades = log1p(distance * faster + slow - 1)
    return rate * (root * expm1(exponent * decades) if exponent != 0 else decades)
