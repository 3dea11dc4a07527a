"""Two effects, one of them the coupling to a second axis that is driven and not measured."""

from .campaign import Campaign, alone, declare, identify, validate
from .drives import chirp, path, stairs
from .dynamics import creep
from .stages import LONG, STACK


@declare("a34", "pair", cross_coupling=[], creep=[])
def pull_of_a_drive():
    """XY stage of which only x has a sensor: y's drive pulls at x through the guide ahead of x's mechanics (ratio 0.02
    of its voltage, charge-driven y axis without hysteresis; Lin & Lin 2012 in structure), and x's stack creeps by two
    Kelvin-Voigt elements of its force (Croft et al. 2001)."""

    def forces(forces, at):
        return forces | {"x": forces["x"] + at.parameters["x"]["gain"] * 0.02 * at.drives["y"]}

    loops = path(500, [0, 110, 0, 60, 10, 100, 0], 200, 0.3)
    raster = path(500, [0, *[100, 0] * 6], 150, 0.3), path(500, [0, 90, 0], 20, 0.3)
    both = stairs(500, [70, 65, 100, 0], 400, 3, 0.3), path(500, [0, 100, 0, 50, 0], 100, 0.3)
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK, "y": STACK},
        records=(
            identify("x_stairs", *alone(stairs(500, [40, 80, 120, 114, 60, 0], 400, 3, 0.5), "x")),
            identify("y_loops", *alone(loops, "y")),
            identify("x_loops", *alone(loops, "x")),
            identify("y_sweep", *alone(chirp(10000, 50, 20, 100, 2500, 0.4, 0.05, 0.05), "y")),
            validate("raster", *raster),
            validate("val_stairs", *both),
        ),
        noise=0.0065,
        hidden={
            "forces": forces,
            "force": lambda force, at: creep(force, at.step, [0.25, 6.0], [0.025, 0.035]),
        },
        bounds={"gain": "tight", "mass": "fix", "damping": "wide", "stiffness": "tight"},
    )


@declare("a37", "pair", kinematic_coupling=["cross_coupling"], drift=[])
def abbe_and_steady_drift():
    """Raster scanner with y driven and not measured; the x sensor sees 1.5 % of y's displacement (Abbe), and each
    record drifts by its own steady rate. All slow, so that a kinematic and a stiffness coupling are the same."""
    speeds = (0.055, -0.08, 0.07, -0.06)
    first = path(200, [0, *[140, 0] * 6], 120, 1.5), path(200, [0, 120, 0], 16, 1.5)
    second = path(200, [0, *[100, 20] * 6], 100, 1.5), path(200, [0, 100, 50, 140, 0], 40, 1.5)
    return Campaign(
        base="bouc_wen",
        parameters={"x": LONG, "y": LONG},
        mechanics=False,
        records=(
            identify("raster1", *first),
            identify("y_only", *alone(path(200, [0, 130, 0, 70, 20, 130, 0], 60, 1.5), "y")),
            validate("raster2", *second),
            validate("x_only", *alone(path(200, [0, 120, 0, 60, 20, 120, 0], 60, 1.5), "x")),
        ),
        noise=0.015,
        hidden={
            "readings": lambda moved, at: {"x": moved["x"] + 0.015 * moved["y"]},
            "reading": lambda y, t, number: y + speeds[number] * t,
        },
        bounds={"gain": "tight"},
        format="commas",
    )
