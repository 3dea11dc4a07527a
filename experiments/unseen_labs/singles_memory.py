"""One effect: a memory of nested reversals, which the Bouc-Wen equation of the job lacks."""

import numpy as np

from .campaign import EVOLUTION, Campaign, declare, identify, validate
from .drives import chirp, cosines, nested, noise, path
from .hysteresis import free_energy, generalised_plays, lorentzian_preisach, plays
from .stages import BENDER, SCANNER, STACK

NESTED = [1, 0.2, 0.8, 0.3, 0.7, 0.4, 0.6, 0.4, 0.7, 0.3, 0.8, 0.2, 1, 0]
CHECKED = [0.6, 0.1, 1, 0.5, 0.75, 0.3, 0.9, 0.45, 0.5, 0]
AT_BIASES = [0, 40, 20, 40, 20, 80, 60, 80, 60, 110, 90, 110, 0]


@declare("a13", "single", distributed_memory=[])
def thirty_plays():
    """A stack whose loops close after nested reversals. Prandtl-Ishlinskii with 30 plays of exponential density
    p(r) = rho exp(-0.05 r) (Al Janaideh 2009), fitted by Bouc-Wen: the memory is missing."""
    number = np.arange(1, 31)
    density = 0.03 * np.exp(-number * 4.5 * 0.05)
    weights = density / density.sum() * 0.045

    def hysteresis(u, at):
        return 0.065 * u + plays(u, number * 2.0, weights)

    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        mechanics=False,
        records=(
            identify("nested", nested(500, 120, NESTED, 100, 0.5)),
            identify("tri", path(500, [0, 120, 0, 80, 0, 40, 0], 100, 0.5)),
            identify("bias_loops", path(500, AT_BIASES, 80, 0.5)),
            validate("val", nested(500, 115, CHECKED, 110, 0.5)),
            validate("val_rand", noise(500, 0, 120, 1.5, 10, 21)),
        ),
        noise=0.005,
        hidden={"hysteresis": hysteresis},
        bounds={"gain": "wide", "alpha": (0, 1)},
    )


@declare("a29", "single", distributed_memory=[])
def two_densities():
    """A tube of soft PZT: Preisach operator with lognormal coercive and normal interaction fields (homogenized energy,
    Smith et al. 2005) ahead of the tube's first mode. The job has Bouc-Wen, which lacks the memory of nested
    reversals."""

    def hysteresis(u, at):
        return free_energy(u, gain=0.026, remanence=85.0, coercive=20.0, spread=0.7, interaction=110.0, nodes=96)

    return Campaign(
        base="bouc_wen",
        parameters={"x": SCANNER},
        records=(
            identify("nested", nested(1000, 150, NESTED, 250, 0.3)),
            identify("tri", path(1000, [0, 150, 0, 100, 0, 50, 0], 250, 0.3)),
            identify("sweep", chirp(16000, 70, 3, 100, 3000, 0.4, 0.05, 0.05)),
            validate("val", nested(1000, 140, CHECKED, 250, 0.3)),
            validate("val_fast", nested(8000, 140, [1, 0.4, 0.9, 0.1, 0.5, 0.2, 0], 4000, 0.1)),
        ),
        noise=0.004,
        steps=4,
        hidden={"hysteresis": hysteresis},
        bounds={"gain": "wide2", "mass": "fix", "damping": "wide", "stiffness": "tight"},
        format="parquet",
    )


@declare("a30", "single", distributed_memory=[])
def bent_envelopes():
    """A stack with saturating, asymmetric loops: generalised Prandtl-Ishlinskii with envelope tanh(u/a + c) (Al
    Janaideh, Rakheja & Su 2009) and 25 plays beside a linear part. The job has Bouc-Wen alone."""
    number = np.arange(1, 26)

    def hysteresis(u, at):
        return 0.07 * u + generalised_plays(u, number * 2.2, 0.004 * np.exp(-number * 0.1), 260.0, -0.15)

    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        mechanics=False,
        records=(
            identify("nested", nested(500, 120, NESTED, 80, 0.5)),
            identify("tri", path(500, [0, 120, 0, 80, 0, 40, 0], 80, 0.5)),
            identify("bias_loops", path(500, AT_BIASES, 80, 0.5)),
            validate("val", nested(500, 115, CHECKED, 80, 0.5)),
            validate("val_dec", cosines(500, [110, 90, 70, 50, 30], 0.7, 1, 0.5)),
        ),
        noise=0.006,
        hidden={"hysteresis": hysteresis},
        bounds={"gain": "wide"},
        optimizers=EVOLUTION,
    )


@declare("a31", "single", distributed_memory=[])
def factorised_density():
    """A bender of multilayer PZT: Preisach operator with a density that factorises, Lorentzian in the interaction
    field and exponential in the coercive one (Bertotti 1998), 40 half-widths. The job has Bouc-Wen, whose loops do not
    close."""
    number = np.arange(1, 41)

    def hysteresis(u, at):
        weights = 0.02 * np.exp(-number * 0.06)
        return 0.75 * u + lorentzian_preisach(u, number * 1.2, weights, 90.0, 10.0)

    return Campaign(
        base="bouc_wen",
        parameters={"x": BENDER},
        mechanics=False,
        records=(
            identify("nested", nested(500, 60, NESTED, 40, 0.5, low=-60)),
            identify("tri", path(500, [0, 60, -60, 40, -40, 20, -20, 0], 50, 0.5)),
            validate("val", nested(500, 55, CHECKED[:-1], 40, 0.5, low=-55)),
            validate("val_rand", noise(500, -60, 60, 1, 12, 91)),
        ),
        noise=0.015,
        hidden={"hysteresis": hysteresis},
        bounds={"gain": "wide", "alpha": (0, 0.9)},
    )
