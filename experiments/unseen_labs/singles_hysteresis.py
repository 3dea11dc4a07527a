"""One effect: of the hysteresis with the memory that the job gives it."""

import numpy as np

from .campaign import EVOLUTION, Campaign, declare, identify, validate
from .drives import cosines, nested, noise, path, stairs
from .stages import PLAYS, STACK


@declare("a01", "single", asymmetry=[])
def two_branches():
    """A 12 um preloaded stack stage whose loop is fatter on the way down, as after partial poling. Asymmetric Bouc-Wen
    of Wang & Wen (2000): dh = du (alpha d - |h| (gamma + beta sgn(du h) + phi (sgn du + sgn h))), phi = 0.006 /V."""
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        records=(
            identify("tri_full", path(1000, [0, 120, 0, 120, 0], 120, 0.5)),
            identify("nested", nested(1000, 120, [1, 0.15, 0.8, 0.3, 0.65, 0.4, 1, 0], 100, 0.5)),
            identify("sines", cosines(1000, [120, 80, 40, 100], 1.7, 2, 0.4)),
            validate("check_loops", nested(1000, 110, [0.5, 0.1, 0.9, 0.4, 1, 0.6, 0.85, 0], 150, 0.5)),
            validate("check_random", noise(1000, 0, 120, 2, 6, 5)),
        ),
        noise=0.006,
        hidden={"operator": {"phi": 0.006}},
        bounds={"gain": "tight", "alpha": "wide", "mass": "fix", "damping": "wide", "stiffness": "fix"},
    )


@declare("a05", "single", rate_dependence=[])
def widths_by_the_rate():
    """A stack driven from 0.2 Hz to 40 Hz whose loops widen with the rate. Rate-dependent Prandtl-Ishlinskii with
    logarithmic thresholds, r(v) = r (1 + b ln(1 + lam |v|^eps)) (Al Janaideh, Rakheja & Su 2009-2011), no mechanics in
    the band."""
    return Campaign(
        base="prandtl_ishlinskii",
        parameters={"x": PLAYS},
        mechanics=False,
        known={"reach": 60.0},
        records=(
            identify("r01", path(500, [0, 120, 0, 60, 20, 120, 0], 40, 0.5)),
            identify("r2", path(2000, [0, 120, 0, 60, 20, 120, 0], 800, 0.3)),
            identify("r40", path(20000, [0, 120, 0, 60, 20, 120, 0, 30, 0], 9000, 0.1)),
            validate("val_mid", cosines(10000, [100, 50, 110], [1, 10, 30], 3, 0.2)),
            validate("val_slow", nested(500, 110, [1, 0.2, 0.7, 0.4, 0], 100, 0.3)),
        ),
        noise=0.008,
        hidden={"operator": {"scale": 0.05, "share": 0.06, "power": 0.8}},
        bounds={"gain": "wide"},
        lines=("prandtl_ishlinskii.reach: {value: 60}",),
    )


@declare("a06", "single", thermal_relaxation=[])
def activated_return():
    """A soft-PZT stack at 60 C whose hysteretic part decays during holds. Bouc-Wen with an Eyring-type thermally
    activated return dh/dt = ... - (1/tau) sinh(a h)/a (cf. Smith, Seelecke et al. 2003), tau = 8 s, a = 2 /um; holds
    after steps up, down and back."""
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        mechanics=False,
        records=(
            identify("stairs", stairs(500, [40, 80, 120, 116, 80, 40, 0], 200, 3, 0.5)),
            identify("loops", path(500, [0, 120, 0, 60, 0], 120, 0.5)),
            identify("slow", path(500, [0, 120, 0], 8, 0.5)),
            validate("stairs_val", stairs(500, [100, 95, 30, 35, 70, 0], 200, 4, 0.5)),
            validate("loops_val", cosines(500, [120, 80], [0.4, 0.1], 2, 0.5)),
        ),
        noise=0.012,
        hidden={"operator": {"relax": 1 / 8.0, "activation": 2.0}},
        bounds={"gain": "tight", "alpha": (0.1, 0.6)},
        format="commas",
        optimizers=EVOLUTION,
    )


@declare("a09", "single", amplitude_gain=[])
def gain_by_the_swing():
    """Soft ceramic stack in which the reversible gain follows Rayleigh's law d = d0 + a (Upp - 60 V), from record to
    record (Damjanovic & Demartin 1996), hysteresis h otherwise as in Bouc-Wen. Equal loops of 30 to 150 V about two
    biases."""

    def by_swing(u, at):
        swing = float(np.ptp(at.record.drives["x"]))
        return {"prompt": lambda volts: volts * (1 + 4.5e-4 * (swing - 60))}

    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        mechanics=False,
        records=(
            identify("p150", path(1000, [0, 150, 0, 150, 0], 150, 0.3)),
            identify("p90", path(1000, [0, 90, 0, 90, 0], 120, 0.3)),
            identify("p30", path(1000, [0, 30, 0, 30, 0, 30, 0], 90, 0.3)),
            identify("p60", cosines(1000, [60, 60], 0.8, 2, 0.3)),
            validate("v120", nested(1000, 120, [1, 0.3, 0.8, 0.5, 0], 100, 0.3)),
            validate("v45", cosines(1000, [45, 45], 1.3, 2, 0.3)),
        ),
        noise=0.006,
        hidden={"operator": by_swing},
        bounds={"gain": "tight", "beta": "wide", "alpha": "off"},
        format="semicolons",
    )
