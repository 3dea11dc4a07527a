"""One effect: of the coupling of two axes, both of them measured."""

from .campaign import Campaign, declare, identify, validate
from .drives import Drive


@declare("n26", "single", cross_coupling=["kinematic_coupling"])
def coupled_forces():
    """f_x gains -0.05 f_y and f_y gains 0.035 f_x ahead of mechanics of 1.8 and 2.4 kHz: an axis pushes the other one
    (crosstalk of a flexure, Yong et al. 2012); free-energy hysteresis."""

    def forces(f, at):
        return {"x": f["x"] - 0.05 * f["y"], "y": f["y"] + 0.035 * f["x"]}

    def drive():
        return Drive(20000)

    def sweep():
        return drive().rest(0.02).triangles(20, 90, 3).ramp(45, 0.03).chirp(100, 4500, 0.3, 5).rest(0.02)

    raster = drive().rest(0.02).triangles(50, 70, 12).rest(0.02)
    free = {"gain": "wide", "remanence": "wide", "coercive": "wide", "spread": [0.2, 1.5], "interaction": "wide"}
    x = {"gain": 0.035, "remanence": 95.0, "coercive": 24.0, "spread": 0.7, "interaction": 55.0}
    y = {"gain": 0.03, "remanence": 95.0, "coercive": 27.0, "spread": 0.6, "interaction": 60.0}
    return Campaign(
        title="Fast XY scanner, two sensors",
        base="homogenized_energy",
        mechanics="lumped",
        records=[
            identify("x_drive", sweep(), drive()),
            identify("y_drive", drive(), sweep()),
            validate("both", raster, drive().rest(0.02).stairs([20, 40, 60, 30], 0.05).rest(0.02)),
        ],
        measured=("x", "y"),
        hidden={"forces": forces},
        parameters={
            "x": x | {"mass": 0.09, "damping": 35.0, "stiffness": 1.15e7},
            "y": y | {"mass": 0.055, "damping": 30.0, "stiffness": 1.25e7},
        },
        bounds=free | {"mass": "fix", "stiffness": "tight", "damping": [1, 300]},
        model="[homogenized_energy, lumped]",
        steps=4,
        format="mat",
        optimizers=("{name: pso, population: 40, generations: 60}",),
        repeats=1,
    )


@declare("n45", "single", kinematic_coupling=["cross_coupling"])
def turned_sensors():
    """x gains 0.018 y and y gains -0.011 x behind mechanics of 790 and 1130 Hz: sensors that are turned and off the
    axis of motion (Abbe 1890)."""

    def readings(moved, at):
        return {"x": moved["x"] + 0.018 * moved["y"], "y": moved["y"] - 0.011 * moved["x"]}

    def drive(rest=0.1):
        return Drive(8000).rest(rest)

    def sweep():
        return drive().triangles(8, 80, 4).ramp(40, 0.1).chirp(20, 2000, 0.5, 4).rest(0.05)

    lissajous = drive(0.05).loops(15, 90, 6).rest(0.1), drive(0.05).loops(20, 50, 8).rest(0.1)
    return Campaign(
        title="XY scanner, two capacitive sensors",
        mechanics="lumped",
        records=[
            identify("x_alone", sweep(), Drive(8000)),
            identify("y_alone", Drive(8000), sweep()),
            identify("both", drive().loops(12, 70, 6).rest(0.1), drive(0.15).loops(7, 90, 3).rest(0.1)),
            validate("raster", drive().triangles(20, 60, 12).rest(0.1), drive().ramp(75, 0.6).rest(0.05)),
            validate("lissajous", *lissajous),
        ],
        measured=("x", "y"),
        hidden={"readings": readings},
        parameters={
            "x": {
                "gain": 0.13,
                "alpha": 0.34,
                "beta": 0.02,
                "gamma": 0.02,
                "mass": 0.25,
                "damping": 40.0,
                "stiffness": 6.2e6,
            },
            "y": {
                "gain": 0.11,
                "alpha": 0.4,
                "beta": 0.026,
                "gamma": 0.011,
                "mass": 0.12,
                "damping": 30.0,
                "stiffness": 6.05e6,
            },
        },
        bounds={"gain": [0.05, 0.3], "mass": "fix", "stiffness": "tight", "damping": [0, 500]},
        model="[bouc_wen, lumped]",
        steps=4,
        noise=0.006,
    )
