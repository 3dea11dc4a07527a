"""How hysteresis grows with the rate of the drive, in every operator that it does so in."""

from math import log

from pzt_ident.model.block import expm1, log1p

RATE = 100.0  # V/s, drive rate at which `rate` changes nothing
SLOW = 0.01  # V/s, below which nothing changes with the logarithm of the rate
FASTEST = 1e5  # V/s, above which no `onset` is looked for, and from which on nothing levels off


def rate_terms(rate, onset, exponent, level, dt):
    """Coefficients of `growth` for samples dt apart."""
    fast, per = RATE + onset, 1 / level if level < FASTEST else 0.0
    root = 1 / exponent if exponent != 0 else 0.0
    return rate / log(10), 1 / (dt * fast), onset / fast, exponent, root, per / dt, RATE * per / (1 + RATE * per)


def growth(distance, rate, faster, slow, exponent, root, per, share):
    """rate L of a step of length |du|, L = log10((|du/dt| + onset) / (RATE + onset)); with an exponent
    rate (10^(exponent L) - 1) / (exponent log 10), and with a level rate 4 / log 10 times what x / (1 + x) is more than
    at RATE, x = |du/dt| / level."""
    decades = log1p(distance * faster + slow - 1)
    levelled = 4 * (distance * per / (1 + distance * per) - share)
    return rate * (levelled if per > 0 else root * expm1(exponent * decades) if exponent != 0 else decades)
