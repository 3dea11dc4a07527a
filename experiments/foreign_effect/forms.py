"""Published forms of every effect: for each a draw of what its plan holds, and the range of its size.

A draw gets (rng, c) and gives (plan, lowest size, highest size, both signs?); c holds what the lottery knows of stage
and campaign: gain (um/V), top (largest voltage), stroke (um), beta, gamma (1/V), fastest (largest sample rate, Hz),
longest (longest record, s), f1 (Hz or 0), records (count), speed and swiftest (geometric mean and largest rate, V/s).
"""

import math

import numpy as np


def _plain(low, high, signs=False):
    return lambda rng, c: ({}, low(c), high(c), signs)


def _branches(rng, c):
    shares = {key: float(rng.uniform(-1, 1)) * (c["beta"] + abs(c["gamma"])) for key in ("b2", "b4", "b5", "b6")}
    return {"shares": shares, "centre": c["top"] / 2}, 0.01, 0.6, False


def _rated(low, high):
    return lambda rng, c: ({"speed": float(c["speed"] * rng.uniform(0.5, 2))}, low, high, False)


def _memory(rng, c):
    count = int(rng.integers(2, 6))
    widths = np.sort(rng.uniform(0.04, 0.45, count)) * c["top"]
    weights = rng.dirichlet(np.ones(count))
    return {"widths": widths.tolist(), "weights": weights.tolist()}, 0.002, 0.5, False


def _density(rng, c):
    plan = {"coercive": float(c["top"] * rng.uniform(0.08, 0.25)), "spread": float(rng.uniform(0.3, 0.7))}
    plan |= {"interaction": float(c["top"] * rng.uniform(0.2, 0.5)), "reach": 1.2 * c["top"]}
    return plan, 0.002, 0.4, False


def _elements(rng, c):
    count = int(rng.integers(1, 4))
    longest = math.log10(c["longest"] / 2)
    times = 10 ** np.sort(rng.uniform(longest - 2.0, longest, count))
    return {"times": times.tolist(), "weights": rng.dirichlet(np.full(count, 3.0)).tolist()}, 0.001, 0.3, False


def _logarithmic(rng, c):
    return {"onset": 0.1 if c["longest"] > 5 else c["longest"] / 50, "span": c["longest"]}, 0.0005, 0.1, False


def _drifting(rng, c):
    walk = np.cumsum(rng.standard_normal(c["records"]))
    walk = walk / np.max(np.abs(walk))
    plan = {"time": float(c["longest"] * rng.uniform(0.15, 1)), "span": c["longest"], "walk": walk.tolist()}
    return plan, 1e-4 * c["stroke"], 0.1 * c["stroke"], True


def _tone(rng, c):
    locked = rng.random() < 0.4
    phases = np.full(c["records"], rng.uniform(0, 6.28)) if locked else rng.uniform(0, 6.28, c["records"])
    plan = {"frequency": float(rng.choice([50.0, 60.0, rng.uniform(12, 45)])), "phases": phases.tolist()}
    return plan | {"third": float(rng.choice([0.0, 0.2]))}, 1e-4 * c["stroke"], 0.02 * c["stroke"], False


def _grating(rng, c):
    plan = {"pitch": float(c["stroke"] / rng.uniform(1.5, 12)), "phase": float(rng.uniform(0, 6.28))}
    return plan | {"second": float(rng.choice([0.0, 0.25]))}, 1e-4 * c["stroke"], min(0.01 * c["stroke"], 0.15), False


def _second(rng, c):
    frequency = c["fastest"] * float(np.exp(rng.uniform(math.log(0.012), math.log(0.12))))
    while c["f1"] and 0.7 < frequency / c["f1"] < 1.4:
        frequency *= 1.3
    return {"mode": {"frequency": frequency, "damping": float(rng.uniform(0.004, 0.05))}}, 0.004, 0.4, False


def _rubbing(rng, c):
    pace = c["gain"] * c["speed"]
    length = float(rng.uniform(0.01, 0.15) * c["stroke"])
    scaled = {"stiffness": 1 / length}
    return {"law": {"scaled": scaled, "fixed": {"speed": pace}}}, 1e-4 * c["stroke"], 0.06 * c["stroke"], False


def _bristles(rng, c):
    plan, low, high, signs = _rubbing(rng, c)
    plan["law"]["scaled"] |= {"breakaway": float(rng.uniform(1.1, 1.6)), "inner": 0.02 / (c["gain"] * c["speed"])}
    plan["law"]["scaled"]["viscous"] = float(rng.uniform(0.0, 0.3)) / (c["gain"] * c["speed"])
    return plan, low, high, signs


def _dry(rng, c):
    pace = c["gain"] * c["speed"]
    plan = {"law": {"scaled": {"viscous": float(rng.uniform(0.02, 0.3)) / pace}, "fixed": {"speed": 0.3 * pace}}}
    return plan, 1e-4 * c["stroke"], 0.06 * c["stroke"], False


def _jumping(rng, c):
    plan = {"place": float(rng.uniform(0.3, 0.7) * c["stroke"]), "width": float(rng.uniform(0.02, 0.1) * c["stroke"])}
    return plan, 1e-3 * c["stroke"], 0.15 * c["stroke"], False


def _warm(rng, c):
    return (
        {"period": float(c["longest"] * rng.uniform(0.2, 0.6)), "phase": float(rng.uniform(0, 6.28))},
        1e-3,
        0.1,
        False,
    )


def _ageing(rng, c):
    return {"span": c["longest"]}, 1e-3, 0.15, False


_TAU = _plain(lambda c: 0.05 / c["fastest"], lambda c: 40 / c["fastest"])
_BOW = _plain(lambda c: 1e-3 / c["top"], lambda c: 0.3 / c["top"], True)
_CROSS = _plain(lambda c: 0.003, lambda c: 0.3, True)

FORMS = {
    "asymmetry": {
        "voltage": _plain(lambda c: 0.02 / c["top"], lambda c: 1.0 / c["top"], True),
        "constant": _plain(lambda c: 0.01, lambda c: 0.6, True),
        "generalised": _branches,
    },
    "rate_dependence": {"log10": _rated(0.003, 0.25), "log1p": _rated(0.003, 0.3), "power": _rated(0.001, 0.12)},
    "thermal_relaxation": {
        "fading": _plain(lambda c: 0.01 / c["longest"], lambda c: 5 / c["longest"]),
        "activated": _plain(lambda c: 0.002 / c["longest"], lambda c: 3 / c["longest"]),
        "arrhenius": lambda rng, c: ({"speed": float(c["speed"])}, 0.002 * c["top"], 0.03 * c["top"], False),
    },
    "distributed_memory": {"plays": _memory, "stops": _memory, "preisach": _density},
    "amplitude_gain": {
        "rayleigh": _plain(lambda c: 1e-3 / c["top"], lambda c: 0.4 / c["top"]),
        "span": _plain(lambda c: 1e-3 / c["top"], lambda c: 0.2 / c["top"]),
    },
    "quadratic_gain": {"voltage": _BOW, "force": _BOW},
    "saturation": {
        "voltage": _plain(lambda c: 0.05 / c["top"], lambda c: 1 / c["top"]),
        "force": _plain(lambda c: 0.05 / c["top"], lambda c: 1 / c["top"]),
        "cubic": _plain(lambda c: 0.03 / c["top"], lambda c: 0.5 / c["top"]),
    },
    "creep": {"kelvin_voigt": _elements, "voltage": _elements, "logarithmic": _logarithmic},
    "drift": {"exponential": _drifting, "ramp": _drifting, "walk": _drifting},
    "cross_coupling": {"force": _CROSS, "voltage": _CROSS, "displacement": _CROSS},
    "kinematic_coupling": {"displacement": _CROSS},
    "resonance": dict.fromkeys(("parallel_force", "parallel_voltage", "series_force", "series_voltage"), _second),
    "friction": {
        "lugre_inside": _bristles,
        "lugre_ahead": _bristles,
        "dahl_inside": _rubbing,
        "dahl_ahead": _rubbing,
        "coulomb_inside": _dry,
        "coulomb_ahead": _dry,
    },
    "load_mass": {"payload": _plain(lambda c: 0.01, lambda c: 2.0)},
    "viscous_damping": {"damper": _plain(lambda c: 0.002, lambda c: 0.5)},
    "cubic_stiffness": {"hardening": _plain(lambda c: 0.003 / c["stroke"] ** 2, lambda c: 0.4 / c["stroke"] ** 2)},
    "amplifier_lag": {"one_pole": _TAU, "two_poles": _TAU},
    "sensor_lag": {"one_pole": _TAU, "two_order": _TAU},
    "delay": {
        "constant": _TAU,
        "jitter": lambda rng, c: (
            {"jitter": float(rng.uniform(0.003, 0.015))},
            0.05 / c["fastest"],
            40 / c["fastest"],
            False,
        ),
    },
    "slew_limit": {
        "clip": _plain(lambda c: 0.8 / c["swiftest"], lambda c: 30 / c["swiftest"]),
        "saturating_lag": lambda rng, c: (
            {"time": 0.02 / c["fastest"]},
            0.8 / c["swiftest"],
            30 / c["swiftest"],
            False,
        ),
    },
    "periodic_disturbance": {"output": _tone, "ripple": _tone},
    "encoder_cyclic_error": {"grating": _grating},
    "outside": {
        "stick_slip": _jumping,
        "ageing_gain": _ageing,
        "linkage_backlash": _plain(lambda c: 1e-3 * c["stroke"], lambda c: 0.08 * c["stroke"]),
        "warm_gain": _warm,
        "crossover": _plain(lambda c: 0.002 * c["top"], lambda c: 0.06 * c["top"]),
    },
}

# Paces of a campaign that excite an effect, and kinds of record that must be in it.
NEEDS = {
    "asymmetry": (("slow", "wide", "fast"), ("nested", "triangle")),
    "rate_dependence": (("slow", "wide"), ("two_rates",)),
    "thermal_relaxation": (("slow",), ("steps",)),
    "distributed_memory": (("slow", "wide"), ("nested",)),
    "amplitude_gain": (("slow", "wide"), ("two_amplitudes",)),
    "quadratic_gain": (("slow", "wide", "fast"), ("triangle",)),
    "saturation": (("slow", "wide", "fast"), ("triangle",)),
    "creep": (("slow",), ("steps",)),
    "drift": (("slow",), ("steps",)),
    "cross_coupling": (("slow", "wide", "fast"), ("triangle",)),
    "kinematic_coupling": (("slow", "wide", "fast"), ("triangle",)),
    "resonance": (("fast", "wide"), ("chirp",)),
    "friction": (("slow", "wide", "fast"), ("nested",)),
    "load_mass": (("fast", "wide"), ("chirp",)),
    "viscous_damping": (("fast", "wide"), ("chirp",)),
    "cubic_stiffness": (("slow", "wide", "fast"), ("triangle",)),
    "amplifier_lag": (("fast", "wide"), ("multisine",)),
    "sensor_lag": (("fast", "wide"), ("multisine",)),
    "delay": (("fast", "wide"), ("chirp",)),
    "slew_limit": (("fast", "slow"), ("steps",)),
    "periodic_disturbance": (("slow", "wide"), ("triangle",)),
    "encoder_cyclic_error": (("slow", "wide", "fast"), ("triangle",)),
    "outside": (("slow",), ("triangle",)),
}
