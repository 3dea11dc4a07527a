"""From a stage of the list to its case: base, drives, noise, and amplitudes scaled to a size in noise floors.

The size of an effect is what it changes in the readings less what the free base parameters and an offset of each record
take up of that to first order, over the noise.
"""

import zlib

import numpy as np
from scipy import signal

from . import stages
from .drives import drive
from .stage import simulate

FREE = {
    "bouc_wen": ("gain", "alpha", "beta", "gamma"),
    "prandtl_ishlinskii": ("gain", *(f"weight_{i}" for i in range(1, 9))),
    "homogenized_energy": ("gain", "remanence", "coercive", "spread", "interaction"),
}
MECHANICS = ("mass", "damping", "stiffness")


def free_names(axis, fixed=()):
    """Parameters of an axis that its job leaves free."""
    names = FREE[axis["base"]] + (MECHANICS if "mass" in axis else ())
    return [name for name in names if name not in fixed]


def _base(rng, kind, top, resonance, damping):
    """Parameters of one axis."""
    if kind == "bouc_wen":
        while True:
            both, share = rng.uniform(3.5, 8) / top, rng.uniform(0.35, 0.9)
            axis = {"gain": rng.uniform(0.05, 0.13), "alpha": rng.uniform(0.22, 0.55)}
            axis |= {"beta": both * share, "gamma": both * (1 - share)}
            if axis["alpha"] * max(1, 2 * share) < 0.8:
                break
    elif kind == "prandtl_ishlinskii":
        axis = {"gain": rng.uniform(0.04, 0.09), "reach": 0.5 * top}
        weights = np.exp(-np.arange(8) / rng.uniform(2, 5)) * rng.uniform(0.7, 1.3, 8)
        weights *= axis["gain"] * rng.uniform(0.35, 0.6) / weights.sum()
        axis |= {f"weight_{i}": weight for i, weight in enumerate(weights, start=1)}
    else:
        axis = {"gain": rng.uniform(0.04, 0.07), "remanence": top * rng.uniform(0.5, 1.0)}
        axis |= {"coercive": top * rng.uniform(0.12, 0.25), "spread": rng.uniform(0.4, 0.7)}
        axis["interaction"] = top * rng.uniform(0.4, 0.8)
    if resonance:
        mass, w = rng.uniform(0.05, 0.4), 2 * np.pi * resonance
        axis |= {"mass": mass, "stiffness": mass * w * w, "damping": 2 * damping * mass * w}
    return {"base": kind} | {name: float(value) for name, value in axis.items()}


def _records(rng, stage, top):
    """Voltages of all records, with what goes on from one to the next and what chance does in each."""
    rate, resonance, out, start, way = stage["rate"], stage.get("resonance", 0), [], 0.0, 0.0
    for run in stage["records"]:
        voltages = [drive(rng, run.kind, rate, run.seconds, top * run.share, run.frequency, resonance)]
        if stage.get("two"):
            kind, frequency = run.other
            voltages.append(drive(rng, kind, rate, run.seconds, top * 0.9, frequency, resonance))
        record = {"u": np.round(np.array(voltages), 4), "use": run.use, "kind": run.kind, "start": start, "way": way}
        record["phases"] = rng.uniform(0, 2 * np.pi, 4)
        count = max(1, int(rng.poisson(3)))
        times, levels = np.sort(rng.uniform(0.1, 0.95, count)) * run.seconds, np.cumsum(rng.standard_normal(count))
        edges, before = np.ravel([[time, time + 2e-3] for time in times]), np.r_[0, levels[:-1]]
        record["slips"] = (np.r_[0, edges], np.r_[0, np.ravel(np.stack([before, levels], axis=1))])
        start += run.seconds * 1.2
        way += float(np.abs(np.diff(record["u"][0])).sum())
        out.append(record)
    return out


def simulated(case, effects, axes=None, fine=None):
    """Readings without noise, with these of the case's effects."""
    acting = {effect["effect"]: effect["acts"] for effect in effects}
    return simulate(case["records"], case["rate"], fine or case["fine"], axes or case["axes"], acting)


def _stacked(readings):
    """All readings less an offset of each record, in one row."""
    return np.concatenate([reading - reading.mean(1, keepdims=True) for reading in readings], axis=1).ravel()


def _directions(case, effects):
    """Orthonormal directions in which free base parameters move the readings."""
    columns = []
    for i, axis in enumerate(case["axes"]):
        for name in free_names(axis, case["fixed"]):
            step, sides = 1e-3 * axis[name] if axis[name] else 1e-6, []
            for sign in (1, -1):
                axes = [dict(one) for one in case["axes"]]
                axes[i][name] = axis[name] + sign * step
                sides.append(_stacked(simulated(case, effects, axes)))
            column = sides[0] - sides[1]
            if length := np.linalg.norm(column):
                columns.append(column / length)
    left, scale, _ = np.linalg.svd(np.array(columns).T, full_matrices=False)
    return left[:, scale > 1e-6 * scale[0]]


def _beyond(directions, trace):
    return trace - directions @ (directions.T @ trace)


def _rms(values):
    return float(np.sqrt(np.mean(values * values)))


def _others(case, i):
    return [effect for j, effect in enumerate(case["effects"]) if j != i]


def _trace(case, i, directions):
    """What effect i changes beside the others and beyond the base."""
    changed = _stacked(simulated(case, case["effects"])) - _stacked(simulated(case, _others(case, i)))
    return _beyond(directions, changed)


def _scale(rng, case, quietest):
    """Amplitudes for sizes of 8 to 50 noise floors, 9 to 40 of pairs; where they may not reach them, other noise."""
    effects = case["effects"]
    wanted = [float(np.exp(rng.uniform(np.log(8), np.log(50)))) for _ in effects]
    if len(effects) > 1:
        wanted = [float(np.exp(rng.uniform(np.log(9), np.log(40)))) for _ in effects]
    starts, alone = [effect["acts"]["size"] for effect in effects], len(effects) == 1
    directions = None
    for turn in range(4):
        sizes = []
        for i, effect in enumerate(effects):
            if turn == 0 or not alone:
                directions = _directions(case, _others(case, i))
            sizes.append(_rms(_trace(case, i, directions)) / case["sigma"])
            if turn < 3:
                low, high = (starts[i] * end for end in effect["span"])
                size = effect["acts"]["size"] * wanted[i] / max(sizes[i], 1e-3)
                effect["acts"]["size"] = float(np.clip(size, low, high))
        if turn == 0:
            factors = [want / size for want, size in zip(wanted, np.maximum(sizes, 1e-3), strict=True)]
            reached = [np.clip(factor, *effect["span"]) for factor, effect in zip(factors, effects, strict=True)]
            short = np.mean([np.log(one / other) for one, other in zip(reached, factors, strict=True)])
            case["sigma"] = float(np.clip(case["sigma"] * float(np.exp(short)), quietest, 30e-3))
        elif turn < 3 and all(abs(size / want - 1) < 0.15 for size, want in zip(sizes, wanted, strict=True)):
            break
    traces = np.array([_rms(_trace(case, i, _directions(case, _others(case, i)))) for i in range(len(effects))])
    least, most = traces.max() / 55, traces.min() / 6
    noise = most if least > most else np.clip(case["sigma"], least, most)
    case["sigma"] = float(np.clip(noise, 0.5e-3, 30e-3))
    case["sizes"] = (traces / case["sigma"]).round(2).tolist()
    if not alone:
        _beside(case)


def _beside(case):
    """What each of two effects leaves beside an amplitude of the other, and how alike they are."""
    directions, without = _directions(case, []), _stacked(simulated(case, []))
    traces = [_beyond(directions, _stacked(simulated(case, [effect])) - without) for effect in case["effects"]]
    lengths = [np.linalg.norm(trace) for trace in traces]
    with np.errstate(invalid="ignore", divide="ignore"):
        case["alike"] = round(float(traces[0] @ traces[1] / lengths[0] / lengths[1]), 3)
        case["beside"] = []
        for i in (0, 1):
            both = np.c_[directions, _beyond(directions, traces[1 - i]) / lengths[1 - i]]
            case["beside"].append(round(_rms(_beyond(both, traces[i])) / case["sigma"], 2))


def _drawn(name, redraw):
    """(case, its generator); the same for the same name."""
    stage = stages.STAGES[name]
    rng = np.random.default_rng(zlib.crc32(name.encode()) + 17 * redraw)
    drawn = float(rng.choice([80, 100, 120, 150]))
    top, resonance = stage.get("voltage", drawn), stage.get("resonance", 0)
    case = {"name": name, "kind": stage["kind"], "rate": stage["rate"], "base": stage["base"]}
    case |= {"fine": stage.get("fine", 10 if resonance else 4), "fixed": list(stage.get("fixed", ())), "top": top}
    case["effects"] = [effect | {"acts": dict(effect["acts"])} for effect in stage["effects"]]
    factors = (1, 1.37) if stage.get("two") else (1,)
    damping = stage.get("damping", 0.015)
    case["axes"] = [_base(rng, stage["base"], top, resonance * factor, damping) for factor in factors]
    case["records"] = _records(rng, stage, top)
    case["noise"] = stage.get("noise") or str(
        rng.choice(["white", "white", "white", "ar1", "quant"], p=[0.25, 0.25, 0.25, 0.13, 0.12])
    )
    case["memory"] = float(rng.uniform(0.5, 0.9))
    sigma = float(np.exp(rng.uniform(np.log(0.5), np.log(30)))) * 1e-3
    smooth = stage["base"] == "homogenized_energy"
    if smooth:
        sigma = max(sigma, 0.012)
    case["sigma"] = stage.get("sigma", sigma * 1e3) * 1e-3
    if case["effects"]:
        _scale(rng, case, 8e-3 if smooth else 0.5e-3)
    case["clean"] = simulated(case, case["effects"])
    finer = simulated(case, case["effects"], fine=2 * case["fine"])
    errors = [_rms(one - other) for one, other in zip(case["clean"], finer, strict=True)]
    case["step_error"] = round(max(errors) / case["sigma"], 4)
    return case, rng


def _fair(case):
    """Sizes, likeness and the error of the step are within what is asked for."""
    return (
        case["step_error"] < 0.2
        and all(5 <= size <= 62 for size in case.get("sizes", []))
        and abs(case.get("alike", 0)) < 0.8
        and all(size >= 5 for size in case.get("beside", []))
        and max(float(np.ptp(reading[0])) for reading in case["clean"]) < 60
    )


def draw(name):
    """(case, its generator), drawn again up to three times where it is not fair."""
    for redraw in range(4):
        case, rng = _drawn(name, redraw)
        if _fair(case):
            break
    return case, rng


def noise(rng, case, shape):
    """Noise of the sensor in um: white, an autoregression, or what a quantiser adds its own to."""
    sigma, memory = case["sigma"], case["memory"]
    if case["noise"] == "ar1":
        pushes = rng.standard_normal(shape) * sigma * np.sqrt(1 - memory * memory)
        pushes[..., 0] *= 1 / np.sqrt(1 - memory * memory)
        return signal.lfilter([1], [1, -memory], pushes, axis=-1)
    return rng.standard_normal(shape) * sigma * (0.45 if case["noise"] == "quant" else 1)
