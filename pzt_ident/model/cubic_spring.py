"""A spring that stiffens or softens with the cube of its deflection, at rest or in an implicit step."""

from pzt_ident.model.elementary import rough_inverse_cube_root

SOFTEST = 0.19  # limit of -c x^2, at which the slope of the spring is 0.43 of that at x = 0


def cubic_root(p, c, share):
    """The root x of x + share c x^3 = p: with s = x / p, s + z s^3 = 1, starting near s = 1.1 (1 + 3 z)^(-1/3)."""
    most = share * SOFTEST
    z = max(share * c * p * p, -most * (1 - most) * (1 - most))
    return p * halley_step(halley_step(halley_step(1.1 * rough_inverse_cube_root(1 + 3 * z), z), z), z)


def halley_step(s, z):
    """Halley's step for s + z s^3 - 1 = 0: after three the error is rounding for all z >= -1/8."""
    value, slope = s + z * s * s * s - 1, 1 + 3 * z * s * s
    return s - value * slope / (slope * slope - 3 * z * s * value)


def beside_spring(x, before, c, share):
    """The share with which a force enters a step beside the chord of the spring between two deflections."""
    chord = max(c * (x * x + x * before + before * before), -3 * SOFTEST)
    return share / (1 + share * chord)
