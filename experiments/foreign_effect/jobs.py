"""Job files as users write them: bounds from a data sheet, mechanics or none, the other axis measured or not."""

import csv
import math

import numpy as np

BLOCKS = {"bouc_wen": "bouc_wen", "plays": "prandtl_ishlinskii", "preisach": "homogenized_energy"}
BLOCKS["free_energy"] = "homogenized_energy"
OPTIMIZERS = (
    ["{name: pso, population: 70, generations: 250, c1: 2.8, c2: 1.3}"],
    ["cma_es"],
    ["{name: least_squares, budget: 3500}", "cma_es"],
    ["{name: rga, population: 70, generations: 250}", "{name: pso, population: 70, generations: 250}"],
    ["{name: pso, population: 40, generations: 150}"],
)


def hysteresis(base):
    """Word of the base hysteresis in a job."""
    block = BLOCKS[base["kind"]]
    return f"{{name: {block}, density: free}}" if base.get("law") == "normal" else block


def believed(case):
    """The hysteresis that the user takes the stage for: its own, or Bouc-Wen with the stroke over the voltage."""
    base = case["axes"]["x"].base
    if case["kind"] != "family":
        return base
    reading = np.concatenate([clean["x"] for clean in case["clean"]])
    voltage = np.concatenate([record.drives["x"] for record in case["records"]])
    return {"kind": "bouc_wen", "gain": float(np.ptp(reading) / np.ptp(voltage))}


def known(case):
    """Mass, damping and stiffness of x: stiffness from the force test, mass from CAD; f1 = (k / m)^0.5 / 2 pi."""
    frequency, damping, _ = case["axes"]["x"].modes[0]
    w = 2 * math.pi * frequency
    mass = case["mass"]
    return {"mass": mass, "stiffness": mass * w * w, "damping": 2 * damping * mass * w}


def _interval(rng, value, style):
    """Bounds about a true value: within 12 %, within a factor of five, or 5 % beside it."""
    if style == "tight":
        return value * rng.uniform(0.88, 0.98), value * rng.uniform(1.02, 1.12)
    if style == "wide":
        return value / rng.uniform(2, 5), value * rng.uniform(2, 5)
    low, high = (1.05 * value, 1.3 * value) if rng.random() < 0.5 else (0.75 * value, 0.95 * value)
    return low, high


def _line(name, low, high):
    return f"  {name}: {{bounds: [{low:.6g}, {high:.6g}]}}"


def _mechanics(rng, case, style, wrong):
    """Lines for `lumped` or `modal`."""
    effects, lines, modes = case["truth"], [], case["axes"]["x"].modes
    if case["mechanics"] == "modal":
        for i, (frequency, _, _) in enumerate(modes, 1):
            lines.append(_line(f"modal.frequency_{i}", 0.6 * frequency, 1.6 * frequency))
        return lines
    if not modes:
        return ["  lumped.mass: {bounds: [0.001, 0.5]}", "  lumped.stiffness: {bounds: [1e+7, 1e+9]}"]
    values = known(case)
    if {"load_mass", "viscous_damping"} & set(effects):
        lines.append(f"  lumped.mass: {{value: {values['mass']:.6g}}}  # CAD")
        lines.append(f"  lumped.stiffness: {{value: {values['stiffness']:.6g}}}  # force test")
    else:
        lines.append(_line("lumped.mass", *_interval(rng, values["mass"], "wrong" if wrong == "mass" else style)))
        lines.append(_line("lumped.stiffness", *_interval(rng, values["stiffness"], style)))
    if "viscous_damping" in effects:
        lines.append(f"  lumped.damping: {{value: {values['damping']:.6g}}}  # tap test without the damper")
    elif case["damping_bounds"]:
        lines.append(f"  lumped.damping: {{bounds: [0, {max(1000, math.ceil(3 * values['damping']))}]}}")
    return lines


def _parameters(rng, case):
    """Bounds that the user has, and a word on their style for the truth; of x alone, for y is another axis."""
    style, base = case["bounds"], believed(case)
    block, lines, wrong = BLOCKS[base["kind"]], [], None
    choices = ["gain"] + (["mass"] if case["mechanics"] == "lumped" and base and case["axes"]["x"].modes else [])
    if style == "wrong":
        wrong = str(rng.choice(choices))
        style = "wide"
        case["wrong"] = wrong
    if case["mechanics"] == "modal":
        lines.append(f"  {block}.gain: {{value: {base['gain']:.6g}}}")
    elif style != "none":
        lines.append(_line(f"{block}.gain", *_interval(rng, base["gain"], "wrong" if wrong == "gain" else style)))
    if base["kind"] == "bouc_wen" and style != "none":
        lines.append("  bouc_wen.alpha: {bounds: [0, 1]}")
        if style == "tight":
            lines.append(_line("bouc_wen.beta", 0.2 * base["beta"], 5 * base["beta"]))
    if base["kind"] == "plays":
        lines.append(_line("prandtl_ishlinskii.reach", 0.7 * base["reach"], 1.4 * base["reach"]))
    if base.get("law") == "normal":
        reach = base["coercive"] * (1 + 3 * base["spread"])
        lines.append(_line("homogenized_energy.reach", 0.7 * reach, 1.5 * reach))
    if case["mechanics"] != "none" and (style != "none" or {"load_mass", "viscous_damping"} & set(case["truth"])):
        lines += _mechanics(rng, case, style, wrong)
    return [line.replace("  ", "  x.", 1) for line in lines] if case["y_measured"] else lines


def write_records(folder, case, readings):
    """One file a record: CSV with a header in one style, columns of numbers without header in the other."""
    for i, (record, seen) in enumerate(zip(case["records"], readings, strict=True)):
        write_record(folder, case, i, record, seen)


def file_name(case, i, record):
    """File of record i, counted from 0."""
    return f"rec{i + 1:02d}.dat" if case["bare"] else f"{i + 1:02d}_{record.kind}.csv"


def write_record(folder, case, i, record, seen):
    """The file of one record and its readings."""
    t = np.arange(record.samples) / record.rate
    columns, names = [t], ["time [s]"]
    for axis in sorted(record.drives):
        columns.append(record.drives[axis])
        names.append(f"u_{axis} [V]")
        if axis in seen:
            columns.append(seen[axis])
            names.append(f"{axis} [um]")
    rows = np.column_stack(columns)
    if case["bare"]:
        np.savetxt(folder / file_name(case, i, record), rows[:, 1:], fmt="%.8g")
        return
    with open(folder / file_name(case, i, record), "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(names)
        writer.writerows([[f"{v:.9g}" for v in row] for row in rows.tolist()])


def record_line(case, i, record):
    """Line of a job for record i."""
    rate = f", sample_rate: {record.rate:.12g} Hz" if case["bare"] else ""
    return f"  - {{file: {file_name(case, i, record)}, use: {record.use}{rate}}}"


def _channels(case):
    lines, column = ["channels:"], 1
    if not case["bare"]:
        lines.append('  time: "time [s]"')
    lines.append("  axes:")
    for axis in sorted(case["axes"]):
        measured = axis == "x" or case["y_measured"]
        if case["bare"]:
            drive = f"{{column: {column}, unit: V}}"
            response = f"{{column: {column + 1}, unit: um}}"
        else:
            drive, response = f'"u_{axis} [V]"', f'"{axis} [um]"'
        column += 2 if measured else 1
        lines.append(f"    {axis}: {{drive: {drive}" + (f", response: {response}}}" if measured else "}"))
    return lines


def text(rng, case):
    """The job file."""
    lines = [f"# {case['title']}", f"name: {case['kind']}-{case['seed']}", "records:"]
    lines += [record_line(case, i, record) for i, record in enumerate(case["records"])]
    lines += _channels(case)
    words = [hysteresis(believed(case))]
    if case["mechanics"] == "lumped":
        words.append("lumped")
    elif case["mechanics"] == "modal":
        words.append("{name: modal, modes: 2}")
    lines.append(f"model: [{', '.join(words)}]")
    if parameters := _parameters(rng, case):
        lines += ["parameters:", *parameters]
    if rng.random() < 0.1 and "encoder_cyclic_error" not in case["truth"]:
        lines.append("rule_out: [encoder_cyclic_error]  # capacitive sensor")
    lines.append("optimizers:")
    lines += [f"  - {word}" for word in OPTIMIZERS[int(rng.integers(len(OPTIMIZERS)))]]
    lines += [f"repeats: {int(rng.integers(1, 4))}", f"seed: {int(rng.integers(1, 10000))}"]
    return "\n".join(lines) + "\n"
