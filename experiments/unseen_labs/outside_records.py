"""What no effect of the catalogue is: of the sensor and of its records."""

import numpy as np

from .campaign import Campaign, declare, identify, validate
from .drives import cosines, nested, path
from .stages import STACK


def _records():
    """Loops, nested loops and sines of a whole range of 120 V."""
    return (
        identify("tri", path(1000, [0, 120, 0, 60, 12, 90, 0, 120, 0], 120, 0.4)),
        identify("nested", nested(1000, 120, [1, 0.2, 0.8, 0.3, 0.65, 0.45, 0.9, 0], 144, 0.4)),
        validate("val", nested(1000, 114, [0.5, 0.1, 1, 0.5, 0.85, 0.3, 0.6, 0], 120, 0.4)),
        validate("val_sines", cosines(1000, [120, 60, 96], [0.7, 1.3, 1.9], 2, 0.4)),
    )


def _stack(noise, hidden, **more):
    """The stack in these records, with what is hidden in its readings."""
    usual = {"base": "bouc_wen", "parameters": {"x": STACK}, "mechanics": False, "bounds": {"gain": "tight"}}
    return Campaign(records=_records(), noise=noise, hidden=hidden, **usual | more)


@declare("a44", "outside")
def hinge_of_the_gain():
    """Capacitive sensor at the end of its range: from 7.2 um of stroke on the guard electrode no longer covers the
    target, and the reading's slope rises by 4 % at a hinge, y = x + 0.04 max(x - 7.2 um, 0). A broken line at one
    place, no polynomial."""
    return _stack(0.004, {"readings": lambda moved, at: {"x": moved["x"] + 0.04 * np.maximum(moved["x"] - 7.2, 0)}})


def _seats(times, moments):
    """One or nought, by turns, from each of the moments on."""
    signs = ((1 if k % 2 == 0 else -1) * (times >= moment) for k, moment in enumerate(moments))
    return sum(signs, np.zeros(times.size))


@declare("a46", "outside")
def loose_mirror():
    """The interferometer's mirror is loose: it tips between two seats 60 nm apart at moments that have nothing to do
    with drive or position (someone closes a door), two to five times a record."""
    moments = (
        (1.13, 3.4, 4.02, 6.2, 7.1),
        (0.92, 2.75, 4.4),
        (1.7, 2.1, 5.05),
        (0.61, 3.3, 4.6, 5.2),
    )
    return _stack(
        0.005,
        {"readings": lambda moved, at: {"x": moved["x"] + 0.06 * _seats(at.times, moments[at.number])}},
        bounds={"gain": "tight", "beta": "wide"},
    )


BURSTS = (
    (0.9, 1.8, 3.3, 3.7, 5.9, 8.1),
    (0.7, 2.2, 2.9, 4.8),
    (1.2, 2.0, 3.6, 5.1),
    (0.8, 2.4, 2.8, 4.4),
)


def _bursts(y, t, number):
    out, rng = y.copy(), np.random.default_rng(40 + number)
    for moment in BURSTS[number]:
        later = t > moment
        since, height = t[later] - moment, 0.09 * rng.uniform(0.6, 1.4)
        decay = height * np.exp(-since / 0.12)
        out[later] += decay * np.sin(2 * np.pi * rng.uniform(35, 160) * since)
    return out


@declare("a50", "outside")
def welding_next_door():
    """A welding set next door: electromagnetic bursts on the sensor cable at random times, each a decaying oscillation
    of its own frequency (35 to 160 Hz) lasting some 0.1 s."""
    return _stack(0.003, {"reading": _bursts})


@declare("a51", "outside")
def stuck_codes():
    """The reading's converter has a stuck code block: between 3.9 and 4.9 um all codes come out 70 nm too high (one
    carry line of the converter). Two steps at fixed readings, once over the stroke, flat in between."""
    return _stack(
        0.005,
        {"reading": lambda y, t, number: y + 0.07 * ((y > 3.9) & (y < 4.9))},
        bounds={"gain": "tight", "alpha": (0.1, 0.7)},
        format="spaces",
    )


LOST = (
    ((1500, 4), (5200, 3)),
    ((1900, 4),),
    ((1500, 3), (4300, 3)),
    ((2100, 2), (3900, 2)),
)


def _shortened(y, t, number):
    count = np.arange(y.size)
    taken = count.copy()
    for sample, lost in LOST[number]:
        taken[count >= sample] += lost
    return y[np.minimum(taken, y.size - 1)]


@declare("a52", "outside")
def lost_readings():
    """The logger loses blocks of 2 to 4 readings now and then (buffer overrun) while the drive channel goes on, so that
    from each glitch on the reading is early against the drive by as many samples more. A timing that jumps within a
    record."""
    return _stack(0.006, {"reading": _shortened}, timed=False)
