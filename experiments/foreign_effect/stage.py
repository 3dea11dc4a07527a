"""A stage: amplifier, hysteresis, creep, coupling, mechanics, sensor; voltages of a record in, readings out.

Order of the chain: delay, slew limit, amplifier lag, hysteresis, static curve, creep, coupling, mechanics, kinematic
coupling, drift, hum, sensor lag, cyclic error (physics of the field: Fleming & Leang 2014, ch. 2 and 11).
"""

import math
from dataclasses import dataclass, field

import numpy as np

from . import effects as act
from .mechanics import carry
from .operators import bouc_wen, everett_table, free_energy, plays, prandtl_ishlinskii, preisach_density, rayleigh


@dataclass
class Axis:
    """One axis: hysteresis `base` {kind, parameters}, mechanics `modes`, and effects {id: {form, size, plan}}."""

    base: dict
    modes: list
    effects: dict = field(default_factory=dict)
    tables: dict = field(default_factory=dict, repr=False)

    def size(self, effect):
        """(form, size, plan) of an effect, or None."""
        found = self.effects.get(effect)
        return (found["form"], found["size"], found) if found and found["size"] else None


def _memory(axis, base):
    """Everett table of a Preisach base, kept between calls."""
    key = tuple(sorted((k, v) for k, v in base.items() if k != "gain"))
    if key not in axis.tables:
        arguments = {k: base[k] for k in ("remanence", "coercive", "spread", "interaction", "law", "reach")}
        axis.tables[key] = everett_table(**arguments)
    return axis.tables[key]


def _growth(form, size, v0):
    """Factor of alpha by the rate of the voltage."""
    if form == "log10":
        return lambda v: np.maximum(1 + size * np.log10(np.maximum(v, 1e-3 * v0) / v0), 0.0)
    if form == "log1p":
        return lambda v: np.maximum(1 + size * np.log1p(v / v0), 0.0)
    return lambda v: np.power(np.maximum(v, 1e-6 * v0) / v0, size)


def _fading(form, rate, scale):
    """What time does to h: dh/dt = -rate h, or -rate scale sinh(h / scale), which is fast while h is large."""
    if form == "fading":
        return lambda h, dt: h * math.exp(-rate * dt)

    def activated(h, dt):
        return 2 * scale * math.atanh(math.tanh(h / 2 / scale) * math.exp(-rate * dt))

    return activated


def _bouc_wen(axis, u, dt):
    b, extra = axis.base, {}
    gain, alpha, beta, gamma = (b[key] for key in ("gain", "alpha", "beta", "gamma"))
    if found := axis.size("rate_dependence"):
        extra["growth"] = _growth(found[0], found[1], found[2]["speed"])
    if found := axis.size("asymmetry"):
        form, size, plan = found
        if form == "voltage":
            extra["tilt"] = size * alpha * gain
        elif form == "constant":
            extra["lean"] = size * alpha * gain
        else:
            extra["shape"] = {key: size * share for key, share in plan["shares"].items()} | {"centre": plan["centre"]}
    if found := axis.size("thermal_relaxation"):
        extra["fade"] = _fading(found[0], found[1], 0.4 * alpha * gain / (beta + gamma))
    return bouc_wen(u, gain, alpha, beta, gamma, dt=dt, **extra)


def _operator(axis, u, dt):
    """Displacement asked for by the base hysteresis and what acts inside it."""
    b = axis.base
    if b["kind"] == "bouc_wen":
        return _bouc_wen(axis, u, dt)
    if b["kind"] == "plays":
        return prandtl_ishlinskii(u, b["gain"], b["weights"], b["widths"])
    if b["kind"] == "preisach":
        return preisach_density(u, b["gain"], _memory(axis, b))
    if b["kind"] == "free_energy":
        found = axis.size("thermal_relaxation")
        extra = {"theta": found[1], "speed": found[2]["speed"]} if found else {}
        values = (b[key] for key in ("gain", "remanence", "coercive", "spread", "interaction"))
        return free_energy(u, *values, dt=dt, **extra)
    return b["gain"] * u


def _more_memory(axis, u, f):
    """Memory and gain that the base operator does not have."""
    gain = axis.base["gain"]
    if found := axis.size("distributed_memory"):
        form, size, plan = found
        if form == "stops":
            inner = u[:, None] - plays(u, plan["widths"])
            f = f - size * gain * inner @ np.array(plan["weights"])
        elif form == "plays":
            f = f + size * gain * plays(u, plan["widths"]) @ np.array(plan["weights"])
        else:
            density = {"remanence": size * gain * plan["reach"], "reach": 2.5 * plan["reach"], "law": "lognormal"}
            density |= {key: plan[key] for key in ("coercive", "spread", "interaction")}
            f = f + preisach_density(u, 0.0, _memory(axis, density))
    if found := axis.size("amplitude_gain"):
        form, size, _ = found
        f = f + (rayleigh(u, size * gain) if form == "rayleigh" else size * gain * act.running_span(u) * u)
    return f


def ahead(axis, u, t, dt):
    """Voltage at the actuator."""
    if found := axis.size("delay"):
        u = act.delay(u, t, found[1])
    if found := axis.size("slew_limit"):
        form, size, plan = found
        u = act.rate_clip(u, dt, 1 / size) if form == "clip" else act.saturating_lag(u, dt, 1 / size, plan["time"])
    if found := axis.size("amplifier_lag"):
        u = act.input_lag(u, dt, found[0], found[1])
    if (found := axis.size("outside")) and found[0] == "crossover":
        u = act.crossover(u, found[1])
    return u


def actuate(axis, u, t, dt, record):
    """(displacement asked for, voltage at the actuator)."""
    u = ahead(axis, u, t, dt)
    if (found := axis.size("periodic_disturbance")) and found[0] == "ripple":
        u = u + act.hum(t, found[1] / axis.base["gain"], found[2], record)
    f = _more_memory(axis, u, _operator(axis, u, dt))
    gain = axis.base["gain"]
    if found := axis.size("quadratic_gain"):
        f = act.curved(f, u, gain, *found[:2])
    if found := axis.size("saturation"):
        f = act.saturating(f, u, gain, *found[:2])
    if found := axis.size("creep"):
        f = act.creep(f, gain * u, dt, found[0], found[1], found[2])
    return f, u


def plan_of(axis):
    """Mechanics with what acts in them; loads and dampers move the first mode."""
    modes = [tuple(m) for m in axis.modes]
    if modes and (found := axis.size("load_mass")):
        f1, z1, share = modes[0]
        modes[0] = (f1 / math.sqrt(1 + found[1]), z1 / math.sqrt(1 + found[1]), share)
    if modes and (found := axis.size("viscous_damping")):
        modes[0] = (modes[0][0], modes[0][1] + found[1], modes[0][2])
    plan = {"modes": modes}
    if found := axis.size("cubic_stiffness"):
        plan["cubic"] = found[1]
    if found := axis.size("resonance"):
        place, drive = found[0].split("_")
        plan["second"] = {"place": place, "drive": drive, "share": found[1]} | found[2]["mode"]
    if found := axis.size("friction"):
        kind, place = found[0].split("_")
        law = found[2]["law"]
        plan["friction"] = {"kind": kind, "place": place, "level": found[1]}
        plan["friction"] |= {key: found[1] * value for key, value in law["scaled"].items()} | law["fixed"]
    return plan


def sense(axis, x, t, dt, record, fine, rng):
    """Reading without noise."""
    since = np.maximum(t, 0.0)  # what a record begins with begins at its first sample
    if found := axis.size("drift"):
        x = x + act.drift(since, *found, record)
    if (found := axis.size("periodic_disturbance")) and found[0] != "ripple":
        x = x + act.hum(t, found[1], found[2], record)
    if (found := axis.size("outside")) and found[0] != "crossover":
        x = act.outside(x, since, *found)
    if found := axis.size("sensor_lag"):
        x = act.sensor_lag(x, dt, found[0], found[1])
    if found := axis.size("encoder_cyclic_error"):
        x = act.cyclic_error(x, found[1], found[2])
    if (found := axis.size("delay")) and found[0] == "jitter":
        x = act.jittered(x, t, found[2]["jitter"] * found[1], fine, rng)
    return x


def coupled(axes, forces, voltages):
    """Forces of each axis with what comes from the other one: its force, its voltage (its displacement comes later)."""
    out = dict(forces)
    for name, other in (("x", "y"), ("y", "x")):
        if other in axes and name in axes and (found := axes[name].size("cross_coupling")):
            form, size, _ = found
            gain = axes[other].base["gain"]
            if form in ("force", "voltage"):
                out[name] = forces[name] + size * (forces[other] if form == "force" else gain * voltages[other])
    return out


def simulate(axes, drives, sample, fine, record=0, seed=0, lead=0):
    """Clean readings {axis: y} of the voltages {axis: u} at `sample` seconds, `fine` steps to a sample.

    The first `lead` samples are ahead of the record: simulated, not read, and at times below zero.
    """
    rng = np.random.default_rng([seed, record])
    n = len(next(iter(drives.values())))
    dt = sample / fine
    t = np.arange(-lead * fine, (n - 1 - lead) * fine + 1) * dt
    u = {name: np.interp(t, np.arange(-lead, n - lead) * sample, drive) for name, drive in drives.items()}
    asked = {name: actuate(axes[name], u[name], t, dt, record) for name in axes}
    forces = coupled(axes, {k: v[0] for k, v in asked.items()}, {k: v[1] for k, v in asked.items()})
    moved = {}
    for name in sorted(axes, reverse=True):  # y first: x may be pushed by where y is
        found = axes[name].size("cross_coupling")
        if found and found[0] == "displacement" and "y" in moved:
            forces[name] = forces[name] + found[1] * moved["y"]
        moved[name] = carry(forces[name], axes[name].base["gain"] * asked[name][1], dt, plan_of(axes[name]))
    if found := axes["x"].size("kinematic_coupling"):
        moved["x"] = moved["x"] + found[1] * moved["y"]
    return {name: sense(axes[name], moved[name], t, dt, record, fine, rng)[lead * fine :: fine] for name in axes}
