"""A stage: amplifier, hysteresis, bends, creep, mechanics, coupling, sensor; voltages of records in, readings out.

What acts is given as {effect: {"size": amplitude, ...}}; an effect of size zero is absent.
"""

import math

import numpy as np
from numba import njit
from scipy import signal

from . import operators
from .mechanics import KINDS, NO_FRICTION, Friction, Table, linear, motion

PLAYS = 8


@njit(cache=True)
def slew_limited(u, dt, steepest):
    """The output runs after the command at the largest current; Fleming & Leang (2014), ch. 14."""
    y, now = np.empty_like(u), u[0]
    for i in range(u.size):
        if i:
            gap = u[i] - now
            step = max(-steepest, min(steepest, gap / 1e-9)) * dt
            now += gap if abs(step) > abs(gap) else step
        y[i] = now
    return y


def _amplifier(u, t, dt, acting):
    """Voltage at the actuator: fixed delay, dead zone of the output stage about 0 V, lag, current limit."""
    if found := acting.get("crossover_distortion"):
        u = u - found["size"] * np.tanh(u / found["width"]) + found["size"] * np.tanh(u[0] / found["width"])
    if found := acting.get("amplifier_lag"):
        lag = found["size"]
        u = linear(u, dt, [1.0], [lag * lag / 4, lag, 1.0] if found["poles"] == 2 else [lag, 1.0])
    if found := acting.get("slew_limit"):
        u = slew_limited(u, dt, 1 / found["size"])
    return u


def _hysteresis(u, dt, axis, acting):
    """Base operator with what acts inside it, and further plays beside it."""
    get = acting.get
    rate, relaxation, asymmetry = get("rate_dependence", {}), get("thermal_relaxation", {}), get("asymmetry", {})
    skew = asymmetry.get("size", 0.0) if asymmetry.get("by") == "voltage" else 0.0
    branch = asymmetry.get("size", 0.0) if asymmetry.get("by") == "branch" else 0.0
    growth = (rate.get("size", 0.0), rate.get("speed", 1.0))
    if axis["base"] == "bouc_wen":
        law = [axis[key] for key in ("gain", "alpha", "beta", "gamma")]
        fading = (relaxation.get("size", 0.0), relaxation.get("scale", 0.0))
        y = operators.bouc_wen(u, dt, *law, branch, skew, *growth, *fading)
    elif axis["base"] == "prandtl_ishlinskii":
        weights = np.array([axis[f"weight_{i}"] for i in range(1, PLAYS + 1)])
        widths = np.arange(1, PLAYS + 1) * axis["reach"] / PLAYS
        y = operators.plays(u, dt, axis["gain"], weights, widths, *growth)
    else:
        law = [axis[key] for key in ("gain", "remanence", "coercive", "spread", "interaction")]
        y = operators.free_energy(u, *law)
    if found := get("distributed_memory"):
        weights = np.asarray(found["weights"], float)
        weights = weights / np.sum(weights) * axis["gain"]
        y = y + found["size"] * operators.plays(u, dt, 0.0, weights, np.asarray(found["widths"], float), 0.0, 1.0)
    return y


def _bent(y, u, t, axis, record, command, acting):
    """Static curves and gains: electrostriction, ageing, warming, gain by range, saturation.

    Newnham, Sundar, Yimnirun, Su & Zhang (1997), J. Phys. Chem. B 101, 10141 (u^2); Damjanovic (1997), Phys. Rev. B 55,
    R649 (gain by range); Jiles & Atherton (1986), J. Magn. Magn. Mater. 61, 48 (Langevin's function).
    """
    if found := acting.get("quadratic_gain"):
        y = y + axis["gain"] * found["size"] * u * u
    if found := acting.get("ageing"):
        way = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(u))))) + record["way"]
        y = y * (1 - found["size"] * (1 - np.exp(-way / found["over"])))
    if found := acting.get("gain_warm_up"):
        y = y * (1 + found["size"] * np.exp(-(record["start"] + t) / found["time"]))
    if found := acting.get("amplitude_gain"):
        y = y * (1 + found["size"] * (np.ptp(command) / 100.0) ** found["power"])
    if found := acting.get("saturation"):
        most = 1 / found["size"]
        if found["law"] == "arctan":
            return most * 2 / np.pi * np.arctan(np.pi * y / (2 * most))
        z = 3 * y / most
        z = np.where(np.abs(z) < 1e-4, 1e-4, z)
        y = most * (1 / np.tanh(z) - 1 / z)
    return y


def asked(axis, record, index, acting, t, dt, rate):
    """Displacement that the voltage of one axis asks for, force over stiffness."""
    command = record["u"][index]
    late = acting["delay"]["size"] if acting.get("delay", {}).get("of") == "command" else 0.0
    u = np.interp(t - late, np.arange(len(command)) / rate, command)
    u = _amplifier(u, t, dt, acting)
    y = _bent(_hysteresis(u, dt, axis, acting), u, t, axis, record, command, acting)
    if found := acting.get("creep"):
        y = operators.creep(y, dt, found["size"] * np.asarray(found["shares"]), np.asarray(found["times"]))
    return y


def _table(axis, acting):
    def size(effect):
        return acting.get(effect, {}).get("size", 0.0)

    bend, damper, rider = (acting.get(key, {}) for key in ("cubic_stiffness", "viscous_damping", "resonance"))
    critical = 2 * math.sqrt(axis["stiffness"] * axis["mass"])
    carried = size("resonance") * axis["mass"] if rider.get("place") == "rider" else 0.0
    w = 2 * np.pi * rider.get("frequency", 1.0)
    return Table(
        mass=axis["mass"] * (1 + size("load_mass")),
        damping=axis["damping"],
        stiffness=axis["stiffness"],
        quadratic=bend.get("quadratic", 0.0),
        cubic=size("cubic_stiffness"),
        drag=size("quadratic_drag") * axis["damping"] / 1e4,
        eddy=size("viscous_damping") * critical,
        gap=damper.get("gap", 1e9),
        rider_mass=carried,
        rider_stiffness=carried * w**2,
        rider_damping=2 * carried * rider.get("damping", 0.0) * w,
    )


def _friction(acting):
    found = acting.get("friction")
    if not found:
        return NO_FRICTION
    level, kind = found["size"], KINDS[found["law"]]
    bristle = found["reach"] if found["law"] == "slip" else level / found["reach"]
    return Friction(
        kind, bristle, level, level * (1 + found.get("stiction", 0.0)), found.get("speed", 1.0), found.get("inner", 0.0)
    )


def _moved(axes, forces, acting, dt):
    """Places of all axes: equations of motion if there is a mass, a second mode in parallel, a turned sensor."""
    places = forces
    coupling = acting.get("cross_coupling", {})
    if "mass" in axes[0]:
        two = len(axes) > 1
        spring = coupling["size"] * axes[0]["stiffness"] if coupling.get("by") == "spring" else 0.0
        push = coupling["size"] if coupling.get("by") == "force" else 0.0
        table = _table(axes[0], acting)
        other = _table(axes[1], {}) if two else table
        still = np.zeros_like(forces[0])
        both = motion(forces[0], forces[1] if two else still, dt, table, other, two, spring, push, _friction(acting))
        places = [both[i] for i in range(len(axes))]
    mode = acting.get("resonance", {})
    if mode.get("place") == "parallel":
        w = 2 * np.pi * mode["frequency"]
        second = linear(forces[0], dt, [1.0], [1 / w / w, 2 * mode["damping"] / w, 1.0])
        places = [places[0] + mode["size"] * (second - places[0]), *places[1:]]
    if turned := acting.get("kinematic_coupling"):
        x, y = places
        places = [x + turned["size"] * y, y + turned.get("back", 0.0) * x]
    return places


def _read(x, t, dt, record, number, acting):
    """Reading of x: grating, drift of the frame, hum, slipping mount, filter, delay, clock of the recorder.

    Heydemann (1981), Appl. Opt. 20, 3382 (errors of quadrature signals).
    """
    if found := acting.get("encoder_cyclic_error"):
        angle, phase = 2 * np.pi * x / found["period"], found["phase"]
        first = np.sin(angle + phase) - math.sin(phase)
        x = x + found["size"] * (first + found["second"] * np.sin(2 * angle + found["second_phase"]))
    if found := acting.get("drift"):
        if "time" in found:
            start = record["start"]
            x = x + found["size"] * (np.exp(-start / found["time"]) - np.exp(-(start + t) / found["time"]))
        else:
            x = x + found["size"] * found["slopes"][number] * t
    if found := acting.get("periodic_disturbance"):
        for order, (share, phase) in enumerate(zip(found["harmonics"], record["phases"], strict=True), start=1):
            x = x + found["size"] * share * np.sin(2 * np.pi * found["frequency"] * order * t + phase)
    if found := acting.get("sensor_jumps"):
        x = x + found["size"] * np.interp(t, *record["slips"])
    if found := acting.get("sensor_lag"):
        x = linear(x, dt, *signal.butter(found["poles"], 1 / found["size"], analog=True))
    if acting.get("delay", {}).get("of") == "reading":
        x = np.interp(t - acting["delay"]["size"], t, x)
    if found := acting.get("clock_skew"):
        x = np.interp(np.minimum(t * (1 + found["size"]), t[-1]), t, x)
    return x


def simulate(records, rate, fine, axes, acting):
    """Readings without noise, an array (axes, samples) of each record; `fine` steps to a sample.

    What acts does so on the first axis; on others only where it says so by "both".
    """
    acting = {effect: found for effect, found in acting.items() if found["size"]}
    shared = {effect: found for effect, found in acting.items() if found.get("both")}
    dt, out = 1 / (rate * fine), []
    for number, record in enumerate(records):
        t = np.arange((record["u"].shape[1] - 1) * fine + 1) * dt
        forces = [asked(a, record, i, shared if i else acting, t, dt, rate) for i, a in enumerate(axes)]
        x, *others = _moved(axes, forces, acting, dt)
        out.append(np.array([place[::fine] for place in (_read(x, t, dt, record, number, acting), *others)]))
    return out
