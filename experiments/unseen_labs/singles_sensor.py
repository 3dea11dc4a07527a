"""One effect: of the sensor and of what surrounds it."""

import numpy as np

from .campaign import Campaign, declare, identify, validate
from .drives import cosines, nested, path
from .dynamics import second_order
from .sensor import hum, quadrature
from .stages import DOMAIN_WALLS, FREE_ENERGY, SCANNER, STACK


@declare("a14", "single", encoder_cyclic_error=[])
def quadrature_errors():
    """A 6 um scanner read by a homodyne interferometer with quadrature errors, period 316.4 nm. Heydemann (1981): the
    phase is the arctangent of (1+g) sin(q + eps) + oy over cos q + ox, which leaves a first and a second harmonic of
    some nm."""
    return Campaign(
        base="bouc_wen",
        parameters={"x": SCANNER},
        mechanics=False,
        records=(
            identify("loops", path(5000, [0, 140, 0, 75, 20, 130, 0], 250, 0.2)),
            identify("sines", cosines(5000, [140, 60], [2, 5], 2, 0.2)),
            validate("val_loops", nested(5000, 130, [1, 0.3, 0.8, 0.5, 0], 250, 0.2)),
        ),
        noise=0.0006,
        hidden={"readings": lambda moved, at: {"x": quadrature(moved["x"], 0.3164, 0.06, 0.05, 0.07, 0.05)}},
        bounds={"gain": "tight"},
        unit="nm",
    )


@declare("a21", "single", drift=[])
def warming_frame():
    """A positioner in a vacuum chamber whose frame warms after pump-down; each record drifts by another amount, with a
    fast (6 s) and a slow part. y = x + A (0.7 (1 - exp(-t/6 s)) + 0.3 (1 - exp(-t/60 s))) (Fleming & Leang 2014), on a
    Preisach-like ceramic (homogenized energy, Smith et al.)."""

    def reading(y, t, number):
        size = (0.25, -0.35, 0.3, -0.2, 0.4)[number]
        return y + size * (0.7 * (1 - np.exp(-t / 6.0)) + 0.3 * (1 - np.exp(-t / 60.0)))

    rests = path(200, [0, 60, 60.001, 20, 0], 60, 3, hold=[4, 0, 4, 2])
    return Campaign(
        base="homogenized_energy",
        parameters={"x": FREE_ENERGY},
        mechanics=False,
        known={"nodes": 256},
        records=(
            identify("tri", path(200, [0, 120, 0, 120, 0], 40, 3)),
            identify("nested", nested(200, 120, [1, 0.2, 0.8, 0.4, 0.6, 0], 50, 3)),
            identify("rest_in_between", rests),
            validate("val_sines", cosines(200, [120, 60], [0.15, 0.4], 2, 3)),
            validate("val_nested", nested(200, 110, [0.5, 0.1, 1, 0.6, 0.9, 0], 40, 3)),
        ),
        noise=0.010,
        steps=1,
        hidden={"reading": reading},
        bounds=dict.fromkeys(("gain", "coercive", "interaction", "remanence"), "wide") | {"spread": (0.1, 1.5)},
        format="tabs",
    )


@declare("a23", "single", periodic_disturbance=[])
def mains_hum():
    """Mains hum picked up by the capacitive sensor's cable: 50.02 Hz with its second, third and fifth harmonic, of
    another phase in each record and 15 % weaker in one, added to the reading. Ceramic of the domain-wall kind (Smith &
    Salapaka)."""
    return Campaign(
        base="domain_wall",
        parameters={"x": DOMAIN_WALLS},
        mechanics=False,
        records=(
            identify("tri", path(2000, [0, 150, 0, 150, 0, 75, 20, 0], 200, 0.4)),
            identify("sines", cosines(2000, [150, 100, 60], [0.7, 1.3, 2.3], 2, 0.4)),
            validate("val", path(2000, [0, 140, 10, 100, 0, 60, 0], 170, 0.4)),
            validate("val_sine", cosines(2000, [120], [0.9], 3, 0.4)),
        ),
        noise=0.005,
        steps=2,
        hidden={"reading": lambda y, t, number: y + hum(t, number)},
        bounds={"saturation": "wide", "width": "wide", "pinning": "wide"},
        format="mat",
        timed=False,
    )


@declare("a27", "single", sensor_lag=[])
def filter_of_the_sensor():
    """A stack read by a capacitive sensor with its filter set to 100 Hz, second-order Butterworth, behind everything
    else (Fleming 2013); the sines up to 120 Hz have their amplitude at the stack unchanged. Stage mechanics known."""

    def readings(moved, at):
        return {"x": second_order(moved["x"], at.step, 100, np.sqrt(2))}

    speeds = [3000, 9000, 15000, 6000, 4000, 12000, 9000, 3000]
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK | {"alpha": 0.4}},
        records=(
            identify("slow", path(1000, [0, 120, 0, 60, 10, 90, 0], 150, 0.3)),
            identify("fast", cosines(5000, [100, 100, 60, 100, 30], [10, 30, 70, 120, 30], 6, 0.1)),
            validate("val_tri", path(5000, [0, 110, 20, 80, 30, 110, 0, 50, 0], speeds, 0.1, hold=0.02)),
            validate("val_sines", cosines(5000, [50, 115, 80], [100, 20, 60], 8, 0.1)),
        ),
        noise=0.015,
        steps=16,
        hidden={"readings": readings},
        bounds={"gain": "tight", "mass": "fix", "damping": "fix", "stiffness": "fix", "alpha": (0.1, 0.8)},
    )
