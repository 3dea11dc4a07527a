"""What no effect of the catalogue is: of the stage, its ceramic and its amplifier."""

import numpy as np
from numba import njit

from .campaign import Campaign, declare, identify, validate
from .drives import cosines, nested, path, sines
from .stages import STACK, TUBE


@njit(cache=True)
def _contact(x, place, jump, lower):
    """A jump above a place of the stroke, which ends so much lower."""
    y = np.zeros(x.size)
    open_ = False
    for i in range(x.size):
        if not open_ and x[i] > place:
            open_ = True
        if open_ and x[i] < place - lower:
            open_ = False
        y[i] = x[i] + (jump if open_ else 0.0)
    return y


@declare("a20", "outside")
def snap_of_a_stop():
    """A stack stage that leans on a spring-loaded stop up to 6.1 um; beyond it the contact opens with a snap of 150 nm,
    and closes again 0.5 um lower (adhesion, cf. JKR). A jump with hysteresis at one place of the stroke; no effect of
    the list does that."""
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        mechanics=False,
        records=(
            identify("loops", path(1000, [0, 120, 0, 50, 10, 90, 40, 110, 0], 100, 0.4)),
            identify("small", path(1000, [0, 70, 55, 75, 50, 80, 45, 0], 60, 0.4)),
            validate("val", nested(1000, 115, [1, 0.2, 0.7, 0.4, 0.9, 0], 120, 0.4)),
            validate("val_s", cosines(1000, [110, 60, 80], [0.5, 1, 1.5], 2, 0.4)),
        ),
        noise=0.006,
        hidden={"readings": lambda moved, at: {"x": _contact(moved["x"], 6.1, 0.15, 0.5)}},
        bounds={"gain": "tight"},
    )


def _reversals(u):
    """How often the drive has turned, at each sample."""
    sign = np.sign(np.diff(u, prepend=u[0]))
    moving = np.flatnonzero(sign)
    turned = np.zeros(u.size)
    turned[moving[np.flatnonzero(np.diff(sign[moving]) != 0) + 1]] = 1
    return np.cumsum(turned)


@declare("a45", "outside")
def ageing_by_reversals():
    """A freshly poled stack that ages with the sweep count: after each reversal of the drive the slope of the prompt
    part goes to d (1 + 0.02 (1 - 0.75^N)), dy = d (1 + ...) du, N the number of reversals in the record since it was
    rested. Not a function of time, voltage or swing."""

    def ageing(u, at):
        grown = 1 + 0.02 * (1 - 0.75 ** _reversals(u))
        return {"prompt": lambda volts: np.cumsum(np.diff(volts, prepend=volts[0]) * grown)}

    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        mechanics=False,
        records=(
            identify("tri", path(1000, [0, *[100, 0] * 8], 200, 0.4)),
            identify("mix", path(1000, [0, 120, 60, 110, 40, 90, 0, 50, 0, 120, 0], 150, 0.4)),
            validate("val", path(1000, [0, *[110, 20, 60, 0] * 3], 200, 0.4)),
            validate("val_s", cosines(1000, [100, 100, 60, 100], 0.9, 3, 0.4)),
        ),
        noise=0.004,
        hidden={"operator": ageing},
        bounds={"gain": "tight"},
    )


@declare("a47", "outside")
def gain_of_a_warm_room():
    """Temperature-dependent gain: the room's air conditioning swings by 1.6 K with a period of 7.3 s at the stage, and
    the gain of the soft ceramic by 0.5 %/K, y = f (1 + 0.008 sin(2 pi t / 7.3 s + phase)). A product of drive and a
    slow clock."""

    def swung(force, at):
        phase = (0, 2.1, 4.0, 1.0)[at.number]
        return force * (1 + 0.008 * np.sin(2 * np.pi * at.times / 7.3 + phase))

    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        mechanics=False,
        records=(
            identify("tri", path(500, [0, *[120, 0] * 6], 80, 0.5)),
            identify("nested", nested(500, 120, [1, 0.5, 0.9, 0.4, 0.8, 0.3, 1, 0.2, 0], 60, 0.5)),
            validate("val", nested(500, 110, [0.5, 0.3, 1, 0.5, 0.85, 0.3, 0.6, 0], 50, 0.5)),
            validate("val_s", cosines(500, [110, 70], 0.25, 3, 0.5)),
        ),
        noise=0.006,
        hidden={"force": swung},
        bounds={"gain": "tight"},
        format="tabs",
    )


@njit(cache=True)
def _depolarised(u, threshold, loss):
    """Volts that count for less from the moment that the drive is below a threshold."""
    y = np.zeros(u.size)
    share, sum_ = 1.0, 0.0
    for i in range(1, u.size):
        if u[i] < threshold:
            share = 1 - loss
        sum_ += (u[i] - u[i - 1]) * share
        y[i] = sum_
    return y


@declare("a48", "outside")
def depolarisation():
    """A stack that partly depolarises when the drive first falls below -28 V in a record; from that moment its prompt
    gain is 3 % lower until it is poled again between records. Happens in two of five records only."""

    def lost(u, at):
        return {"prompt": lambda volts: _depolarised(volts, -28.0, 0.03)} if at.number in (1, 3) else {}

    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        mechanics=False,
        records=(
            identify("a", path(1000, [0, 110, 0, 110, -20, 60, 0], 120, 0.4)),
            identify("b", path(1000, [0, 110, 10, 80, -30, 90, 0, 100, 0], 120, 0.4)),
            identify("c", nested(1000, 110, [1, 0.2, 0.8, 0.3, 0], 120, 0.4)),
            validate("v1", path(1000, [0, 60, -30, 100, 20, 80, 0], 120, 0.4)),
            validate("v2", cosines(1000, [110, 50], 0.8, 2, 0.4)),
        ),
        noise=0.006,
        hidden={"operator": lost},
        bounds={"gain": "tight"},
    )


@declare("a49", "outside")
def dead_zone():
    """Class-B output stage without bias current: dead zone of the amplifier of +-0.8 V about zero output current, i.e.
    the output sticks until the command has moved by 0.8 V beyond a zero crossing; ua = u - 0.8 sgn(u) beyond, 0 within.
    Bipolar tube drive; a kink at zero volts on each branch."""
    falling = [0, 180, -180, 120, -120, 60, -60, 30, -30, 10, -10, 0]
    return Campaign(
        base="bouc_wen",
        parameters={"x": TUBE},
        mechanics=False,
        records=(
            identify("tri", path(1000, falling, 400, 0.3)),
            identify("small", path(1000, [0, 20, -20, 20, -20, 8, -8, 8, -8, 0], 60, 0.3)),
            validate("val", path(1000, [0, -150, 100, -50, 25, -12, 6, 60, 0], 250, 0.3)),
            validate("val_s", sines(1000, 300, (40, 1.5, 3000), (15, 3, 2000))),
        ),
        noise=0.002,
        hidden={"drive": lambda u, at: np.sign(u) * np.maximum(np.abs(u) - 0.8, 0)},
        bounds={"gain": "tight"},
        unit="nm",
    )
