"""One effect: of the static stroke, or of its creep."""

import numpy as np
from scipy.special import gamma

from .campaign import EVOLUTION, Campaign, declare, identify, validate
from .drives import cosines, noise, path, sines, stairs
from .dynamics import creep
from .stages import STACK, TUBE


@declare("a10", "single", creep=[])
def logarithm_of_time():
    """Stack stage under staircases with holds of 6 s. Logarithmic creep, the response to a step grows by
    gamma log10(1 + t/t0) (Vieira 1986; Jung & Gweon 2000), gamma = about 1.1 % per decade from t0 = 0.05 s, superposed
    linearly over 16 Kelvin-Voigt elements."""
    times = np.geomspace(0.05, 500, 16)
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        records=(
            identify("stairs", stairs(500, [40, 80, 120, 114, 60, 0], 400, 6, 0.5)),
            identify("loops", path(500, [0, 120, 0, 60, 0, 120, 0], 150, 0.5)),
            validate("val_stairs", stairs(500, [90, 85, 20, 25, 110, 0], 400, 6, 0.5)),
            validate("val_sines", cosines(500, [120, 60, 30], [0.2, 0.5, 2], 2, 0.5)),
        ),
        noise=0.0045,
        hidden={"force": lambda force, at: creep(force, at.step, times, [0.012 * 4 / 16] * 16)},
        bounds={"gain": "tight", "mass": "fix", "damping": "fix", "stiffness": "fix"},
        format="parquet",
    )


@declare("a24", "single", quadratic_gain=[])
def square_about_the_poling_bias():
    """A stack with electrostrictive share, measured right after conditioning cycles, so that records begin in motion.
    y = d (u + M (u + 30 V)^2) - h, the square counted from the poling bias (Hall 2001), M = 5e-4 /V."""

    def cycled(*ends):
        return path(1000, [0, *ends], 150, 0).ahead()

    small = [10, -20, 5, -20, 5, 55, 30, 55, 30, 110, 85, 110, 85, 40]
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        mechanics=False,
        records=(
            identify(
                "tri",
                path(1000, [60, 120, -30, 120, -30, 60, 0, 90, 20], 150, 0),
                ahead=cycled(120, -30, 120, -30, 60),
            ),
            identify("small", path(1000, small, 100, 0), ahead=cycled(120, -30, 120, -30, 10)),
            validate(
                "val",
                path(1000, [45, 100, 10, 110, -25, 80, -10, 30], 120, 0),
                ahead=cycled(115, -30, 115, -30, 45),
            ),
            validate("val2", path(1000, [90, 20, 70, 30, 115, -20], 200, 0), ahead=cycled(115, -30, 90)),
        ),
        noise=0.006,
        hidden={"operator": {"prompt": lambda u: u + 5e-4 * (u + 30) ** 2}},
        bounds={"gain": "wide2", "beta": "wide"},
        optimizers=EVOLUTION,
    )


def _langevin(u, scale=330.0):
    ratio = u / scale
    small = np.abs(ratio) < 1e-3
    safe = np.where(small, 1.0, ratio)
    return np.where(small, u, 3 * scale * (1 / np.tanh(safe) - 1 / safe))


@declare("a26", "single", saturation=[])
def levelling_off_by_the_voltage():
    """A tube driven bipolar, +-200 V, whose prompt response levels off by a Langevin function
    y = d 3U (coth(u/U) - U/u) - h with U = 330 V (as in the anhysteretic curve of Jiles & Atherton; Smith 2005). Odd in
    the voltage."""
    at_biases = [0, 180, 140, 180, 140, -140, -180, -140, -180, 20, -20, 20, -20, 0]
    return Campaign(
        base="bouc_wen",
        parameters={"x": TUBE},
        mechanics=False,
        records=(
            identify("tri", path(1000, [0, 200, -200, 200, -200, 100, -100, 0], 500, 0.3)),
            identify("sines", sines(1000, 300, (200, 1.5, 2000), (120, 2, 1500))),
            identify("bias", path(1000, at_biases, 300, 0.3)),
            validate("val", path(1000, [0, -190, 150, -100, 50, -150, 190, 0], 400, 0.3)),
            validate("val_rand", noise(1000, -190, 190, 2, 6, 77)),
        ),
        noise=0.004,
        hidden={"operator": {"prompt": _langevin}},
        bounds={"gain": "tight"},
        format="spaces",
        unit="m",
    )


@declare("a32", "single", creep=[])
def power_of_time():
    """A stack whose creep follows a power of time, J(t) = 1 + 0.03 (t / 1 s)^0.22, i.e. a fractional-order element
    s^-0.22 (Liu, Shan & Qi 2013), realised by 19 relaxation times from 2 ms to 2000 s. Staircases with holds, two slow
    loops."""
    times = np.geomspace(2e-3, 2e3, 19)
    shares = 0.03 * 0.22 / gamma(1 - 0.22) * times**0.22 * np.log(times[1] / times[0])
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        mechanics=False,
        records=(
            identify("stairs", stairs(500, [40, 80, 120, 114, 60, 0], 1000, 5, 0.5)),
            identify("loops", path(500, [0, 120, 0, 60, 0, 120, 0], 100, 0.5)),
            identify("loops_fast", path(1000, [0, *[120, 0, 60, 0] * 3], 2000, 0.5)),
            validate("val_stairs", stairs(500, [90, 85, 20, 25, 110, 0], 1000, 5, 0.5)),
            validate("val_sines", cosines(500, [120, 60, 30], [0.2, 0.5, 5], 2, 0.5)),
        ),
        noise=0.008,
        hidden={"force": lambda force, at: creep(force, at.step, times, shares)},
        bounds={"gain": "tight", "alpha": (0.1, 0.9)},
        format="tdms",
    )
