"""What can be hidden in the stage: the strength of each effect in its plausible range, and how it enters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.signal import lfilter

from experiments.hidden_effect.campaign import Array, Drive
from experiments.hidden_effect.stage import Stage, simulate

Shape = Mapping[str, Any]
LADDER = np.geomspace(0.01, 1e4, 37)


@dataclass(frozen=True)
class Hidden:
    """An effect: strengths up to `most` of either sign (or one), `shape` drawn once, and what it does.

    `of_stage` gives quantities of the stage, `of_sensor` what is added to the position of one record.
    """

    most: float
    unit: str
    signs: tuple[int, ...] = (1,)
    shape: Callable[[np.random.Generator], Shape] = lambda rng: {}
    of_stage: Callable[[float, Shape], Shape] = lambda strength, shape: {}
    of_sensor: Callable[[float, Shape, int, Drive, Array], Array] | None = None


def quantity(name: str) -> Callable[[float, Shape], Shape]:
    return lambda strength, shape: {name: strength, **shape}


def inverse(name: str) -> Callable[[float, Shape], Shape]:
    return lambda strength, shape: {name: 1 / strength if strength else np.inf}


def creep(strength: float, shape: Shape) -> Shape:
    """Logarithmic: strength a decade of time, by a dense ladder."""
    decade = np.log10(LADDER[1] / LADDER[0])
    return {"creep": np.full(len(LADDER), strength * decade), "creep_times": LADDER}


def plays(strength: float, shape: Shape) -> Shape:
    return {"weights": strength * np.array(shape["share"]), "thresholds": np.array(shape["thresholds"])}


def draw_plays(rng: np.random.Generator) -> Shape:
    thresholds = np.sort(rng.uniform(2, 60, 12))
    return {"share": rng.dirichlet(np.full(12, 2.0)).tolist(), "thresholds": thresholds.tolist()}


def drift(strength: float, shape: Shape, index: int, drive: Drive, x: Array) -> Array:
    return strength * shape["amounts"][index] * (1 - np.exp(-drive.time / shape["time"]))


def hum(strength: float, shape: Shape, index: int, drive: Drive, x: Array) -> Array:
    return strength * np.sin(2 * np.pi * shape["frequency"] * drive.time + shape["phases"][index])


def cyclic(strength: float, shape: Shape, index: int, drive: Drive, x: Array) -> Array:
    return strength * np.sin(2 * np.pi * x / shape["pitch"] + shape["phase"])


def heating(strength: float, shape: Shape, index: int, drive: Drive, x: Array) -> Array:
    """Losses go with U'^2 (80 Hz, 40 V as the unit); the warm stack grows."""
    power = (np.gradient(drive.u_x, 1 / drive.rate) / (40 * 2 * np.pi * 80)) ** 2
    keep = np.exp(-1 / (drive.rate * shape["time"]))
    return strength * lfilter([1 - keep], [1, -keep], power)


def jumps(strength: float, shape: Shape, index: int, drive: Drive, x: Array) -> Array:
    """Lost counts: steps up and down at chance times."""
    places = np.array(shape["places"][index]) * drive.time[-1]
    return strength * sum((drive.time > at) * step for at, step in zip(places, shape["steps"][index], strict=True))


def freeze(strength: float, shape: Shape, index: int, drive: Drive, x: Array) -> Array:
    """The reading stands still for `strength` seconds at chance times."""
    frozen = x.copy()
    for place in shape["places"][index]:
        first = int(place * len(x))
        last = min(first + round(strength * drive.rate), len(x))
        frozen[first:last] = x[first]
    return frozen - x


def _places(rng: np.random.Generator, records: int, count: int) -> list[list[float]]:
    return np.sort(rng.uniform(0.05, 0.9, (records, count))).tolist()


def draw_jumps(rng: np.random.Generator) -> Shape:
    return {"places": _places(rng, 8, 4), "steps": rng.normal(size=(8, 4)).tolist()}


CATALOGUE = {
    "creep": Hidden(0.03, "1/decade", of_stage=creep),
    "thermal_relaxation": Hidden(0.4, "1/s", of_stage=quantity("relaxation")),
    "rate_dependence": Hidden(0.15, "1/decade", of_stage=quantity("rate")),
    "amplifier_lag": Hidden(1.5e-3, "s", of_stage=quantity("amplifier_lag")),
    "sensor_lag": Hidden(1.5e-3, "s", of_stage=quantity("sensor_lag")),
    "slew_limit": Hidden(2e-4, "s/V", of_stage=inverse("slew")),
    "delay": Hidden(3e-3, "s", of_stage=quantity("delay")),
    "asymmetry": Hidden(4e-5, "um/V^2", (-1, 1), of_stage=quantity("asymmetry")),
    "quadratic_gain": Hidden(2e-4, "um/V^2", (-1, 1), of_stage=quantity("quadratic")),
    "saturation": Hidden(6e-3, "1/V", of_stage=quantity("saturation")),
    "distributed_memory": Hidden(0.05, "um/V", (-1, 1), draw_plays, plays),
    "amplitude_gain": Hidden(2e-4, "um/V^2", of_stage=quantity("amplitude_gain")),
    "cross_coupling": Hidden(0.1, "1", (-1, 1), of_stage=quantity("force_coupling")),
    "kinematic_coupling": Hidden(0.1, "1", (-1, 1), of_stage=quantity("kinematic_coupling")),
    "resonance": Hidden(
        0.25,
        "1",
        (-1, 1),
        lambda rng: {"mode_frequency": 500 * 6 ** rng.uniform(), "mode_damping": 0.005 * 6 ** rng.uniform()},
        quantity("mode_share"),
    ),
    "load_mass": Hidden(0.3, "kg", of_stage=quantity("load")),
    "viscous_damping": Hidden(1000.0, "N s/m", of_stage=quantity("more_damping")),
    "cubic_stiffness": Hidden(1e-3, "1/um^2", of_stage=quantity("cubic")),
    "friction": Hidden(
        0.5,
        "um",
        shape=lambda rng: {"presliding": 0.2 * 10 ** rng.uniform(), "stiction": rng.uniform(1, 1.04)},
        of_stage=quantity("friction"),
    ),
    "drift": Hidden(
        2.0,
        "um",
        (-1, 1),
        lambda rng: {"amounts": rng.normal(1, 0.2, 8).tolist(), "time": 5 * 40 ** rng.uniform()},
        of_sensor=drift,
    ),
    "periodic_disturbance": Hidden(
        0.3,
        "um",
        shape=lambda rng: {"frequency": rng.choice([50, 60, 100, 25]) + rng.uniform(-2, 2), "phases": _phases(rng)},
        of_sensor=hum,
    ),
    "encoder_cyclic_error": Hidden(
        0.3,
        "um",
        shape=lambda rng: {"pitch": 2 * 10 ** rng.uniform(), "phase": rng.uniform(0, 2 * np.pi)},
        of_sensor=cyclic,
    ),
}
OUTSIDE = {
    "gain_aging": Hidden(0.5, "1/h", (-1, 1), of_stage=quantity("aging")),
    "product_coupling": Hidden(1e-4, "um/V^2", (-1, 1), of_stage=quantity("product_coupling")),
    "driver_resolution": Hidden(4.0, "V", of_stage=quantity("resolution")),
    "driver_clipping": Hidden(60.0, "V", of_stage=lambda strength, shape: {"clip": 150 - strength}),
    "depoling": Hidden(0.2, "1", of_stage=quantity("depoling")),
    "cable_snag": Hidden(
        0.5,
        "um",
        shape=lambda rng: {"snag_at": rng.uniform(2.5, 5.5), "snag_width": rng.uniform(0.2, 0.6)},
        of_stage=quantity("snag"),
    ),
    "self_heating": Hidden(3.0, "um", shape=lambda rng: {"time": rng.uniform(0.5, 4)}, of_sensor=heating),
    "lost_counts": Hidden(1.0, "um", shape=draw_jumps, of_sensor=jumps),
    "frozen_reading": Hidden(0.5, "s", shape=lambda rng: {"places": _places(rng, 8, 5)}, of_sensor=freeze),
}
EFFECTS = CATALOGUE | OUTSIDE


def _phases(rng: np.random.Generator) -> list[float]:
    return rng.uniform(0, 2 * np.pi, 8).tolist()


@dataclass(frozen=True)
class Dose:
    """One effect at one strength."""

    effect: str
    strength: float
    shape: Shape


def respond(stage: Stage, doses: list[Dose], drive: Drive, index: int, hours: float, step: float) -> Array:
    """Position of x in um on one record, the sensor's own errors included, its noise not."""
    changes: dict[str, Any] = {"step": step}
    for dose in doses:
        changes |= EFFECTS[dose.effect].of_stage(dose.strength, dose.shape) if dose.strength else {}
    x = simulate(stage._replace(**changes), drive.time, drive.u_x, drive.u_y, hours)
    for dose in doses:
        if (added := EFFECTS[dose.effect].of_sensor) and dose.strength:
            x = x + added(dose.strength, dose.shape, index, drive, x)
    return x
