"""The lottery: a kind and a seed give a stage, a campaign, a job and the truth."""

import json
import math
import time
from pathlib import Path

import numpy as np

from . import jobs
from .ahead import begin
from .campaign import campaign, floor, one_frequency, read, slow_loops
from .family import Family
from .forms import FORMS, NEEDS
from .stage import Axis
from .visibility import Rig, Unsettled, apart

KINDS = {"single": 1, "pair": 2, "none": 3, "outside": 4, "family": 5, "loops": 6, "one_frequency": 7}
KINDS |= {"begun": 8, "begun_none": 9}
BEGUN = ("begun", "begun_none")  # `single` and `none`, with a drive ahead of every record
TIED = ("loops", "one_frequency")  # campaigns that may not tell two effects apart: the proposed drive is played
LEAST, MOST = 3.0, 60.0
INSIDE_BOUC_WEN = {"asymmetry", "rate_dependence"}
MECHANICAL = {"load_mass", "viscous_damping"}
COUPLED = {"cross_coupling", "kinematic_coupling"}
NAMED = [effect for effect in FORMS if effect != "outside"]
MEMORY = {"distributed_memory", "amplitude_gain"}
ANY_BASE = [e for e in NAMED if e not in INSIDE_BOUC_WEN | MEMORY | {"thermal_relaxation"}]
TITLES = (
    "XY flexure stage, campaign of the week",
    "AFM scanner",
    "stack actuator on the bench",
    "nanopositioner, unit 3",
)


class Redraw(Exception):
    """A draw whose effect could not be seen, or not be told from the other one."""


def draw_base(rng, kind, effects, span, stroke):
    """Hysteresis and its parameters."""
    low, high = span
    gain = stroke / (high - low)
    allowed = ["bouc_wen", "plays", "preisach", "free_energy"]
    if kind == "family":
        allowed = ["preisach", "plays", "free_energy"]
    elif INSIDE_BOUC_WEN & set(effects):
        allowed = ["bouc_wen"]
    elif "thermal_relaxation" in effects:
        allowed = ["bouc_wen", "free_energy"]
    elif MEMORY & set(effects):
        allowed = ["bouc_wen"]  # the others have memory of their own
    shares = np.array([2.0, 1.0, 0.7, 0.7])[: len(allowed)]
    law = str(rng.choice(allowed, p=shares / shares.sum()))
    if law == "bouc_wen":
        forgetting, share = 1 / (rng.uniform(0.06, 0.3) * high), rng.uniform(0.3, 0.9)
        alpha = min(rng.uniform(0.2, 0.6), 0.9 / max(1, 2 * share))
        base = {"alpha": alpha, "beta": share * forgetting, "gamma": (1 - share) * forgetting}
    elif law == "plays":
        count, reach = int(rng.choice([8, 8, 12, 20])), rng.uniform(0.25, 0.45) * (high - low)
        widths = reach * np.arange(1, count + 1) / count
        weights = np.exp(-widths / rng.uniform(0.1, 0.3) / high) * rng.uniform(0.5, 1.5, count)
        weights *= rng.uniform(0.25, 0.5) * gain / weights.sum()
        base = {"widths": widths.tolist(), "weights": weights.tolist(), "reach": float(reach)}
    else:
        base = {"coercive": rng.uniform(0.06, 0.2) * high, "spread": rng.uniform(0.3, 0.7)}
        base |= {"interaction": rng.uniform(0.4, 0.9) * high}
        base["remanence"] = gain * base["interaction"] * rng.uniform(0.3, 0.6)
        if law == "preisach":
            density = "normal" if rng.random() < 0.3 else "lognormal"
            base |= {"law": density, "reach": 2.0 * high}
    return {"kind": law, "gain": gain} | {k: float(v) if np.isscalar(v) and k != "law" else v for k, v in base.items()}


def count_modes(rng, effects, forms):
    """How many modes the mechanics have: those that an effect acts in, or none (a stiff stage), one or two."""
    if MECHANICAL & set(effects) or any("inside" in form for form in forms):
        return 1
    count = int(rng.choice([0, 1, 2], p=[0.4, 0.45, 0.15]))
    return min(count, 1) if {"resonance", "friction", "cubic_stiffness", *COUPLED} & set(effects) else count


def draw_modes(rng, count, needed, pace, fastest):
    """[(frequency, damping, share)]: in the band, or above it in a slow campaign that does not need them."""
    if not count:
        return []
    low, high = (0.02, 0.1) if pace != "slow" or needed else (0.1, 8.0)
    first = max(float(fastest * np.exp(rng.uniform(math.log(low), math.log(high)))), float(rng.uniform(60, 90)))
    modes = [(first, float(np.exp(rng.uniform(math.log(0.006), math.log(0.06)))), 1.0)]
    if count == 2:
        share = float(rng.uniform(0.05, 0.3))
        second = (first * float(rng.uniform(1.5, 2.5)), float(rng.uniform(0.005, 0.04)), share)
        modes = [(*modes[0][:2], 1 - share), second]
    return modes


def draw_sensor(rng, stroke, base):
    """Noise in um, white or coloured, and the counts; not below what a model of few nodes can hold."""
    least = 5e-4
    if base["kind"] in ("preisach", "free_energy"):
        least = max(0.01, 1.5e-3 * base["remanence"])
    highest = max(min(0.05, 2.5e-3 * stroke), 1.2 * least)
    sigma = float(np.exp(rng.uniform(math.log(least), math.log(highest))))
    memory = float(rng.uniform(0.5, 0.95)) if rng.random() < 0.25 else 0.0
    counts = [c for c in (0.0003, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1) if 0.5 * sigma < c < 6 * sigma]
    count = float(rng.choice(counts)) if counts and rng.random() < 0.5 else 0.0
    return {"sigma": sigma, "memory": memory, "count": count}


def surroundings(case, stroke):
    """What draws of forms know of the stage and campaign."""
    base, records = case["axes"]["x"].base, case["records"]
    speeds = np.concatenate([np.abs(np.diff(r.drives["x"])) * r.rate for r in records])
    moving = speeds[speeds > 0]
    return {
        "gain": base["gain"],
        "top": max(float(np.max(np.abs(r.drives["x"]))) for r in records),
        "stroke": stroke,
        "beta": base.get("beta", 0.0),
        "gamma": base.get("gamma", 0.0),
        "fastest": max(r.rate for r in records),
        "longest": max(r.samples / r.rate for r in records),
        "records": len(records) + (case["kind"] in TIED),
        "speed": float(np.exp(np.mean(np.log(moving)))),
        "swiftest": float(np.max(speeds)),
        "f1": case["axes"]["x"].modes[0][0] if case["axes"]["x"].modes else 0.0,
    }


def pick_form(rng, effect, base):
    """A published form of an effect that the base hysteresis can have."""
    forms = list(FORMS[effect])
    if effect == "thermal_relaxation":
        forms = ["arrhenius"] if base and base["kind"] == "free_energy" else ["fading", "activated"]
    return str(rng.choice(forms))


def draw_records(rng, kind, pace, effects, span, others, gentle):
    """Records with their voltages, of the kind of campaign that the case has."""
    if kind == "loops":
        return slow_loops(rng, span, others)
    if kind == "one_frequency":
        return one_frequency(rng, pace, span, others)
    wanted = dict.fromkeys(kind for e in effects for kind in NEEDS[e][1])
    if kind == "family":
        wanted |= {"nested": None}
    return campaign(rng, pace, tuple(wanted), span, others, gentle)


def draw_stage(rng, kind, effects):
    """Campaign and stage without its effects."""
    paces = set.intersection(*(set(NEEDS[e][0]) for e in effects)) if effects else {"slow", "wide", "fast"}
    if not paces:
        raise Redraw("no campaign shows both")
    if kind in TIED:
        paces = {"slow"} if kind == "loops" or "fast" not in paces else paces & {"slow", "fast"}
    rough = [pick_form(rng, e, None) for e in effects]
    if any("inside" in form for form in rough) and "wide" in paces:
        paces = paces - {"wide"} or paces
    pace = str(rng.choice(sorted(paces)))
    high = float(rng.choice([20, 60, 100, 120, 150]))
    span = (float(rng.choice([0.0, -0.13, -1.0], p=[0.6, 0.25, 0.15])) * high, high)
    stroke = float(np.exp(rng.uniform(math.log(5), math.log(80))))
    second = bool(COUPLED & set(effects)) or rng.random() < 0.25
    count = count_modes(rng, effects, rough)
    gentle = count > 0 and pace != "slow"
    records = draw_records(rng, kind, pace, effects, span, ("y",) if second else (), gentle)
    way = begin(rng, records, {"x": span, "y": (0.0, 0.8 * high)}) if kind in BEGUN else None
    base = draw_base(rng, kind, effects, span, stroke)
    needed = bool(MECHANICAL & set(effects)) or any("inside" in form for form in rough)
    axes = {"x": Axis(base, draw_modes(rng, count, needed, pace, max(r.rate for r in records)))}
    case = {
        "kind": kind,
        "axes": axes,
        "records": records,
        "pace": pace,
        "stroke": stroke,
        "forms": rough,
        "span": span,
        "ahead": way,
    }
    holds_both = len(axes["x"].modes) < 2  # `modal` has modes that both axes drive; here each axis has its own
    case["y_measured"] = bool(second and rng.random() < 0.45 and holds_both)
    if second:
        axes["y"] = other_axis(rng, axes["x"])
    case["sensor"] = draw_sensor(rng, stroke, base)
    case["mechanics"] = "modal" if len(axes["x"].modes) == 2 else "lumped" if axes["x"].modes else "none"
    if case["mechanics"] == "none" and rng.random() < 0.25:
        case["mechanics"] = "lumped"
    return case


def other_axis(rng, x):
    """The second axis: a sister of the first, or one without hysteresis of its own."""
    near = {
        k: v * float(rng.uniform(0.9, 1.1)) if isinstance(v, float) and k != "reach" else v for k, v in x.base.items()
    }
    base = near if rng.random() < 0.65 else {"kind": "linear", "gain": x.base["gain"]}
    return Axis(base, [(f * float(rng.uniform(0.85, 1.15)), z, s) for f, z, s in x.modes])


def draw_effects(rng, kind, seed):
    """What is hidden: nothing in every third case of a base of another family."""
    if kind in ("none", "begun_none", "outside"):
        return [kind] * (kind == "outside")
    if kind == "family":
        return [str(rng.choice(ANY_BASE))] if seed % 3 else []
    return [str(e) for e in rng.choice(NAMED, 2 if kind == "pair" else 1, replace=False)]


def draw(kind, seed):
    """The case of a kind and a seed; draws that cannot be seen are drawn again, from the same stream."""
    rng = np.random.default_rng([KINDS[kind], seed])
    for attempt in range(60):
        effects = draw_effects(rng, kind, seed)
        try:
            case = draw_stage(rng, kind, effects)
            case |= {"seed": seed, "truth": [e for e in effects if e != "outside"], "attempt": attempt}
            shares = [0.5, 0, 0.5, 0] if kind == "family" else [0.25, 0.3, 0.3, 0.15]
            case |= {"bounds": str(rng.choice(["none", "tight", "wide", "wrong"], p=shares))}
            case |= {"damping_bounds": bool(rng.random() < 0.5), "bare": bool(rng.random() < 0.3)}
            case |= {"title": str(rng.choice(TITLES)), "noise_seed": int(rng.integers(2**31))}
            frequency = case["axes"]["x"].modes[0][0] if case["axes"]["x"].modes else 100.0
            case["mass"] = float(
                np.clip(rng.uniform(0.05, 1), 3e5 / (6.28 * frequency) ** 2, 4e8 / (6.28 * frequency) ** 2)
            )
            case["job_seed"] = int(rng.integers(2**31))
            return equip(rng, case, effects)
        except (Redraw, Unsettled, OverflowError):  # the latter of a motion that runs away
            continue
    raise RuntimeError(f"{kind} {seed}: no draw could be seen")


def equip(rng, case, effects):
    """Put effects into the stage, each of a size that leaves the drawn number of noise floors."""
    rig = (Family if case["kind"] == "family" else Rig)(case)
    rig.hold_base()
    if case["kind"] == "family":
        case["bouc_wen"] = rig.left
        if not rig.memory_is_seen():
            raise Redraw("Bouc-Wen holds this base")
    level, c = floor(case["sensor"]), surroundings(case, case["stroke"])
    most = min(MOST, 0.1 * case["stroke"] / level)
    signatures = {}
    for effect, rough in zip(effects, case["forms"], strict=True):
        form = pick_form(rng, effect, case["axes"]["x"].base) if effect == "thermal_relaxation" else rough
        plan, low, high, signs = FORMS[effect][form](rng, c)
        least = 6.0 if effect == "outside" else 1.3 * rig.least  # what is outside must not pass for adequate
        if least > most:
            raise Redraw("what Bouc-Wen leaves hides any effect")
        target = float(np.exp(rng.uniform(math.log(least), math.log(max(0.85 * most, least)))))
        entry = plan | {"form": form, "sign": float(rng.choice([-1, 1])) if signs else 1.0}
        signatures[effect] = rig.scale(effect, entry, low, high, target)
        if signatures[effect] is None:
            raise Redraw(f"{effect} {form} cannot be seen")
        case.setdefault("sizes", {})[effect] = entry
    if len(effects) == 2 and not apart(*signatures.values(), least=LEAST * level):
        raise Redraw("one hides the other")
    case["floor"], case["seen"] = level, {e: rig.seen(s) for e, s in signatures.items()}
    for entry, effect in ((case["sizes"][e], e) for e in effects):
        rig.put(effect, entry)
    case["clean"] = [rig.settled_reading(i, record) for i, record in enumerate(case["records"])]
    return case


def readings(case):
    """Noisy readings of the case, a list over records of {axis: reading}."""
    rng = np.random.default_rng(case["noise_seed"])
    measured = ["x"] + (["y"] if case["y_measured"] else [])
    return [{a: read(clean[a], rng, case["sensor"]) for a in measured} for clean in case["clean"]]


def write(kind, seed, out):
    """Make a case in `out`/kind-seed: job and data in rig/, the truth beside it."""
    started = time.process_time()
    case = draw(kind, seed)
    home = Path(out) / f"{kind}-{seed}"
    (home / "rig").mkdir(parents=True, exist_ok=True)
    jobs.write_records(home / "rig", case, readings(case))
    (home / "rig" / "job.yaml").write_text(jobs.text(np.random.default_rng(case["job_seed"]), case))
    keys = (
        "kind",
        "seed",
        "truth",
        "sizes",
        "seen",
        "floor",
        "sensor",
        "stroke",
        "span",
        "pace",
        "mechanics",
        "bounds",
    )
    truth = {key: case.get(key) for key in (*keys, "y_measured", "wrong", "attempt", "mass", "bouc_wen")}
    if kind == "family":
        truth["truth"] = ["distributed_memory", *case["truth"]]
    if kind in BEGUN:
        truth["ahead"] = case["ahead"]
    truth["base"] = case["axes"]["x"].base
    truth["modes"] = case["axes"]["x"].modes
    truth["y"] = None if "y" not in case["axes"] else {"base": case["axes"]["y"].base["kind"]}
    truth["records"] = [[r.kind, r.use, r.rate, r.samples] for r in case["records"]]
    truth["seconds_to_make"] = round(time.process_time() - started, 2)
    (home / "truth.json").write_text(json.dumps(truth, indent=1))
    return home
