"""What the tool is given: CSV files and a job with the bounds that users write."""

import json

import numpy as np

from . import stages
from .draw import draw, free_names, noise


def _readings(rng, case):
    """Clean readings with noise and the zero of the sensor, in um; counted where it has a quantiser."""
    for clean in case["clean"]:
        seen = clean + noise(rng, case, clean.shape)
        seen = seen + rng.uniform(-0.5, 0.5, (len(clean), 1)) * 0.4
        if case["noise"] == "quant":
            count = case["sigma"] * np.sqrt(12 * (1 - 0.45**2))
            seen = count * np.round(seen / count)
        yield seen


def _write_records(rng, case, folder, names, unit):
    """Lines of the job for the records, whose files are written."""
    head = ["time [s]", *(f"u_{name} [V]" for name in names), *(f"{name} [{unit}]" for name in names)]
    formats = ["%.7f", *["%.4f"] * len(names), *["%.4f" if unit == "nm" else "%.6f"] * len(names)]
    lines = ["records:"]
    for i, (record, seen) in enumerate(zip(case["records"], _readings(rng, case), strict=True), start=1):
        columns = [np.arange(seen.shape[1]) / case["rate"], *record["u"], *(seen * (1e3 if unit == "nm" else 1.0))]
        file = f"r{i}_{record['kind']}.csv"
        np.savetxt(folder / file, np.array(columns).T, delimiter=",", header=",".join(head), comments="", fmt=formats)
        lines.append(f"  - {{file: {file}, use: {record['use']}}}")
    return lines


def _bounds(rng, case, axis, block, style, unit):
    """Bounds of the hysteresis: 10 % about a value up to 7 % beside the true one, a factor of three, or none."""
    lines = []
    if axis["base"] == "prandtl_ishlinskii":
        lines.append(f"  {block}.reach: {{value: {axis['reach']:.6g}}}")
    for name in free_names(axis):
        if name in ("mass", "stiffness", "damping"):
            continue
        one = style if style != "mixed" else str(rng.choice(["tight", "wide", "default"]))
        weight = name.startswith("weight")
        value = axis[name] * (1e3 if unit == "nm" and (name == "gain" or weight) else 1)
        if one == "tight" and not weight:
            middle, half = value + rng.uniform(-0.07, 0.07) * abs(value), 0.1 * abs(value)
            lines.append(f"  {block}.{name}: {{bounds: [{middle - half:.5g}, {middle + half:.5g}]}}")
        elif one == "wide" and not weight:
            low = value / 3 ** rng.uniform(0.3, 0.7)
            lines.append(f"  {block}.{name}: {{bounds: [{low:.4g}, {low * 3:.4g}]}}")
        elif axis["base"] == "bouc_wen" and name == "alpha":
            lines.append(f"  {block}.alpha: {{bounds: [0, 1]}}")
    return lines


def _mechanics(rng, case, axis, block):
    """Lines of the mechanics, and whether the mass is given 5 % wrong."""
    fixed, mass = case["fixed"], axis["mass"]
    drawn = stages.STAGES[case["name"]].get("wrong_mass", rng.random() < 0.4)
    wrong = drawn and "mass" not in fixed
    lines = [
        f"  {block}.{name}: {{value: {axis[name]:.7g}}}" for name in ("mass", "stiffness", "damping") if name in fixed
    ]
    if "mass" not in fixed:
        if wrong:
            mass *= rng.choice([0.95, 1.05])
        lines.append(f"  {block}.mass: {{value: {mass:.5g}}}")
    if "stiffness" not in fixed:
        low = axis["stiffness"] / 3 ** rng.uniform(0.3, 0.7)
        lines.append(f"  {block}.stiffness: {{bounds: [{low:.4g}, {low * 3:.4g}]}}")
    if "damping" not in fixed:
        lines.append(f"  {block}.damping: {{bounds: [0, {axis['damping'] * rng.choice([8, 30, 200]):.3g}]}}")
    return lines, wrong


def _write_job(rng, case, folder):
    """Job and records; what a user of it does not know is returned."""
    unit, names = "nm" if rng.random() < 0.2 else "um", ["x", "y"][: len(case["axes"])]
    lines = [f"name: {case['name'].replace('_', '-')}", *_write_records(rng, case, folder, names, unit)]
    lines += ["channels:", '  time: "time [s]"', "  axes:"]
    lines += [f'    {name}: {{drive: "u_{name} [V]", response: "{name} [{unit}]"}}' for name in names]
    lines.append(f"model: [{case['base']}{', lumped' if 'mass' in case['axes'][0] else ''}]")
    parameters, wrong = [], []
    for name, axis in zip(names, case["axes"], strict=True):
        prefix = f"{name}." if len(names) > 1 else ""
        style = stages.STAGES[case["name"]].get("bounds") or str(rng.choice(["tight", "wide", "default", "mixed"]))
        parameters += _bounds(rng, case, axis, prefix + case["base"], style, unit)
        if "mass" in axis:
            some, off = _mechanics(rng, case, axis, prefix + "lumped")
            parameters += some
            wrong += [prefix + "lumped.mass"] * off
    lines += ["parameters:", *parameters] if parameters else []
    lines += ["optimizers:", "  - {name: pso, population: 40, generations: 60}", "repeats: 1"]
    lines.append(f"seed: {int(rng.integers(1, 9999))}")
    (folder / "job.yaml").write_text("\n".join(lines) + "\n")
    return {"unit": unit, "wrong": wrong}


def truth(case):
    """What is hidden in a case."""
    outside, effects = case["kind"] == "outside", [effect["effect"] for effect in case["effects"]]
    stage = stages.STAGES[case["name"]]
    out = {"name": case["name"], "kind": case["kind"], "truth": [] if outside else effects}
    out |= {"outside": effects if outside else [], "words": [effect["words"] for effect in case["effects"]]}
    out |= {"acts": {effect["effect"]: effect["acts"] for effect in case["effects"]}}
    out |= {"floors": case.get("sizes", []), "floors_beside_the_other": case.get("beside"), "alike": case.get("alike")}
    out |= {"also_right": stage.get("also_right", {}), "base": case["base"], "axes": case["axes"]}
    out |= {"fixed": case["fixed"], "noise": case["noise"], "sigma_nm": case["sigma"] * 1e3}
    out |= {"memory": case["memory"] if case["noise"] == "ar1" else 0.0, "rate": case["rate"]}
    out |= {"samples": sum(clean.shape[1] for clean in case["clean"]), "step_error_floors": case["step_error"]}
    return out


def write(name, out):
    """A case: out/name/rig for the tool, out/name/truth.json beside it."""
    case, rng = draw(name)
    folder = out / name / "rig"
    folder.mkdir(parents=True, exist_ok=True)
    known = truth(case) | _write_job(rng, case, folder)
    (out / name / "truth.json").write_text(json.dumps(known, indent=1) + "\n")
