"""Nothing is hidden: noise, and jobs whose model is the true one."""

import numpy as np

from .campaign import FREE, SMALL_PSO, Campaign, declare, identify, validate, weights
from .drives import Drive


@declare("n10", "none")
def free_energy_and_mass():
    """Nothing hidden: free energy (Smith et al. 2006), lognormal and normal, and one mass of 1.02 kHz."""

    def drive():
        return Drive(8000).rest(0.1)

    minor = drive().reversals([140, 40, 110, 60, 150, 0], 3000).chirp(30, 2000, 0.4, 5).rest(0.1)
    hysteresis = {"gain": 0.05, "remanence": 100.0, "coercive": 35.0, "spread": 0.75, "interaction": 75.0}
    return Campaign(
        title="AFM stage, lognormal density",
        base="homogenized_energy",
        mechanics="lumped",
        records=[
            identify("tri", drive().triangles(5, 150, 2).rest(0.1)),
            identify("minor", minor),
            validate("bias", drive().ramp(90, 0.1).sine(30, 50, 6).rest(0.1)),
            validate("tri_b", drive().triangles(5, 150, 2).rest(0.1)),
        ],
        parameters={"x": hysteresis | {"mass": 0.22, "damping": 60.0, "stiffness": 9.0e6}},
        bounds={
            "gain": "wide",
            "remanence": "wide",
            "coercive": "wide",
            "spread": [0.1, 2],
            "interaction": "wide",
            "mass": "fix",
            "stiffness": "tight",
            "damping": [1, 400],
        },
        model="[homogenized_energy, lumped]",
        steps=4,
        noise=0.018,
        memory=0.7,
        coloured=0.5,
        optimizers=(SMALL_PSO,),
    )


@declare("n14", "none")
def bouc_wen_and_mass():
    """Nothing hidden: Bouc-Wen (Bouc 1967, Wen 1976) and one mass of 652 Hz; coloured noise of 8 nm, counts of 10
    nm."""
    rng = np.random.default_rng(14)

    def drive(rest=0.1):
        return Drive(6000).rest(rest)

    return Campaign(
        title="Single-axis stage, 16-bit acquisition, nothing known to be wrong",
        mechanics="lumped",
        records=[
            identify("a_tri", drive(0.2).triangles(3, 110, 4).rest(0.2)),
            identify("b_sweep", drive().ramp(50, 0.1).chirp(10, 1200, 1.2, 8).rest(0.1)),
            identify("c_stairs", drive().stairs([20, 50, 90, 60, 10], 0.15)),
            validate("d_noise", drive().ramp(45, 0.1).noise(1, 500, 40, 1.4, rng).rest(0.1)),
            validate("a_tri_again", drive(0.2).triangles(3, 110, 4).rest(0.2)),
        ],
        parameters={
            "x": {
                "gain": 0.19,
                "alpha": 0.41,
                "beta": 0.012,
                "gamma": 0.034,
                "mass": 0.31,
                "damping": 70.0,
                "stiffness": 5.2e6,
            }
        },
        bounds=FREE | {"mass": [0.2, 0.5], "stiffness": "fix", "damping": [0, 500]},
        model="[bouc_wen, lumped]",
        steps=4,
        noise=0.008,
        memory=0.9,
        coloured=0.5,
        counts=0.01,
    )


@declare("n15", "none")
def walls():
    """Nothing hidden: domain walls after Jiles and Atherton (1986)."""

    def drive():
        return Drive(400).rest(0.5)

    return Campaign(
        title="HV actuator, 20 mm stack",
        base="domain_wall",
        records=[
            identify("a", drive().triangles(0.5, 900, 3).rest(0.5)),
            identify("b", drive().reversals([800, 300, 700, 400, 900, 100], 1500).rest(0.5)),
            validate("c", drive().loops(1.2, 650, 4).rest(0.5)),
        ],
        parameters={"x": {"saturation": 22.0, "width": 800.0, "coupling": 0.3, "pinning": 130.0, "reversible": 0.3}},
        bounds={"saturation": "wide", "width": "wide", "pinning": "wide"},
        model="[domain_wall]",
        noise=0.01,
        counts=0.01,
        format="tsv",
    )


@declare("n42", "none")
def eight_plays():
    """Nothing hidden: eight plays of half-widths up to 72 V (Kuhnen 2003), two of them without a weight."""
    rng = np.random.default_rng(42)
    tones = [0.4, 1.1, 2.3]
    random = Drive(300).rest(1).multisine(tones, 0, 0.1, rng).ramp(75, 1).multisine(tones, 70, 10, rng).rest(1)
    return Campaign(
        title="Stack with preload, slow loops",
        base="prandtl_ishlinskii",
        records=[
            identify("r1", Drive(300).rest(1).reversals([150, 40, 120, 60, 100, 20, 150, 0], 90).rest(1)),
            validate("r3", random),
        ],
        parameters={"x": dict(gain=0.1, reach=72.0, **weights(0.012, 0.02, 0.008, 0.0, 0.007, 0.004, 0.0, 0.006))},
        bounds={"reach": "fix"},
        model="[prandtl_ishlinskii]",
        noise=0.012,
        format="dat",
        timed=False,
    )


@declare("n43", "none")
def known_shape():
    """Nothing hidden: generalised Bouc-Wen (Song and Der Kiureghian 2006) on both axes, whose form is in the job. The
    lower bound of y's gain is 5 % above the truth."""
    rng = np.random.default_rng(43)

    def drive(rest=0.5):
        return Drive(500).rest(rest)

    def random(last, height):
        return drive().noise(0.2, last, height, 8, rng).rest(0.5)

    def biased(level):
        return drive().ramp(level, 0.5).sine(1, 30, 3).ramp(-level, 0.5).sine(1, 30, 3).rest(0.5)

    x = drive().sine(1, 80, 4).sine(1, 35, 3).rest(0.5), drive(1).sine(0.8, 70, 4).rest(0.5)
    x_levels, y_levels = [70, -30, 50, -70, 20, -50, 0], [-60, 40, -40, 70, 0]
    xy = drive().reversals(x_levels, 150).rest(0.5), drive(0.3).reversals(y_levels, 130).rest(0.5)
    shape_x = {"beta_2": 0.003, "beta_3": 0.0, "beta_4": -0.002, "beta_5": 0.001, "beta_6": 0.003, "centre": 0.0}
    shape_y = {"beta_2": 0.002, "beta_3": 0.0, "beta_4": 0.002, "beta_5": 0.0, "beta_6": 0.002, "centre": 0.0}
    return Campaign(
        title="Shear XY, generalised Bouc-Wen from an earlier study",
        base="generalised_bouc_wen",
        records=[
            identify("x", *x),
            identify("xy", *xy),
            identify("rnd", random(2, 70), random(2, 66)),
            identify("bias", biased(40), biased(-35)),
            validate("val", random(3, 75), random(3, 70)),
        ],
        measured=("x", "y"),
        parameters={
            "x": dict(gain=0.06, alpha=0.4, beta=0.02, gamma=0.008, **shape_x),
            "y": dict(gain=0.055, alpha=0.43, beta=0.024, gamma=0.01, **shape_y),
        },
        bounds={"x.gain": "wide", "y.gain": "high"},
        model="[bouc_wen]",
        effects="[asymmetry.branches]",
        more={"x.bouc_wen.centre": 0, "y.bouc_wen.centre": 0},
        noise=0.009,
    )
