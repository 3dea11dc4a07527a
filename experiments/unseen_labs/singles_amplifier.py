"""One effect: of the amplifier or of the clocks ahead of it."""

from .campaign import Campaign, declare, identify, validate
from .drives import chirp, cosines, multisine, path
from .dynamics import charged, late, slew
from .stages import KILOVOLT, SCANNER, STACK


@declare("a08", "single", amplifier_lag=[])
def series_resistance():
    """A stack behind an amplifier with 180 ohm series resistance; the command is recorded, not the monitor.
    R C(U) dUa/dt + Ua = U with C growing 15 % over the range (Fleming & Leang 2014), R C0 = 1.2 ms, ahead of the
    hysteresis; large sines to 250 Hz so that the domains see a smaller swing."""
    speeds = [4000, 9000, 20000, 9000, 4000, 20000, 9000, 3000]
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK | {"alpha": 0.4}},
        records=(
            identify("slow", path(1000, [0, 120, 0, 60, 10, 90, 0], 150, 0.3)),
            identify("fast", cosines(10000, [100, 100, 60, 100, 30], [20, 60, 120, 250, 60], 6, 0.1)),
            validate("val_tri", path(10000, [0, 110, 20, 80, 30, 110, 0, 50, 0], speeds, 0.1, hold=0.01)),
            validate("val_sines", cosines(10000, [50, 115, 80], [150, 40, 90], 8, 0.1)),
        ),
        noise=0.015,
        steps=16,
        hidden={"drive": lambda u, at: charged(u, at.step, 1.2e-3, 1.25e-3)},
        bounds={"gain": "tight", "mass": "fix", "damping": "fix", "stiffness": "fix"},
    )


@declare("a12", "single", delay=[])
def dead_time():
    """AFM scanner whose DAC and controller hold the command back by 2.37 sample periods of 20 kHz. Pure dead time
    u(t - 118.5 us) ahead of everything, no loss of amplitude."""
    return Campaign(
        base="bouc_wen",
        parameters={"x": SCANNER},
        records=(
            identify("loops", path(2000, [0, 150, 0, 75, 20, 130, 0], 400, 0.3)),
            identify("sweep", chirp(20000, 60, 3, 50, 4000, 0.5, 0.05, 0.05)),
            identify("tri_fast", path(20000, [0, *[120, 0] * 6], 9000, 0.05)),
            validate("val_ms", multisine(20000, 70, 10, 30, 3000, 30, 0.4, 8)),
            validate("val_fast", cosines(20000, [100, 50, 140], [60, 120, 30], 5, 0.05)),
        ),
        noise=0.003,
        hidden={"drive": lambda u, at: late(u, at.step, 118.5e-6)},
        bounds={"gain": "tight", "mass": "fix", "damping": "wide", "stiffness": "tight"},
        format="h5",
        unit="nm",
    )


@declare("a28", "single", slew_limit=[])
def current_limit():
    """A kV stack behind an amplifier of 14.8 mA into 0.6 uF: |dUa/dt| <= I/C(U) with C growing 10 % over the range
    (Fleming & Leang 2014). Sines and triangles of several amplitudes at several rates meet the limit only where rate
    times amplitude is large."""
    speeds = [25000, 15000, 22000, 10000, 30000, 12000]
    return Campaign(
        base="bouc_wen",
        parameters={"x": KILOVOLT},
        records=(
            identify("slow", path(1000, [0, 1000, 0, 600, 100, 900, 0], 1500, 0.3)),
            identify("fast", cosines(10000, [1000, 200, 500, 1000, 800], [4, 30, 15, 8, 10], 4, 0.1)),
            validate("val_tri", path(10000, [0, 900, 100, 800, 300, 1000, 0], speeds, 0.1, hold=0.02)),
            validate("val_sines", cosines(10000, [900, 300], [9, 25], 4, 0.1)),
        ),
        noise=0.015,
        hidden={"drive": lambda u, at: slew(u, at.step, 24600.0, 24600.0, 1e-4)},
        bounds={"gain": "tight", "mass": "fix", "damping": "wide", "stiffness": "fix"},
        format="h5",
    )
