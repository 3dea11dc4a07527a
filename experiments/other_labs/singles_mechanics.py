"""One effect: of masses, springs and friction."""

import math

import numpy as np

from .campaign import FREE, LEAST_SQUARES, Campaign, declare, identify, validate
from .drives import Drive
from .dynamics import bristles, linear, lumped, maxwell_slip, oscillator
from .hysteresis import two_groups


@declare("n11", "single", load_mass=[])
def payload():
    """A payload of 58 g on 0.31 kg, m x'' + b x' + k x = k f; mass and stiffness are known from the data sheet
    (payload of a nanopositioner, Fleming and Leang 2014)."""
    rng = np.random.default_rng(11)

    def drive():
        return Drive(12000).rest(0.1)

    tones = [13, 170, 430, 777, 1010, 1400]
    return Campaign(
        title="Nano stage, masses and stiffness from the data sheet, sample mounted",
        mechanics="lumped",
        records=[
            identify("sweep20", drive().ramp(20, 0.1).chirp(50, 3000, 0.8, 3).rest(0.1)),
            identify("sweep80", drive().ramp(80, 0.1).chirp(50, 3000, 0.8, 3).rest(0.1)),
            identify("tri", drive().triangles(10, 100, 4).rest(0.1)),
            validate("steps", drive().stairs([20, 50, 80, 30], 0.1)),
            validate("ms", drive().ramp(50, 0.1).multisine(tones, 20, 0.6, rng).rest(0.1)),
        ],
        hidden={"mechanics": lambda f, at: lumped(f, at.step, **at.mechanics(mass=at.parameters["mass"] + 0.058))},
        parameters={
            "x": {
                "gain": 0.11,
                "alpha": 0.36,
                "beta": 0.02,
                "gamma": 0.03,
                "mass": 0.31,
                "damping": 90.0,
                "stiffness": 1.55e7,
            }
        },
        bounds={
            "gain": "tight",
            "alpha": [0, 1],
            "beta": "wide",
            "gamma": "wide",
            "mass": "fix",
            "damping": "wide",
            "stiffness": "fix",
        },
        model="[bouc_wen, lumped]",
        steps=4,
        memory=0.95,
        coloured=0.3,
    )


@declare("n16", "single", cubic_stiffness=[])
def hardening_flexure():
    """m x'' + b x' + k (x + 7e-6 x^3) = k f with x in um (Duffing 1918), 92 Hz: 4 % more stiffness at the ends of the
    stroke."""
    rng = np.random.default_rng(16)

    def mechanics(f, at):
        return oscillator(f, at.step, **at.mechanics(), spring=lambda x: x + 7e-6 * x**3)

    def drive(rest=0.3):
        return Drive(2000).rest(rest)

    return Campaign(
        title="Amplified stage with 92 Hz, +-0.45 kV",
        mechanics="lumped",
        records=[
            identify("bias0", drive(0.5).chirp(5, 250, 3, 25).rest(0.5)),
            identify("bias_hi", drive().ramp(350, 0.5).chirp(5, 250, 3, 25).rest(0.5)),
            identify("loops", drive().sine(2, 420, 5).rest(0.5)),
            validate("tri", drive().reversals([400, -400, 300, -300, 0], 2500).rest(0.5)),
            validate("rand", drive().ramp(-200, 0.4).noise(1, 140, 120, 2.5, rng).rest(0.4)),
        ],
        hidden={"mechanics": mechanics},
        parameters={
            "x": {
                "gain": 0.14,
                "alpha": 0.3,
                "beta": 0.004,
                "gamma": 0.005,
                "mass": 0.9,
                "damping": 18.0,
                "stiffness": 3.0e5,
            }
        },
        bounds=FREE | {"mass": "fix", "stiffness": "wide", "damping": [1, 100]},
        model="[bouc_wen, lumped]",
        steps=8,
        noise=0.04,
        counts=0.08,
        drive_counts=0.02,
        drive_unit="kV",
    )


@declare("n29", "single", friction=[])
def lugre_friction():
    """LuGre friction of the moving mass (Canudas de Wit et al. 1995), z' = v - |v| z / g(v), F = F_c z / z_0, with
    F_c / k = 110 nm, bristles of 350 nm, 25 % of stiction, Stribeck speed 60 um/s; 185 Hz."""

    def bristle(z, v):
        return v - abs(v) * z / (0.35 * (1 + 0.25 * math.exp(-((v / 60.0) ** 2))))

    def mechanics(f, at):
        return bristles(f, at.step, **at.mechanics(), bristle=bristle, friction=lambda z: 0.11 * z / 0.35)

    def drive(rest=0.2):
        return Drive(2500).rest(rest)

    small = drive(0.3).loops(3, 6, 4).loops(3, 15, 4).ramp(50, 0.3).loops(3, 6, 4).loops(3, 15, 4).rest(0.3)
    return Campaign(
        title="Stage on crossed-roller guides",
        mechanics="lumped",
        records=[
            identify("small", small),
            identify("large", drive(0.3).triangles(1, 110, 2).triangles(6, 60, 6).rest(0.3)),
            identify("sweep", drive().ramp(40, 0.2).chirp(5, 450, 2, 5).rest(0.2)),
            validate("steps", drive().stairs([10, 25, 22, 60, 55, 90, 40], 0.3).rest(0.1)),
            validate("fast", drive().loops(17, 80, 20).rest(0.3)),
        ],
        hidden={"mechanics": mechanics},
        parameters={
            "x": {
                "gain": 0.18,
                "alpha": 0.3,
                "beta": 0.019,
                "gamma": 0.022,
                "mass": 0.5,
                "damping": 35.0,
                "stiffness": 6.75e5,
            }
        },
        bounds={"gain": [0.05, 0.5], "alpha": [0, 1], "mass": "tight", "stiffness": "fix", "damping": [0, 500]},
        model="[bouc_wen, lumped]",
        steps=6,
        counts=0.005,
    )


@declare("n34", "single", viscous_damping=[])
def grease_film():
    """A film of grease adds 95 N s/m to the maker's 40 N s/m at 560 Hz (Newtonian film); Preisach hysteresis
    (Mayergoyz 1986) with two groups of coercive voltages, and a job with a free density."""
    fields, shares = two_groups(12, 42, 75)

    def mechanics(f, at):
        return lumped(f, at.step, **at.mechanics(damping=at.parameters["damping"] + 95.0))

    def drive():
        return Drive(6000).rest(0.1)

    loops = drive().triangles(4, 140, 2).reversals([120, 30, 90, 50, 140, 0], 1500).rest(0.1)
    hysteresis = {"gain": 0.09, "interaction": 60.0, "fields": fields, "weights": 6.5 * shares}
    return Campaign(
        title="Stage in a grease-filled housing; mechanics by the maker",
        base="preisach",
        mechanics="lumped",
        records=[
            identify("sweep", drive().ramp(40, 0.1).chirp(10, 1500, 0.8, 6).rest(0.1)),
            identify("loops", loops),
            validate("steps", drive().stairs([40, 100, 70, 20], 0.1)),
            validate("sines", drive().loops(25, 120, 5).loops(80, 40, 10).rest(0.1)),
        ],
        hidden={"mechanics": mechanics},
        parameters={"x": hysteresis | {"mass": 0.42, "damping": 40.0, "stiffness": 5.2e6}},
        bounds={"mass": "fix", "damping": "fix", "stiffness": "fix"},
        model="[{name: homogenized_energy, density: free}, lumped]",
        more={"homogenized_energy.interaction": [10, 400]},
        steps=3,
        optimizers=(LEAST_SQUARES,),
        repeats=1,
    )


@declare("n40", "single", resonance=[])
def second_mass():
    """A second mass of 45 g on a spring of 2.05e6 N/m (1074 Hz alone) on the first of 0.4 kg, which is pushed and read:
    a chain with an antiresonance ahead of its second pole (den Hartog 1934)."""
    rng = np.random.default_rng(40)
    mass, damping, stiffness = 0.045, 9.0, 2.05e6

    def mechanics(f, at):
        own = at.parameters
        upper, link = np.array([mass, damping, stiffness]), np.array([damping, stiffness])
        chain = np.polymul([own["mass"], own["damping"] + damping, own["stiffness"] + stiffness], upper)
        return linear(own["stiffness"] * upper, chain - np.r_[0, 0, np.polymul(link, link)], f, at.step)

    def drive(rest, start=20):
        return Drive(5000, start).rest(rest)

    tones = [7, 43, 131, 277, 611, 890, 1123, 1480]
    return Campaign(
        title="Nanopositioner with a sample holder on a bracket",
        mechanics="lumped",
        records=[
            identify("sweep_low", drive(0.2).chirp(10, 2200, 2.5, 4).rest(0.2)),
            identify("sweep_high", drive(0.1).ramp(80, 0.2).chirp(10, 2200, 1.5, 5).rest(0.1)),
            identify("loops", drive(0.1, 0).triangles(5, 100, 4).rest(0.2)),
            validate("multisine", drive(0.1).multisine(tones, 18, 1.2, rng).rest(0.1)),
        ],
        hidden={"mechanics": mechanics},
        parameters={
            "x": {
                "gain": 0.12,
                "alpha": 0.33,
                "beta": 0.02,
                "gamma": 0.03,
                "mass": 0.40,
                "damping": 60.0,
                "stiffness": 2.9e6,
            }
        },
        bounds={
            "gain": [0.05, 0.3],
            "alpha": [0, 1],
            "beta": [0, 0.2],
            "gamma": [-0.1, 0.2],
            "mass": [0.3, 0.6],
            "damping": [1, 500],
            "stiffness": "fix",
        },
        model="[bouc_wen, lumped]",
        steps=4,
        noise=0.003,
        memory=0.5,
        coloured=0.4,
        format="mat",
    )


@declare("n47", "single", friction=["distributed_memory"])
def slip_elements():
    """Five Maxwell-slip elements on the moving mass (Iwan 1966, Goldfarb and Celanovic 1997), which slip after 0.06 to
    2.2 um and hold together 92 nm times the stiffness; 118 Hz."""
    rng = np.random.default_rng(47)
    limits = np.array([0.012, 0.016, 0.02, 0.024, 0.02])
    stiffnesses = limits / np.array([0.06, 0.15, 0.4, 1.0, 2.2])

    def mechanics(f, at):
        return maxwell_slip(f, at.step, **at.mechanics(), stiffnesses=stiffnesses, limits=limits)

    def drive(rest=0.2):
        return Drive(2000).rest(rest)

    nested = [100, 20, 85, 40, 70, 50, 60, 50, 90, 10, 100, 0]
    return Campaign(
        title="Stage with cable chain and slider",
        mechanics="lumped",
        records=[
            identify("nested", drive(0.3).reversals(nested, 200).rest(0.3)),
            identify("ring", drive().stairs([20, 30, 34, 36, 70, 66], 0.35).rest(0.2)),
            identify("sines", drive().loops(8, 90, 6).loops(30, 30, 20).rest(0.2)),
            validate("v", drive().ramp(50, 0.3).multisine([1.3, 7, 19, 44, 83], 42, 3, rng).rest(0.3)),
            validate("w", drive().triangles(2, 70, 4).rest(0.3)),
        ],
        hidden={"mechanics": mechanics},
        parameters={
            "x": {
                "gain": 0.16,
                "alpha": 0.28,
                "beta": 0.015,
                "gamma": 0.025,
                "mass": 1.2,
                "damping": 60.0,
                "stiffness": 6.6e5,
            }
        },
        bounds=FREE | {"mass": "fix", "stiffness": "tight", "damping": "wide"},
        model="[bouc_wen, lumped]",
        steps=8,
        format="mat",
    )
