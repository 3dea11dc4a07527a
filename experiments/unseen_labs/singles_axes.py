"""One effect: of the coupling of two axes, both of them measured."""

import numpy as np

from .campaign import Campaign, alone, declare, identify, validate
from .drives import chirp, multisine, path
from .dynamics import coupled
from .stages import SECOND, STACK


@declare("a11", "single", cross_coupling=[])
def guides_that_pull():
    """A serial-parallel XY stage in which both displacements are measured and each guide pulls at the other.
    m1 x'' + b1 x' + k1 x = k1 f1 + k12 y and likewise for y, k12 = 0.05 k1, k21 = -0.035 k2 (Lin & Lin 2012, with the
    other axis' displacement and its resonance)."""

    def stage(forces, at):
        return coupled(forces, at.step, **at.parameters, of_y=0.05 * 1.2e7, of_x=-0.035 * 1.5e7)

    loops = path(1000, [0, 110, 0, 60, 10, 100, 0], 200, 0.3)
    sweep = chirp(20000, 40, 2, 100, 2500, 0.3, 0.03, 0.04)
    raster = path(1000, [0, *[100, 0] * 5], 500, 0.2), path(1000, [0, 80], 40, 0.2)
    tones = [multisine(20000, 50, 5, 50, 2000, 20, 0.3, seed) for seed in (3, 4)]
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK, "y": SECOND},
        measured=("x", "y"),
        records=(
            identify("x_loops", *alone(loops, "x")),
            identify("y_loops", *alone(loops, "y")),
            identify("x_sweep", *alone(sweep, "x")),
            identify("y_sweep", *alone(sweep, "y")),
            validate("raster", *raster),
            validate("both", *tones),
        ),
        noise=0.005,
        hidden={"stage": stage},
        bounds={"gain": "tight", "mass": "fix", "damping": "wide2", "stiffness": "tight"},
    )


@declare("a22", "single", kinematic_coupling=[])
def sensor_off_its_axis():
    """An XY scanner whose x sensor stands 1.6 degrees off its axis: x reads x cos(0.028) + y sin(0.028), with y's own
    resonance and hysteresis (Yong et al. 2012). Both axes measured; the y sensor is right."""

    def readings(moved, at):
        return {"x": moved["x"] * np.cos(0.028) + moved["y"] * np.sin(0.028), "y": moved["y"]}

    loops = path(1000, [0, 110, 0, 60, 10, 100, 0], 200, 0.3)
    raster = path(1000, [0, 80], 30, 0.2), path(1000, [0, *[100, 0] * 5], 400, 0.2)
    tones = [multisine(20000, 50, height, 50, 2000, 20, 0.3, seed) for height, seed in ((4, 3), (8, 4))]
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK, "y": SECOND},
        measured=("x", "y"),
        records=(
            identify("x_loops", *alone(loops, "x")),
            identify("y_loops", *alone(loops, "y")),
            identify("x_sweep", *alone(chirp(20000, 40, 2, 100, 2500, 0.3, 0.03, 0.04), "x")),
            identify("y_sweep", *alone(chirp(20000, 40, 3, 100, 2500, 0.3, 0.03, 0.04), "y")),
            validate("raster", *raster),
            validate("both", *tones),
        ),
        noise=0.003,
        hidden={"readings": readings},
        bounds={"gain": "tight", "mass": "fix", "damping": "wide2", "stiffness": "tight"},
    )
