"""One effect: of the static curve of the ceramic, and its creep."""

import numpy as np

from .campaign import FREE, Campaign, declare, identify, validate, weights
from .drives import Drive
from .dynamics import creep


@declare("n03", "single", quadratic_gain=["saturation", "cubic_stiffness"])
def biased_electrostriction():
    """x = M (u + u_b)^2 about a bias, which adds w0 u^2 / (2 u_b) with u_b = 480 V: 14 % of the slope over the stroke
    (electrostriction under a bias, Newnham et al. 1997)."""

    def drive():
        return Drive(1000)

    return Campaign(
        title="Preloaded actuator P-8xx, plays with known thresholds",
        base="prandtl_ishlinskii",
        records=[
            identify("full", drive().rest(0.5).triangles(1, 140, 3).rest(0.5)),
            identify("minor", drive().rest(0.3).reversals([140, 35, 120, 60, 100, 75, 130, 10], 250).rest(0.3)),
            validate("scan10", drive().rest(0.3).loops(10, 120, 10).ramp(60, 0.2).loops(8, -50, 6).rest(0.3)),
        ],
        hidden={"stroke": lambda f, at: f + at.parameters["gain"] * at.drive * at.drive / (2 * 480.0)},
        parameters={
            "x": dict(gain=0.085, reach=64.0, **weights(0.016, 0.013, 0.011, 0.008, 0.006, 0.005, 0.003, 0.002))
        },
        bounds={"reach": "fix", "gain": "wide"},
        model="[prandtl_ishlinskii]",
        counts=0.02,
        time_unit="ms",
    )


@declare("n08", "single", saturation=["cubic_stiffness", "quadratic_gain"])
def langevin_saturation():
    """y = F L(3 f / F) with Langevin's function L(z) = coth z - 1 / z (Langevin 1905) and F = 21 um at a stroke of
    +-8 um. Three of the records start in motion, and the job leaves their first one or two seconds out."""
    rng = np.random.default_rng(8)

    def stroke(f, at):
        z = 3 * f / 21.0
        z = np.where(abs(z) < 1e-4, 1e-4, z)
        return 21.0 * (1 / np.tanh(z) - 1 / z)

    def drive():
        return Drive(600)

    narrow = drive().rest(0.3).sine(2, 50, 6).rest(0.2).sine(2, 50, 8).recorded_from(1.0)
    biased = drive().rest(1.5).reversals([70, 30, 90, 10, 50, -20, -80, 0], 160).rest(0.5).recorded_from(0.5)
    random = drive().rest(0.3).noise(0.2, 2, 98, 12, rng).rest(0.5).recorded_from(2.0)
    return Campaign(
        title="Bipolar actuator up to its limits; recorder was triggered late",
        records=[
            identify("wide", drive().rest(0.3).sine(1, 100, 9).recorded_from(2.55), settle="1.2 s"),
            identify("narrow", narrow, settle="0.8 s"),
            identify("biased", biased),
            validate("val", random, settle="2 s"),
        ],
        hidden={"stroke": stroke},
        parameters={"x": {"gain": 0.105, "alpha": 0.3, "beta": 0.016, "gamma": 0.02}},
        bounds=FREE,
        model="[bouc_wen]",
    )


@declare("n18", "single", creep=[])
def fractional_creep():
    """Creep J(t) ~ t^0.17 (power law, Nutting 1921), 1.8 % a decade at 1 s, by 42 Kelvin-Voigt elements from 4 ms to
    8 h with shares that grow with tau^0.17."""
    times = np.geomspace(0.004, 3e4, 42)
    shares = times**0.17
    shares *= 0.0078 / shares[np.argmin(abs(times - 1))] / 2.6

    def drive(rest):
        return Drive(200).rest(rest)

    return Campaign(
        title="Low-voltage multilayer stack, fibre interferometer",
        records=[
            identify("steps", drive(2).stairs([60, 30, 90, 85, 10], 12).rest(2)),
            identify("loops", drive(1).loops(0.2, 100, 3).loops(2, 100, 6).rest(4)),
            identify("hold", drive(1).ramp(75, 0.2).rest(35)),
            validate("mixed", drive(1).stairs([80, 76, 20, 50], 9).loops(0.5, 40, 4).rest(4)),
        ],
        hidden={"creep": lambda f, at: creep(f, at.step, shares, times)},
        parameters={"x": {"gain": 0.31, "alpha": 0.29, "beta": 0.017, "gamma": 0.02}},
        bounds={"gain": "tight", "alpha": "wide", "beta": "wide", "gamma": "wide"},
        model="[bouc_wen]",
        memory=0.6,
        coloured=0.3,
        unit="nm",
    )


@declare("n41", "single", creep=[])
def two_element_creep():
    """Two Kelvin-Voigt elements, 1.3 % at 0.35 s and 2.1 % at 7.5 s (Krejci and Kuhnen 2001), behind domain walls after
    Jiles and Atherton (1986)."""

    def drive():
        return Drive(200).rest(1)

    return Campaign(
        title="Ferroelectric actuator, HV supply 0 to 1 kV",
        base="domain_wall",
        records=[
            identify("steps", drive().stairs([300, 700, 500, 950], 6).rest(1)),
            identify("tri", drive().triangles(0.25, 1000, 2).triangles(2, 1000, 5).rest(2)),
            validate("val", drive().loops(0.6, 800, 4).rest(5).ramp(400, 0.5).rest(6)),
        ],
        hidden={"creep": lambda f, at: creep(f, at.step, [0.013, 0.021], [0.35, 7.5])},
        parameters={"x": {"saturation": 18.0, "width": 900.0, "coupling": 0.35, "pinning": 160.0, "reversible": 0.35}},
        bounds={"saturation": "wide", "width": "wide", "coupling": [0, 1], "pinning": "wide", "reversible": [0, 1]},
        model="[domain_wall]",
        drive_unit="kV",
    )
