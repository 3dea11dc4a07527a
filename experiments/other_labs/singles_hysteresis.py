"""One effect: of the hysteresis of the ceramic."""

import math

import numpy as np

from .campaign import FREE, Campaign, declare, identify, validate, weights
from .drives import Drive
from .hysteresis import generalised_bouc_wen, operator, plays


@declare("n02", "single", thermal_relaxation=["creep"])
def sinh_relaxation():
    """dh/dt = Bouc-Wen - sinh(a h) / (a tau) with tau = 70 s and a = 1.7 per um, h up to 2 um: thermally activated
    relaxation of the memory (Eyring 1936)."""

    def relax(h, dt):
        y = math.tanh(1.7 * h / 2) * math.exp(-dt / 70.0)
        return math.log((1 + y) / (1 - y)) / 1.7

    def drive():
        return Drive(200)

    return Campaign(
        title="Soft PZT stack, climate chamber at 60 C",
        records=[
            identify("hold_up", drive().rest(2).step(90, 25).step(85.5, 20)),
            identify("hold_dn", drive().rest(2).stairs([100, 40, 60, 20], 11)),
            identify("loops", drive().rest(1).triangles(0.1, 80, 2).triangles(1, 80, 4).rest(3)),
            validate("val", drive().rest(1).ramp(70, 2).rest(9).ramp(30, 2).rest(9).ramp(100, 3).rest(10)),
            validate("val2", drive().rest(1).loops(0.3, 60, 6).rest(8)),
        ],
        hidden={"hysteresis": lambda u, at: operator("bouc_wen", u, at.parameters, relax=relax, dt=at.step)},
        parameters={"x": {"gain": 0.24, "alpha": 0.42, "beta": 0.022, "gamma": 0.024}},
        bounds=FREE,
        model="[bouc_wen]",
        memory=0.97,
        coloured=0.15,
    )


@declare("n04", "single", amplitude_gain=["distributed_memory"])
def gain_by_swing():
    """y = (1 + 5.5e-4 U_pp) f with the swing U_pp of each record, 20 to 140 V (Rayleigh's law of the coefficient,
    Damjanovic and Demartin 1996)."""

    def drive():
        return Drive(800).cycled(2, 140).rest(0.5)

    def stroke(f, at):
        return f * (1 + 5.5e-4 * np.ptp(at.drive[at.record.ahead :]))

    return Campaign(
        title="Amplitude series on a soft stack, cycled before each record",
        records=[
            identify("a20", drive().loops(2, 20, 5).rest(0.5)),
            identify("a60", drive().loops(2, 60, 5).rest(0.5)),
            identify("a140", drive().loops(2, 140, 5).rest(0.5)),
            identify("a100", drive().reversals([100, 40, 80, 20, 90, 0], 300).rest(0.5)),
            validate("a40", drive().triangles(2, 40, 4).rest(0.5)),
            validate("a120", drive().triangles(2, 120, 4).rest(0.5)),
            validate("a140_again", drive().loops(2, 140, 5).rest(0.5)),
            validate("a80", drive().loops(2, 80, 3).rest(0.5)),
        ],
        hidden={"stroke": stroke},
        parameters={"x": {"gain": 0.21, "alpha": 0.34, "beta": 0.019, "gamma": 0.025}},
        bounds=FREE,
        model="[history, bouc_wen]",
        drive_counts=0.005,
        counts=0.01,
    )


@declare("n05", "single", asymmetry=[])
def tilted_loop():
    """dh/dt gains delta u |du/dt| with delta / (alpha d) = 0.0011 per volt (Zhu and Wang 2012)."""
    rng = np.random.default_rng(5)

    def drive():
        return Drive(1000).rest(0.5)

    return Campaign(
        title="Benders of a lens shifter, one of a lot",
        records=[
            identify("settled", drive().loops(1, 110, 5).rest(0.5)),
            identify("half", drive().loops(1.5, 55, 4).ramp(55, 0.3).loops(1.5, 55, 4).rest(0.5)),
            identify("reversals", drive().reversals([90, 30, 105, 10, 60, 40, 100, 0], 120).rest(0.5)),
            validate("multi", drive().ramp(52, 0.5).multisine([0.5, 0.8, 1.7, 3.1], 50, 6, rng).rest(0.5)),
            validate("settled2", drive().loops(1, 110, 5).rest(0.5)),
        ],
        hidden={"hysteresis": lambda u, at: operator("bouc_wen", u, at.parameters, tilt=0.0011)},
        parameters={"x": {"gain": 0.27, "alpha": 0.4, "beta": 0.018, "gamma": 0.02}},
        bounds={"gain": "wide", "alpha": [0, 1], "beta": "wide", "gamma": [-0.1, 0.2]},
        model="[bouc_wen]",
        steps=2,
        memory=0.7,
        coloured=0.4,
    )


@declare("n07", "single", distributed_memory=["amplitude_gain"])
def exponential_plays():
    """y gains d sum w_i F_ri[u], 24 plays of half-widths 1.5 to 48 V with w = 0.016 exp(-r / 17 V) dr / 2 per volt:
    the exponential density of Kuhnen (2003) beside Bouc-Wen."""
    rng = np.random.default_rng(7)
    widths = np.linspace(1.5, 48, 24)
    shares = 0.016 * np.exp(-widths / 17) * (widths[1] - widths[0]) / 2.0

    def drive():
        return Drive(500)

    def hysteresis(u, at):
        return operator("bouc_wen", u, at.parameters) + at.parameters["gain"] * plays(u, widths) @ shares

    nested = [110, 25, 95, 40, 80, 55, 70, 55, 80, 40, 95, 25, 110, 0]
    return Campaign(
        title="Flexure stage 20 um, capacitive sensor, no resonance in the band",
        records=[
            identify("nested", drive().rest(1).reversals(nested, 60).rest(1)),
            identify("tri_1hz", drive().rest(1).triangles(1, 120, 3).triangles(1, 60, 3).rest(0.5)),
            identify("staircase", drive().rest(0.5).stairs([15, 35, 60, 85, 110, 85, 60, 35, 15, 0], 0.6)),
            validate("random", drive().rest(1).ramp(55, 1).noise(0.05, 1.5, 50, 12, rng).rest(1)),
            validate("decay", drive().rest(0.5).reversals([115, 10, 105, 20, 90, 30, 75, 42, 60], 80).rest(1)),
        ],
        hidden={"hysteresis": hysteresis},
        parameters={"x": {"gain": 0.142, "alpha": 0.31, "beta": 0.021, "gamma": 0.026}},
        bounds={"gain": "wide", "alpha": [0, 1], "beta": [0, 0.3], "gamma": [-0.1, 0.3]},
        model="[bouc_wen]",
        drive_counts=0.002,
    )


@declare("n33", "single", asymmetry=[])
def generalised_shape():
    """The shape function of generalised Bouc-Wen (Song and Der Kiureghian 2006) with beta_2 = 0.0045,
    beta_4 = -0.0035, beta_5 = 0.0012, beta_6 = 0.004 per volt about 10 V, beside beta = 0.02 and gamma = 0.006."""
    rng = np.random.default_rng(33)
    shape = {"beta_2": 0.0045, "beta_4": -0.0035, "beta_5": 0.0012, "beta_6": 0.004, "centre": 10.0}

    def hysteresis(u, at):
        return generalised_bouc_wen(u, **at.parameters, **shape, longest=0.001)

    def drive():
        return Drive(400)

    biased = drive().sine(1, 45, 4).ramp(50, 0.5).sine(1, 45, 4).ramp(-50, 0.5).sine(1, 45, 3)
    return Campaign(
        title="Shear actuator, bipolar",
        records=[
            identify("a", drive().sine(1, 100, 4)),
            identify("b", biased),
            validate("c", drive().noise(0.1, 3, 95, 14, rng)),
            validate("d", drive().reversals([95, -95, 60, -60, 30, -30, 0], 220)),
        ],
        hidden={"hysteresis": hysteresis},
        parameters={"x": {"gain": 0.05, "alpha": 0.45, "beta": 0.02, "gamma": 0.006}},
        bounds={"gain": "tight", "alpha": [0, 1]},
        model="[bouc_wen]",
        format="dat",
        timed=False,
        unit="nm",
    )


@declare("n38", "single", rate_dependence=[])
def wider_plays():
    """Half-widths of all plays r_i + 0.85 V ln(1 + 0.02 |du/dt|), the same addition for each (Al Janaideh, Su and
    Rakheja 2008)."""
    rng = np.random.default_rng(38)

    def hysteresis(u, at):
        speed = np.abs(np.diff(u, prepend=u[0])) / at.step
        return operator("prandtl_ishlinskii", u, at.parameters, wider=0.85 * np.log1p(0.02 * speed))

    def drive():
        return Drive(2000).rest(0.3)

    return Campaign(
        title="Stack actuator without resonance below 20 kHz",
        base="prandtl_ishlinskii",
        records=[
            identify("half_hz", drive().loops(0.5, 100, 2).rest(0.3)),
            identify("five_hz", drive().loops(5, 100, 4).rest(0.3)),
            identify("fifty_hz", drive().loops(50, 100, 12).rest(0.2).loops(50, 15, 12).rest(0.3)),
            identify("minor", drive().reversals([90, 30, 70, 40, 100, 0], 180).rest(0.3)),
            validate("two_tone", drive().ramp(50, 0.3).multisine([2, 17, 31], 47, 2, rng).rest(0.3)),
            validate("tri20", drive().triangles(20, 80, 10).rest(0.3)),
        ],
        hidden={"hysteresis": hysteresis},
        parameters={"x": dict(gain=0.09, reach=48.0, **weights(0.02, 0.014, 0.01, 0.008, 0.004, 0.004, 0.003, 0.002))},
        bounds={"reach": "fix"},
        model="[prandtl_ishlinskii]",
        format="tsv",
    )
