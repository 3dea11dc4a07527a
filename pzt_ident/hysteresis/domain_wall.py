"""The domain wall model: pinned walls that bend reversibly and jump irreversibly."""

from math import nan

from pzt_ident.block import Block, Place, expm1
from pzt_ident.parameter import Parameter
from pzt_ident.registry import blocks


@blocks.register
class DomainWall(Block):
    """y = b P,  P = c P_an + (1 - c) P_irr,  P_an = P_s tanh((E + alpha P) / a),
    dP_irr/dE = g / (k - alpha g), g = max(sign(dE) (P_an - P_irr), 0).

    Smith & Salapaka, Model Development for the Positioning Mechanisms in an Atomic Force Microscope, eqs. 3 to 8, u
    for E and P over P_s. P is solved for at each stage of a fourth-order Runge-Kutta step in E. Begins unpolarized at
    no field. Where g comes to k / alpha (against eq. 9) the walls run away; here they then jump, at most onto the
    anhysteretic curve. A candidate with c alpha P_s >= a, for which P has no single solution, fails. Minor loops do not
    close, as in all models of this kind.
    """

    place = Place.OPERATOR
    saturation = Parameter("response", (0, 20), "Response at the saturation polarization, b P_s.")
    width = Parameter("drive", (0.05, 100), "Field over which the anhysteretic polarization rises, a.", scale="log")
    coupling = Parameter("1", (0, 1), "Field of the saturated neighbourhood over the width, alpha P_s / a.")
    pinning = Parameter("drive", (1e-3, 10), "Field that the walls are pinned by, k.", scale="log")
    reversible = Parameter("1", (0, 1), "Share of the polarization that bends back, c.")

    def prepare(saturation, width, coupling, pinning, reversible):
        runs_away = reversible * coupling >= 1
        return nan if runs_away else saturation, 1 / width, coupling, pinning / width, reversible

    def start(u, saturation, per_width, coupling, pinning, reversible):
        return pinned(0.0, 0.0, u, per_width, coupling, pinning, reversible), u

    def step(pin, before, u, saturation, per_width, coupling, pinning, reversible):
        pin = pinned(pin, before, u, per_width, coupling, pinning, reversible)
        an = anhysteretic(pin, u, per_width, coupling, reversible)
        return pin, u, saturation * (reversible * an + (1 - reversible) * pin)


def pinned(pin, before, u, per_width, coupling, pinning, reversible):
    """P_irr / P_s at u."""
    move = u - before
    middle = before + 0.5 * move
    s1 = slope(pin, before, move, per_width, coupling, pinning, reversible)
    s2 = slope(pin + 0.5 * move * per_width * s1, middle, move, per_width, coupling, pinning, reversible)
    s3 = slope(pin + 0.5 * move * per_width * s2, middle, move, per_width, coupling, pinning, reversible)
    s4 = slope(pin + move * per_width * s3, u, move, per_width, coupling, pinning, reversible)
    moved = move * per_width * (s1 + 2 * (s2 + s3) + s4) / 6
    ahead = anhysteretic(pin, u, per_width, coupling, 1.0) - pin
    return pin + (min(moved, max(ahead, 0 * ahead)) if move >= 0 else max(moved, min(ahead, 0 * ahead)))


def slope(pin, u, move, per_width, coupling, pinning, reversible):
    sign = 1.0 if move >= 0 else -1.0
    ahead = sign * (anhysteretic(pin, u, per_width, coupling, reversible) - pin)
    ahead = ahead if ahead > 0 else 0 * ahead
    return ahead / max(pinning - coupling * ahead, 1e-3 * pinning)


def anhysteretic(pin, u, per_width, coupling, reversible):
    """p = tanh((u + alpha P_s (c p + (1 - c) p_irr)) / a) by Newton's method; it contracts, so it has one solution."""
    at = u * per_width + coupling * (1 - reversible) * pin
    inner = coupling * reversible
    p = tanh(at)
    for _ in range(6):
        value = tanh(at + inner * p)
        p = p - (p - value) / (1 - inner * (1 - value * value))
    return p


def tanh(x):
    x = min(max(x, -20.0), 20.0)
    grown = expm1(2 * x)
    return grown / (grown + 2)
