"""The domain wall model: pinned walls that bend reversibly and jump irreversibly."""

from math import nan

from pzt_ident.errors import InputError
from pzt_ident.model.block import Bank, Place, expm1
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks

ANHYSTERETIC = (1.0, 0.0, 0.0, 0.0)
"""Share, field, worth and shift of P_an / P_s = tanh((E + alpha P) / a), before any rescaling; see `anhysteretic`."""

STEPS_TO_FIRST = 32  # of Runge and Kutta, from zero field to the first sample


@blocks.register
class DomainWall(Bank):
    """y = b P,  P = c P_an + (1 - c) P_irr,  P_an = P_s tanh((E + alpha P) / a),
    dP_irr/dE = g / (k - alpha g), g = max(sign(dE) (P_an - P_irr), 0).

    Smith & Salapaka, Model Development for the Positioning Mechanisms in an Atomic Force Microscope, eqs. 3 to 8, with
    u for E and P relative to P_s. P is solved for at each stage of a fourth-order Runge-Kutta step in E. A record
    begins unpolarized at zero field, from where it goes to the first drive. Where g reaches k / alpha, which violates
    eq. 9, the walls run away: they then jump, at most onto the anhysteretic curve, and the result reports it. A
    candidate with c alpha P_s >= a, for which P has no unique solution, fails. As in all models of this kind minor
    loops do not close, unless they are biased.

    What an actuator does beside its hysteresis adds b P_s / a times what it makes of the drive, the slope of P_an
    without a mean field.
    """

    place = Place.OPERATOR
    branches = 1
    solving = 2.5e-8
    violation = (
        "domain walls run away, against condition (9) of Smith & Salapaka, k > alpha |P_an - P_irr|: there the model "
        "jumps onto its anhysteretic curve. Raise `domain_wall.pinning`, lower `domain_wall.coupling` (with alpha P_s "
        "above a they always do), or sample the drive more finely"
    )
    minor_loops = Form("open", ("open", "biased"), "`biased` closes minor loops, eq. 5 of the paper.")
    saturation = Parameter("response", (0, 20), "Response at the saturation polarization, b P_s.")
    width = Parameter("drive", (0.05, 100), "Field over which the anhysteretic polarization rises, a.", scale="log")
    coupling = Parameter("1", (0, 1), "Mean field of the saturated polarization over the width, alpha P_s / a.")
    pinning = Parameter("drive", (1e-3, 10), "Pinning field of the walls, k.", scale="log")
    reversible = Parameter("1", (0, 1), "Share of the polarization from reversible bending of walls, c.")

    def refuse(least, most):
        if least.reversible < 0 or most.reversible > 1:
            raise InputError(
                f"a share from {least.reversible:g} to {most.reversible:g}",
                where="domain_wall.reversible",
                remedy="keep it between 0 and 1",
            )
        if least.reversible * least.coupling >= 1:
            raise InputError(
                f"c alpha P_s / a is {least.reversible * least.coupling:.3g} or more: no polarization is stable, the "
                "walls run away",
                where="domain_wall.coupling",
                remedy="keep `domain_wall.reversible` times `domain_wall.coupling` below 1: a smaller alpha or P_s, or "
                "a larger a",
            )

    def prepare(saturation, width, coupling, pinning, reversible):
        runs_away = reversible * coupling >= 1
        return nan if runs_away else saturation, 1 / width, coupling, pinning / width, reversible

    def start(u, saturation, per_width, coupling, pinning, reversible):
        return virgin(u, per_width, coupling, pinning, reversible), u

    def step(pin, before, u, saturation, per_width, coupling, pinning, reversible):
        pin, _ = irreversible_step(pin, before, u, ANHYSTERETIC, per_width, coupling, pinning, reversible)
        an = anhysteretic(pin, u, ANHYSTERETIC, per_width, coupling, reversible)
        return pin, u, saturation * (reversible * an + (1 - reversible) * pin - u * per_width)

    def output(u, total, saturation, per_width, coupling, pinning, reversible):
        return total + saturation * per_width * u


class Biased(DomainWall):
    """P_an is rescaled to pass through the reversal (E1, P1) at which a minor loop begins, and on the way back to it
    reflected through (E0, P0), halfway between that reversal and the next:
    P_an = g Pt(E, P) - (1 - g) P_s after a rise, P_an = 2 P0 - (g Pt(2 E0 - E, 2 P0 - P) - (1 - g) P_s) back,
    g = (P1 + P_s) / (Pt(E1, P1) + P_s), with Pt of eq. 4.

    Smith & Salapaka, eq. 5, for both directions. P is continuous, so P_irr = P at each reversal. On return to (E1, P1)
    the loop is closed and deleted, and the plain curve continues. A reversal on the way back replaces the first one: of
    nested loops the innermost closes. g is at most 1.
    """

    def start(u, saturation, per_width, coupling, pinning, reversible):
        pin = virgin(u, per_width, coupling, pinning, reversible)
        an = anhysteretic(pin, u, ANHYSTERETIC, per_width, coupling, reversible)
        way = 1.0 if u > 0 else -1.0 if u < 0 else 0.0
        return pin, u, reversible * an + (1 - reversible) * pin, way, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0

    def step(
        pin, before, p, way, side, end, p_end, share, field, worth, shift,
        u, saturation, per_width, coupling, pinning, reversible,
    ):  # fmt: skip
        loop, curve, _ = biased_step(
            pin, before, p, way, side, end, p_end, (share, field, worth, shift),
            u, per_width, coupling, pinning, reversible,
        )  # fmt: skip
        return *loop, *curve, saturation * (loop[2] - u * per_width)


class Margin(DomainWall):
    """The margin of eq. 9, (k - alpha g) / k, which must stay above zero."""

    def output(u, total, saturation, per_width, coupling, pinning, reversible):
        return total

    def step(pin, before, u, saturation, per_width, coupling, pinning, reversible):
        pin, margin = irreversible_step(pin, before, u, ANHYSTERETIC, per_width, coupling, pinning, reversible)
        return pin, u, margin


class BiasedMargin(Biased):
    """The margin of eq. 9 with biased minor loops."""

    output = Margin.output

    def step(
        pin, before, p, way, side, end, p_end, share, field, worth, shift,
        u, saturation, per_width, coupling, pinning, reversible,
    ):  # fmt: skip
        loop, curve, margin = biased_step(
            pin, before, p, way, side, end, p_end, (share, field, worth, shift),
            u, per_width, coupling, pinning, reversible,
        )  # fmt: skip
        return *loop, *curve, margin


DomainWall.forms = {"biased": Biased}
DomainWall.margin, Biased.margin = Margin, BiasedMargin


def biased_step(pin, before, p, way, side, end, p_end, curve, u, per_width, coupling, pinning, reversible):
    """State and anhysteretic curve of `Biased` at u, and the margin of eq. 9. way: direction of the field. side:
    direction in which the end of the minor loop (end, p_end) was reached, 0 outside of minor loops."""
    now = 1.0 if u > before else -1.0 if u < before else way
    turns = now * way < 0
    away, back = turns and side != -way, turns and side == -way
    pin = p if turns else pin
    end, p_end, side = (before, p, way) if away else (end, p_end, side)
    closed = side == now and side * (u - end) >= 0
    at = tanh((end if closed else before) * per_width + coupling * (p_end if closed else p))
    least = min((side * p + 1) / max(side * at + 1, 1e-12), 1.0)
    share, field, worth, shift = (least, 0.0, 0.0, p - least * at) if away else curve
    field, worth = ((end + before) * per_width, p_end + p) if back else (field, worth)
    shift = worth - shift if back else shift
    share, field, worth, shift = ANHYSTERETIC if closed else (share, field, worth, shift)
    pin = (p_end - reversible * at) / max(1 - reversible, 1e-12) if closed else pin
    before, side = (end, 0.0) if closed else (before, side)
    curve = share, field, worth, shift
    pin, margin = irreversible_step(pin, before, u, curve, per_width, coupling, pinning, reversible)
    an = anhysteretic(pin, u, curve, per_width, coupling, reversible)
    return (pin, u, reversible * an + (1 - reversible) * pin, now, side, end, p_end), curve, margin


def virgin(u, per_width, coupling, pinning, reversible):
    """P_irr / P_s at u, on the way there from an unpolarized state at zero field."""
    pin, step = 0.0, u / STEPS_TO_FIRST
    for i in range(STEPS_TO_FIRST):
        pin, _ = irreversible_step(
            pin, i * step, (i + 1) * step, ANHYSTERETIC, per_width, coupling, pinning, reversible
        )
    return pin


def irreversible_step(pin, before, u, curve, per_width, coupling, pinning, reversible):
    """P_irr / P_s at u by a Runge-Kutta step from `before`, and the least margin of eq. 9, 1 - alpha g / k, in it."""
    move = u - before
    walls = per_width, coupling, pinning, reversible
    s1, r1 = slope(pin, before, move, curve, *walls)
    s2, r2 = slope(pin + 0.5 * move * per_width * s1, before + 0.5 * move, move, curve, *walls)
    s3, r3 = slope(pin + 0.5 * move * per_width * s2, before + 0.5 * move, move, curve, *walls)
    s4, r4 = slope(pin + move * per_width * s3, u, move, curve, *walls)
    moved = move * per_width * (s1 + 2 * (s2 + s3) + s4) / 6
    ahead = anhysteretic(pin, u, curve, per_width, coupling, 1.0) - pin
    pin = pin + (min(moved, max(ahead, 0 * ahead)) if move >= 0 else max(moved, min(ahead, 0 * ahead)))
    return pin, min(r1, min(r2, min(r3, r4)))


def slope(pin, u, move, curve, per_width, coupling, pinning, reversible):
    """dP_irr/dE in units of P_s / a, and the margin of eq. 9."""
    sign = 1.0 if move >= 0 else -1.0
    ahead = sign * (anhysteretic(pin, u, curve, per_width, coupling, reversible) - pin)
    ahead = ahead if ahead > 0 else 0 * ahead
    margin = 1 - coupling * ahead / pinning
    return ahead / (pinning * max(margin, 1e-3)), margin


def anhysteretic(pin, u, curve, per_width, coupling, reversible):
    """P_an / P_s, the root p of p = share tanh((u + alpha P_s (c p + (1 - c) p_irr - worth)) / a - field) + shift, by
    Halley's method; the right side is a contraction, so the root is unique."""
    share, field, worth, shift = curve
    at = u * per_width + coupling * ((1 - reversible) * pin - worth) - field
    inner = coupling * reversible
    p = share * tanh(at) + shift
    for _ in range(4):
        value = tanh(at + inner * p)
        rise = inner * share * (1 - value * value)
        beyond, slope, bend = p - share * value - shift, 1 - rise, 2 * inner * value * rise
        p = p - beyond * slope / (slope * slope - 0.5 * beyond * bend)
    return p


def tanh(x):
    x = min(max(x, -20.0), 20.0)
    grown = expm1(2 * x)
    return grown / (grown + 2)
