"""Two effects, on one axis."""

import math

import numpy as np

from .campaign import FREE, SMALL_PSO, Campaign, declare, identify, validate, weights
from .drives import Drive
from .dynamics import creep, lag, late, lumped, mode, slew
from .hysteresis import operator, plays


@declare("n06", "pair", delay=["amplifier_lag", "sensor_lag"], quadratic_gain=["saturation", "cubic_stiffness"])
def lock_in_and_electrostriction():
    """The reading is 0.8 ms late, 1.6 samples (dead time), and y gains d q u^2 with q = 9e-4 per volt
    (electrostriction, Newnham et al. 1997); free-energy hysteresis."""
    rng = np.random.default_rng(6)

    def drive():
        return Drive(2000).rest(0.2)

    return Campaign(
        title="Tube scanner Z, lock-in read-out",
        base="homogenized_energy",
        records=[
            identify("tri", drive().triangles(2, 120, 3).triangles(10, 70, 6).rest(0.2)),
            identify("bip", drive().sine(5, 60, 5).rest(0.2)),
            validate("ms", drive().ramp(50, 0.2).multisine([3, 8, 21, 55, 90], 45, 2, rng).rest(0.2)),
        ],
        hidden={
            "reading": lambda x, at: late(at.times, x, 1.6 / 2000),
            "stroke": lambda f, at: f + at.parameters["gain"] * 9e-4 * at.drive**2,
        },
        parameters={"x": {"gain": 0.04, "remanence": 110.0, "coercive": 30.0, "spread": 0.6, "interaction": 80.0}},
        bounds={"gain": "wide", "remanence": "wide", "coercive": "wide", "spread": [0.2, 1.5], "interaction": "wide"},
        model="[homogenized_energy]",
        steps=2,
        noise=0.011,
        counts=0.01,
        optimizers=(SMALL_PSO,),
    )


@declare("n09", "pair", creep=[], periodic_disturbance=[])
def creep_and_pump():
    """Logarithmic creep by 18 Kelvin-Voigt elements from 0.02 to 400 s, each 0.011 times the logarithm of the ratio of
    their times (Jung and Gweon 2000), and 34 nm of 16.6 Hz on the reading from a pump."""
    times, phases = np.geomspace(0.02, 400, 18), [1.0, 2.2, 0.4, 3.0]
    share = 0.011 * math.log(times[1] / times[0])

    def drive(rest=1):
        return Drive(500).rest(rest)

    return Campaign(
        title="Mirror mount in a turbo-pumped chamber",
        records=[
            identify("steps", drive(1.5).stairs([50, 20, 80, 76, 30], 6).rest(1)),
            identify("loops", drive().loops(0.5, 90, 4).loops(5, 60, 10).rest(2)),
            validate("loops2", drive().triangles(1, 80, 5).rest(5)),
            validate("updown", drive().stairs([70, 35, 60], 5).rest(1)),
        ],
        hidden={
            "creep": lambda f, at: creep(f, at.step, [share] * len(times), times),
            "reading": lambda x, at: x + 0.034 * np.sin(2 * np.pi * 16.6 * at.times + phases[at.number]),
        },
        parameters={"x": {"gain": 0.16, "alpha": 0.35, "beta": 0.022, "gamma": 0.028}},
        bounds=FREE,
        model="[bouc_wen]",
        noise=0.0045,
        memory=0.9,
        coloured=0.2,
    )


@declare("n21", "pair", slew_limit=[], creep=[])
def slew_and_creep():
    """|U_a'| <= 2,500 V/s (Fleming and Leang 2014) and four Kelvin-Voigt elements of 1.2 % each, 0.1 to 6.4 s (Krejci
    and Kuhnen 2001)."""

    def drive():
        return Drive(1000).rest(0.5)

    return Campaign(
        title="Large stack, handheld amplifier",
        base="prandtl_ishlinskii",
        records=[
            identify("steps", drive().stairs([60, 20, 90, 50], 3).rest(0.5)),
            identify("sines", drive().loops(1, 100, 2).loops(5, 100, 5).loops(10, 100, 8).rest(0.5)),
            validate("val", drive().triangles(2, 80, 3).triangles(14, 90, 8).rest(2)),
            validate("val2", drive().stairs([30, 75, 45], 2.5).rest(0.5)),
        ],
        hidden={
            "drive": lambda u, at: slew(u, at.step, 2500.0),
            "creep": lambda f, at: creep(f, at.step, [0.012] * 4, [0.1, 0.4, 1.6, 6.4]),
        },
        parameters={"x": dict(gain=0.13, reach=50.0, **weights(0.014, 0.01, 0.009, 0.006, 0.006, 0.003, 0.002, 0.002))},
        bounds={"reach": "fix"},
        model="[prandtl_ishlinskii]",
        steps=2,
        noise=0.02,
        memory=0.85,
        coloured=0.4,
    )


@declare("n24", "pair", encoder_cyclic_error=[], delay=["amplifier_lag", "sensor_lag"])
def grating_and_delay():
    """The reading gains 40 nm sin(2 pi x / 2.5 um + 0.6) (cyclic error of a grating, Heydemann 1981) and is 0.3 ms
    late, 0.9 samples; hysteresis after Coleman and Hodgdon (1986), which is Bouc-Wen with gamma = 0."""
    rng = np.random.default_rng(24)

    def reading(x, at):
        error = 0.040 * np.sin(2 * np.pi * x / 2.5 + 0.6)
        return late(at.times, x + error - 0.040 * np.sin(0.6), 0.9 / 3000)

    def drive(rest=0.2):
        return Drive(3000).rest(rest)

    return Campaign(
        title="Linear stage with a grating, 240 Hz",
        mechanics="lumped",
        records=[
            identify("slow", drive(0.3).triangles(0.8, 100, 2).rest(0.3)),
            identify("fast", drive().loops(25, 60, 20).ramp(50, 0.1).chirp(5, 700, 1.0, 4).rest(0.2)),
            identify("stair", drive().stairs([18, 43, 77, 55], 0.2).rest(0.2)),
            validate("val", drive().ramp(40, 0.2).multisine([2, 9, 33, 71], 38, 2, rng).rest(0.2)),
        ],
        hidden={"reading": reading},
        parameters={
            "x": {
                "gain": 0.16,
                "alpha": 0.4,
                "beta": 0.03,
                "gamma": 0.0,
                "mass": 0.4,
                "damping": 25.0,
                "stiffness": 9.1e5,
            }
        },
        bounds={
            "gain": "wide",
            "alpha": [0, 1],
            "beta": [0, 0.2],
            "mass": "fix",
            "stiffness": "tight",
            "damping": [1, 200],
        },
        model="[bouc_wen, lumped]",
        steps=4,
        noise=0.006,
        drive_counts=0.004,
        time_unit="ms",
    )


@declare("n36", "pair", amplifier_lag=["sensor_lag"], saturation=["quadratic_gain", "cubic_stiffness"])
def lag_and_arctangent():
    """A lag of 1.1 ms ahead of the operator (Adriaens, de Koning and Banning 2000), and d u becomes
    d (2 U_s / pi) atan(pi u / 2 U_s) with U_s = 310 V (arctangent saturation curve)."""
    rng = np.random.default_rng(36)
    level = 310.0

    def stroke(f, at):
        bent = 2 * level / np.pi * np.arctan(np.pi * at.drive / 2 / level)
        return f + at.parameters["gain"] * (bent - at.drive)

    def drive(rest=0.1):
        return Drive(5000).rest(rest)

    return Campaign(
        title="Bimorph bender, +-130 V, laser triangulation",
        records=[
            identify("slow", drive(0.2).sine(2, 130, 3).rest(0.2)),
            identify("mid", drive().sine(20, 120, 12).sine(60, 60, 20).rest(0.1)),
            identify("sq", drive().stairs([50, -50, 100, -100, 20], 0.12).rest(0.05)),
            validate("val", drive().noise(1, 120, 130, 1.6, rng).rest(0.1)),
        ],
        hidden={"drive": lambda u, at: lag(u, at.step, 0.0011), "stroke": stroke},
        parameters={"x": {"gain": 0.12, "alpha": 0.3, "beta": 0.01, "gamma": 0.012}},
        bounds={"gain": "tight", "alpha": [0, 0.9], "beta": [0, 0.1], "gamma": [-0.05, 0.1]},
        model="[bouc_wen]",
        steps=4,
        noise=0.04,
        format="tsv",
    )


@declare("n46", "pair", distributed_memory=["amplitude_gain"], drift=[])
def plays_and_drift():
    """Ten plays beside Bouc-Wen, weights 0.02 to 0.007 of the gain, half-widths 2 to 56 V (Kuhnen 2003), and drift
    S_r (1 - exp(-t / 17 s)) with S_r = 120, -70, 90 and 50 nm."""
    rng = np.random.default_rng(46)
    widths = np.array([2, 4, 7, 11, 16, 22, 29, 37, 46, 56.0])
    shares = np.array([0.02, 0.018, 0.015, 0.013, 0.012, 0.01, 0.009, 0.008, 0.008, 0.007])
    sizes = [0.12, -0.07, 0.09, 0.05]

    def drive(rest=3):
        return Drive(300).rest(rest)

    return Campaign(
        title="Stage on a bench near the window",
        records=[
            identify("nested", drive(4).reversals([130, 30, 110, 50, 90, 65, 110, 30, 130, 0], 40).rest(4)),
            identify("loops", drive().loops(0.6, 130, 4).loops(0.6, 60, 4).rest(5)),
            validate("stairs", drive().stairs([20, 60, 100, 130, 90, 40, 0], 2).rest(6)),
            validate("rnd", drive().ramp(65, 1).noise(0.05, 1, 60, 18, rng).rest(4)),
        ],
        hidden={
            "hysteresis": lambda u, at: (
                operator("bouc_wen", u, at.parameters) + at.parameters["gain"] * plays(u, widths) @ shares
            ),
            "reading": lambda x, at: x - sizes[at.number] * np.expm1(-at.times / 17.0),
        },
        parameters={"x": {"gain": 0.13, "alpha": 0.3, "beta": 0.022, "gamma": 0.024}},
        bounds=FREE,
        model="[bouc_wen]",
        noise=0.005,
        counts=0.004,
    )


@declare("n48", "pair", rate_dependence=[], resonance=[])
def rate_and_side_mode():
    """alpha (1 + 0.085 log10(1 + |du/dt| / 120 V/s)) (logarithm of the rate, Damjanovic 1997), and 10 % of the
    displacement by a mode of 940 Hz with a damping of 0.012 beside the first of 450 Hz (Preumont 2011)."""

    def rate(speed):
        return 1 + 0.085 * math.log(1 + speed / 120.0) / math.log(10)

    def mechanics(f, at):
        return (1 - 0.1) * lumped(f, at.step, **at.mechanics()) + 0.1 * mode(f, at.step, 940.0, 0.012)

    def drive(rest=0.1):
        return Drive(5000).rest(rest)

    return Campaign(
        title="Flexure scanner with a side mode",
        mechanics="lumped",
        records=[
            identify("slow", drive(0.2).loops(0.7, 90, 1).rest(0.2)),
            identify("mid", drive(0.2).loops(7, 90, 5).loops(30, 90, 12).rest(0.2)),
            identify("sweep", drive().ramp(40, 0.1).chirp(20, 1800, 1.2, 4).rest(0.1)),
            validate("steps", drive().stairs([30, 60, 40, 80, 20], 0.15)),
            validate("mix", drive().triangles(3, 70, 3).triangles(25, 70, 10).rest(0.2)),
        ],
        hidden={
            "hysteresis": lambda u, at: operator("bouc_wen", u, at.parameters, rate=rate, dt=at.step),
            "mechanics": mechanics,
        },
        parameters={
            "x": {
                "gain": 0.17,
                "alpha": 0.33,
                "beta": 0.02,
                "gamma": 0.02,
                "mass": 0.33,
                "damping": 45.0,
                "stiffness": 2.64e6,
            }
        },
        bounds=FREE | {"mass": "fix", "stiffness": "wide", "damping": [1, 300]},
        model="[bouc_wen, lumped]",
        steps=4,
        noise=0.012,
        counts=0.008,
    )
