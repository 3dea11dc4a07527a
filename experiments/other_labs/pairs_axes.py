"""Two effects, one of them the coupling of an axis that is driven and not measured."""

import math

from .campaign import Campaign, declare, identify, validate
from .drives import Drive
from .dynamics import creep
from .hysteresis import operator


@declare("n20", "pair", cross_coupling=["kinematic_coupling"], creep=[])
def coupled_forces_and_creep():
    """f_x gains -0.041 f_y (crosstalk of a flexure, Yong et al. 2012), and three Kelvin-Voigt elements of 0.9, 1.2 and
    0.8 % at 0.15, 1.6 and 19 s creep on both axes (Krejci and Kuhnen 2001); y is driven, not measured."""

    def drive(rest=1):
        return Drive(250).rest(rest)

    def still():
        return Drive(250)

    axis = {"gain": 0.15, "alpha": 0.37, "beta": 0.025, "gamma": 0.02}
    y_only = drive().ramp(50, 0.5), drive(3).triangles(0.5, 110, 3).stairs([50, 20], 4).rest(1)
    raster = drive().triangles(2, 60, 20).rest(3), drive().stairs(list(range(0, 100, 10)), 1).rest(2)
    return Campaign(
        title="XY flexure stage; only X has a sensor",
        records=[
            identify("x_only", drive().triangles(0.5, 100, 3).stairs([40, 70], 6).rest(1), still()),
            identify("y_only", *y_only),
            identify("both", drive().loops(0.7, 80, 7).rest(2), drive().loops(0.43, 100, 4).rest(2)),
            validate("raster", *raster),
        ],
        hidden={
            "creep": lambda f, at: creep(f, at.step, [0.009, 0.012, 0.008], [0.15, 1.6, 19.0]),
            "forces": lambda f, at: {"x": f["x"] - 0.041 * f["y"], "y": f["y"]},
        },
        parameters={"x": axis, "y": axis},
        bounds={"x.gain": "wide"},
        model="[bouc_wen]",
        noise=0.006,
        memory=0.9,
        coloured=0.3,
    )


@declare("n39", "pair", thermal_relaxation=["creep"], kinematic_coupling=["cross_coupling"])
def relaxation_and_turned_sensor():
    """dh/dt gains -h / 9 s on both axes (relaxation after Maxwell 1867), and the reading of x gains 0.035 y (Abbe
    1890); y is driven, not measured."""

    def relax(h, dt):
        return h * math.exp(-dt / 9.0)

    def drive(rest=1):
        return Drive(250).rest(rest)

    axis = {"gain": 0.12, "alpha": 0.38, "beta": 0.02, "gamma": 0.02}
    spiral = drive().ramp(45, 1).sine(1.1, 35, 12).rest(5), drive().ramp(50, 1).sine(0.9, 40, 9).rest(4)
    return Campaign(
        title="XY stage, interferometer on X only, quasi-static",
        records=[
            identify("x_steps", drive().stairs([70, 30, 90, 86], 5).rest(1), Drive(250)),
            identify("y_loops", drive().ramp(40, 1), drive(4).triangles(0.5, 90, 3).rest(3)),
            identify("x_loops", drive().loops(0.5, 80, 4).loops(3, 50, 8).rest(3), drive(2).stairs([30, 60], 4)),
            validate("spiral", *spiral),
        ],
        hidden={
            "hysteresis": lambda u, at: operator("bouc_wen", u, at.parameters, relax=relax, dt=at.step),
            "readings": lambda moved, at: {"x": moved["x"] + 0.035 * moved["y"], "y": moved["y"]},
        },
        parameters={"x": axis, "y": axis},
        bounds={"x.gain": [0.05, 0.3], "x.alpha": [0, 1]},
        model="[bouc_wen]",
        noise=0.012,
        memory=0.8,
        coloured=0.5,
    )
