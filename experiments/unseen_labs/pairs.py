"""Two effects on one axis."""

import numpy as np

from .campaign import EVOLUTION, LEAST_SQUARES, Campaign, declare, identify, validate
from .drives import chirp, cosines, multisine, nested, noise, path, stairs
from .dynamics import creep, lag, late, lumped, second_order, slew
from .sensor import quadrature, warming
from .stages import KILOVOLT, LONG, PLAYS, SCANNER, STACK

AT_BIASES = [0, 20, 10, 20, 10, 65, 55, 65, 55, 115, 105, 115, 105, 0]


@declare("a15", "pair", creep=[], quadratic_gain=[])
def creep_of_a_curved_stroke():
    """Electrostrictive share in a stack that also creeps: f = d u - h creeps by two Kelvin-Voigt elements (3 % in
    0.4 s, 3.5 % in 15 s; Croft et al. 2001), and the stroke itself curves, y = x + c x^2 (Hall 2001)."""
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        mechanics=False,
        records=(
            identify("stairs", stairs(500, [40, 80, 120, 114, 60, 0], 400, 5, 0.5)),
            identify("loops", path(500, [0, 120, 0, 60, 0, 120, 0], 200, 0.5)),
            identify("small", path(500, AT_BIASES, 100, 0.5)),
            validate("val_stairs", stairs(500, [90, 85, 20, 25, 110, 0], 400, 5, 0.5)),
            validate("val_sines", cosines(500, [120, 60, 30], [0.3, 0.7, 2], 2, 0.5)),
        ),
        noise=0.009,
        hidden={
            "force": lambda force, at: creep(force, at.step, [0.4, 15.0], [0.03, 0.035]),
            "readings": lambda moved, at: {"x": moved["x"] + 0.006 * moved["x"] ** 2},
        },
        bounds={"gain": "tight2"},
        optimizers=EVOLUTION,
    )


@declare("a16", "pair", resonance=[], delay=[])
def second_mode_and_dead_time():
    """AFM scanner with a sample holder on a soft mount, which adds a second mode at 2.6 kHz with 12 % of the static
    response (modal sum, the two modes in parallel), and a dead time of 90 us of the DAC loop."""

    def mechanics(force, at):
        first = lumped(force, at.step, **at.mechanics())
        return (1 - 0.12) * first + 0.12 * second_order(force, at.step, 2600, 2 * 0.015)

    return Campaign(
        base="bouc_wen",
        parameters={"x": SCANNER},
        records=(
            identify("loops", path(2000, [0, 150, 0, 75, 20, 130, 0], 400, 0.3)),
            identify("sweep", chirp(25000, 60, 3, 50, 5000, 0.6, 0.05, 0.05)),
            validate("val_ms", multisine(25000, 70, 10, 30, 4500, 40, 0.4, 8)),
            validate("val_fast", path(25000, [0, *[120, 0] * 5], 12000, 0.05)),
        ),
        noise=0.004,
        hidden={"mechanics": mechanics, "drive": lambda u, at: late(u, at.step, 90e-6)},
        bounds={"gain": "tight", "mass": "fix", "damping": "wide", "stiffness": "tight"},
        format="mat73",
    )


@declare("a17", "pair", drift=[], rate_dependence=[])
def warm_hall_and_rate():
    """A kV stack measured in a hall that warms up: each record drifts by another amount with tau = 12 s, and alpha of
    Bouc-Wen grows as 1 + c log10(1 + v/v0) with the drive rate (Ang, Khosla & Riviere 2007, with an onset)."""
    sizes = (0.9, -1.6, 2.5, -0.8, 1.3)
    fast = path(10000, [0, *[1000, 0, 600, 100] * 2, 0], 60000, 0.7)
    return Campaign(
        base="bouc_wen",
        parameters={"x": KILOVOLT},
        mechanics=False,
        records=(
            identify("slow", path(500, [0, 1000, 0, 600, 100, 1000, 0], 300, 1.0)),
            identify("mid", path(1000, [0, 1000, 0, 600, 100, 1000, 0], 3000, 2.0)),
            identify("fast", fast),
            validate("val_slow", cosines(500, [1000, 500], [0.2, 0.5], 2, 1.0)),
            validate("val_fast", cosines(5000, [900, 400, 700], [12, 5, 3], 3, 1.0)),
        ),
        noise=0.015,
        hidden={
            "reading": lambda y, t, number: y + warming(t, sizes[number], 12.0),
            "operator": {"rate": 0.12, "onset": 400.0},
        },
        bounds={"gain": "tight", "beta": "wide"},
        drive_unit="kV",
    )


@declare("a33", "pair", amplifier_lag=[], encoder_cyclic_error=[])
def resistance_and_quadrature():
    """A scanner behind 55 ohm (R C = 0.15 ms ahead of the hysteresis), read by a homodyne interferometer of period
    316.4 nm with gain and phase error of its quadratures (Heydemann 1981)."""
    speeds = [4000, 9000, 20000, 9000, 4000, 20000, 9000, 3000]
    return Campaign(
        base="bouc_wen",
        parameters={"x": SCANNER | {"alpha": 0.35}},
        records=(
            identify("slow", path(4000, [0, 140, 0, 75, 20, 130, 0], 400, 0.2)),
            identify("fast", cosines(10000, [120, 120, 60, 100, 30], [20, 60, 120, 200, 60], 5, 0.1)),
            validate("val_tri", path(10000, [0, 110, 20, 80, 30, 110, 0, 50, 0], speeds, 0.1, hold=0.01)),
            validate("val_slow", path(4000, [0, 120, 30, 100, 0], 500, 0.2)),
        ),
        noise=0.0013,
        steps=12,
        hidden={
            "drive": lambda u, at: lag(u, at.step, 0.15e-3),
            "readings": lambda moved, at: {"x": quadrature(moved["x"], 0.3164, 0.15, 0.09, 0.16, 0.10)},
        },
        bounds={"gain": "tight", "mass": "fix", "damping": "fix", "stiffness": "fix"},
        unit="nm",
    )


@declare("a35", "pair", saturation=[], periodic_disturbance=[])
def levelling_off_on_a_shaking_floor():
    """A play-like ceramic (Prandtl-Ishlinskii) whose stroke levels off, y = F atan(f pi / 2F) 2/pi with F = 45 um, on a
    floor that shakes at 23.7 Hz."""
    at_biases = [0, 110, 80, 110, 80, -80, -110, -80, -110, 15, -15, 15, 0]
    phases = (0.3, 2.2, 4.0, 1.0)
    return Campaign(
        base="prandtl_ishlinskii",
        parameters={"x": PLAYS},
        mechanics=False,
        known={"reach": 60.0},
        records=(
            identify("tri", path(1000, [0, 120, -120, 120, -60, 60, 0], 150, 0.5)),
            identify("bias", path(1000, at_biases, 150, 0.5)),
            validate("val", path(1000, [0, -110, 90, -60, 30, 115, 0], 120, 0.5)),
            validate("val_rand", noise(1000, -110, 110, 1.5, 8, 51)),
        ),
        noise=0.010,
        steps=2,
        hidden={
            "readings": lambda moved, at: {"x": 2 / np.pi * 45 * np.arctan(moved["x"] * np.pi / 2 / 45)},
            "reading": lambda y, t, number: y + 0.075 * np.sin(2 * np.pi * 23.7 * t + phases[number]),
        },
        bounds={"gain": "wide"},
        lines=("prandtl_ishlinskii.reach: {value: 60}",),
        format="semicolons",
        optimizers=LEAST_SQUARES,
    )


@declare("a36", "pair", asymmetry=[], sensor_lag=["amplifier_lag", "delay"])
def easier_one_way_behind_two_poles():
    """A stack whose domains switch more easily one way, dh/dt <- + lean |du/dt| alpha d with lean 0.15 (one-sided
    Bouc-Wen), read by a sensor with two unequal RC poles of 0.3 and 0.15 ms."""

    def readings(moved, at):
        return {"x": lag(lag(moved["x"], at.step, 0.3e-3), at.step, 0.15e-3)}

    speeds = [3000, 5000, 8000, 2000, 3000, 6000, 5000, 2000]
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK | {"alpha": 0.4}},
        mechanics=False,
        records=(
            identify("slow", nested(1000, 120, [1, 0.1, 0.8, 0.3, 0.6, 0, 1, 0], 150, 0.3)),
            identify("fast", cosines(4000, [100, 60, 100, 30], [8, 20, 40, 20], 5, 0.1)),
            validate("val", nested(1000, 110, [0.5, 0.1, 0.9, 0.4, 1, 0], 120, 0.3)),
            validate("val_fast", path(4000, [0, 110, 20, 80, 30, 110, 0, 50, 0], speeds, 0.1, hold=0.02)),
        ),
        noise=0.009,
        steps=12,
        hidden={"operator": {"lean": 0.15}, "readings": readings},
        bounds={"gain": "tight", "beta": "wide"},
    )


@declare("a38", "pair", slew_limit=[], creep=[])
def weak_amplifier_and_creep():
    """An amplified stage behind a weak amplifier, 27.5 mA sourcing and 25.5 mA sinking into 2.5 uF (11 and 10.2 V/ms),
    and creep of three Kelvin-Voigt elements (Croft et al. 2001)."""
    speeds = [12000, 5000, 9000, 4000, 15000, 11000]
    return Campaign(
        base="bouc_wen",
        parameters={"x": LONG | {"gain": 0.5}},
        mechanics=False,
        records=(
            identify("stairs", stairs(1000, [40, 80, 120, 114, 60, 0], 4000, 3, 0.3)),
            identify("fast", cosines(5000, [120, 30, 60, 120], [15, 40, 30, 32], 5, 0.2)),
            validate("val_stairs", stairs(1000, [90, 85, 20, 110, 0], 3000, 3, 0.3)),
            validate("val_fast", path(5000, [0, 110, 20, 80, 30, 110, 0], speeds, 0.2, hold=0.02)),
        ),
        noise=0.015,
        hidden={
            "drive": lambda u, at: slew(u, at.step, 11000.0, 10200.0, 0.0),
            "force": lambda force, at: creep(force, at.step, [0.1, 1.2, 14.0], [0.012, 0.015, 0.02]),
        },
        bounds={"gain": "tight", "beta": "off"},
        format="h5",
    )


@declare("a39", "pair", load_mass=[], quadratic_gain=[])
def sample_holder_on_a_curved_gain():
    """Stack stage with a 45 g sample holder that the job's fixed mass lacks, and an electrostrictive gain
    y = d (u + c u^2) - h (Hall 2001), c = 8e-4 /V."""

    def mechanics(force, at):
        return lumped(force, at.step, **at.mechanics(mass=at.parameters["mass"] + 0.045))

    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        records=(
            identify("loops", path(1000, [0, 120, 0, 60, 10, 90, 0, 120, 0], 150, 0.3)),
            identify("small", path(1000, AT_BIASES, 100, 0.3)),
            identify("sweep", chirp(20000, 50, 3, 50, 2500, 0.5, 0.05, 0.05)),
            validate("ms_val", multisine(20000, 60, 6, 40, 2000, 25, 0.5, 11)),
            validate("val", nested(1000, 115, [1, 0.2, 0.7, 0.4, 0.9, 0], 120, 0.3)),
        ),
        noise=0.006,
        hidden={"mechanics": mechanics, "operator": {"prompt": lambda u: u + 8e-4 * u * u}},
        bounds={"gain": "tight", "mass": "fix", "damping": "wide", "stiffness": "fix"},
        format="mat",
        unit="nm",
    )
