"""One effect: of the amplifier."""

import numpy as np

from .campaign import Campaign, declare, identify, validate, weights
from .drives import Drive
from .dynamics import lag, mode, slow_lag


@declare("n12", "single", amplifier_lag=["sensor_lag"])
def resistor_and_capacitance():
    """tau U_a' + U_a = U ahead of Bouc-Wen with tau = R C = 0.38 ms (Adriaens, de Koning and Banning 2000); mass and
    stiffness are known. The range is cycled three times ahead of each record."""
    rng = np.random.default_rng(12)

    def drive(rest):
        return Drive(10000).cycled(20, 100).rest(rest)

    title = "Scanner X, 150 V amplifier with 180 Ohm at 2.1 uF; drive is the command; "
    return Campaign(
        title=title + "the range is cycled three times before each record",
        mechanics="lumped",
        records=[
            identify("sweep", drive(0.1).ramp(30, 0.1).chirp(5, 1500, 0.8, 6).rest(0.1)),
            identify("sines", drive(0.1).loops(10, 100, 3).loops(40, 100, 6).loops(90, 60, 8).rest(0.05)),
            identify("steps", drive(0.05).stairs([20, 60, 40, 90, 10], 0.08)),
            validate("scan", drive(0.05).triangles(25, 85, 8).rest(0.05)),
            validate("noise", drive(0.05).ramp(50, 0.1).noise(2, 300, 45, 0.7, rng).rest(0.05)),
        ],
        hidden={"drive": lambda u, at: lag(u, at.step, 0.00038)},
        parameters={
            "x": {
                "gain": 0.21,
                "alpha": 0.38,
                "beta": 0.014,
                "gamma": 0.022,
                "mass": 0.21,
                "damping": 95.0,
                "stiffness": 6.0e6,
            }
        },
        bounds={
            "gain": "wide",
            "alpha": [0, 1],
            "beta": [0, 0.2],
            "gamma": [-0.1, 0.2],
            "mass": "fix",
            "damping": [5, 200],
            "stiffness": "tight",
        },
        model="[history, bouc_wen, lumped]",
        steps=4,
        noise=0.03,
        counts=0.005,
        drive_counts=0.005,
    )


@declare("n30", "single", slew_limit=["amplifier_lag"])
def limited_current():
    """U_a' = (U - U_a) / 0.2 ms within +-9,000 V/s: an amplifier with a limited current (Fleming and Leang 2014)."""
    rng = np.random.default_rng(30)

    def drive(rest=0.05):
        return Drive(5000).rest(rest)

    return Campaign(
        title="Stack on a small amplifier, 20 mA",
        base="prandtl_ishlinskii",
        records=[
            identify("sines", drive(0.1).loops(5, 120, 3).loops(20, 120, 5).loops(40, 120, 8).rest(0.1)),
            identify("steps", drive().stairs([30, 80, 50, 120, 20], 0.06).rest(0.05)),
            identify("minor", drive().reversals([100, 30, 80, 50, 110, 0], 2500).rest(0.1)),
            validate("val", drive().triangles(15, 100, 4).triangles(60, 90, 8).rest(0.1)),
            validate("val2", drive().ramp(60, 0.1).noise(2, 60, 55, 1.0, rng).rest(0.1)),
        ],
        hidden={"drive": lambda u, at: slow_lag(u, at.step, 0.0002, 9000.0)},
        parameters={"x": dict(gain=0.1, reach=60.0, **weights(0.01, 0.012, 0.008, 0.008, 0.006, 0.003, 0.003, 0.001))},
        bounds={"reach": "fix"},
        model="[prandtl_ishlinskii]",
        steps=4,
        noise=0.03,
        counts=0.04,
    )


@declare("n37", "single", periodic_disturbance=[])
def supply_ripple():
    """U gains about 0.16 V of 100.02 Hz and a fifth of that of its third harmonic (ripple of a supply), ahead of
    Bouc-Wen and two modes of 310 and 870 Hz (modal superposition, Preumont 2011)."""
    ripples = [(0.16, 0.5), (0.15, 2.0), (0.17, 3.7), (0.16, 5.1)]
    frequency = 100.02

    def ripple(u, at):
        (size, phase), t = ripples[at.number], at.times
        third = 0.2 * size * np.sin(6 * np.pi * frequency * t + 3 * phase + 1)
        return u + size * np.sin(2 * np.pi * frequency * t + phase) + third

    def mechanics(f, at):
        return 0.15 * mode(f, at.step, 310.0, 0.02) + 0.021 * mode(f, at.step, 870.0, 0.015)

    def drive(rest=0.1):
        return Drive(8000).rest(0.3).recorded_from(0.3).rest(rest)

    records = [
        identify("tri", drive(0.2).triangles(3, 90, 3).rest(0.2), settle="0.1 s"),
        identify("sweep", drive().ramp(45, 0.1).chirp(20, 1600, 0.9, 3).rest(0.1), settle="0.1 s"),
        identify("steps", drive().stairs([15, 40, 70, 30], 0.2).rest(0.1), settle="0.1 s"),
        validate("val", drive(0.2).loops(6, 80, 5).rest(0.2), settle="0.1 s"),
    ]
    modes = {
        "frequency_1": [250, 400],
        "frequency_2": [700, 1000],
        "damping_1": [0.002, 0.1],
        "damping_2": [0.002, 0.1],
    }
    modes |= {"shape_1": [0.05, 0.4], "shape_2": [-0.1, 0.1]}
    return Campaign(
        title="Two modes from a modal test; old amplifier",
        mechanics=mechanics,
        records=records,
        hidden={"drive": ripple},
        parameters={"x": {"gain": 1.0, "alpha": 0.35, "beta": 0.02, "gamma": 0.025}},
        bounds={"gain": "fix", "alpha": [0, 1]},
        model="[bouc_wen, {name: modal, modes: 2}]",
        more={f"modal.{name}": limits for name, limits in modes.items()},
        steps=4,
        noise=0.006,
    )
