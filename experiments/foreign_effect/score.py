"""What an answer is worth, from improvement.json and the truth."""

import json
import math
from pathlib import Path


def _size(value):
    """One number of a value that may be given by axis: that of x."""
    if isinstance(value, dict):
        value = value.get("x", next(iter(value.values()), None))
    return math.nan if value is None else float(value)


def classes(improvement):
    """{named effect: effects that the data cannot tell from it}, from the steps that added what is still named."""
    out = {effect: {effect} for effect in improvement["effects"]}
    for step in improvement["steps"]:
        if step.get("added") in out:
            out[step["added"]] = {step["added"], *(step.get("class") or [])}
    return out


def tied(improvement):
    """Whether an effect that is named cannot be told from another one."""
    return any(len(group) > 1 for group in classes(improvement).values())


def matched(truth, groups):
    """Whether every true effect has a named one of its own in whose class it is, and no other effect is named."""
    if not truth:
        return not groups
    first, rest = truth[0], truth[1:]
    for effect, group in groups.items():
        if first in group and matched(rest, {k: v for k, v in groups.items() if k != effect}):
            return True
    return False


def score(truth, solved):
    """Row of a table: exact, in class, extra effects, verdict, floors left on records kept back, CPU seconds."""
    improvement = solved["improvement"]
    row = {"kind": truth["kind"], "seed": truth["seed"], "truth": truth["truth"], "cpu": solved["cpu"]}
    row["work"] = (improvement or {}).get("work") or float("nan")
    row |= {"seconds": solved["seconds"], "base": truth["base"]["kind"], "bounds": truth["bounds"]}
    row |= {"mechanics": truth["mechanics"], "y": _other(truth), "coloured": bool(truth["sensor"]["memory"])}
    row["ahead"] = truth.get("ahead")
    row["forms"] = [truth["base"]["kind"]] * (truth["kind"] == "family")
    row["forms"] += [entry["form"] for entry in (truth["sizes"] or {}).values()]
    row["visible"] = {effect: max(seen) for effect, seen in truth["seen"].items()}
    if leaves := truth.get("bouc_wen"):
        row |= {"seen": truth["seen"], "bouc_wen": [leaves[key]["all"] for key in ("alone", "with_plays")]}
    if improvement is None:
        verdict = "out of time" if solved["exit"] == "time" else f"exit {solved['exit']}"
        return row | {
            "named": [],
            "exact": False,
            "in_class": False,
            "extra": [],
            "missed": truth["truth"],
            "suspects": [],
            "tied": [],
            "verdict": verdict,
            "floors": math.nan,
            "noise": math.nan,
        }
    named, groups = list(improvement["effects"]), classes(improvement)
    within = set().union(*groups.values()) if groups else set()
    row |= {"named": named, "exact": set(named) == set(truth["truth"]), "in_class": matched(truth["truth"], groups)}
    row["extra"] = [e for e in named if not groups[e] & set(truth["truth"])]
    row["missed"] = [e for e in truth["truth"] if e not in within]
    last = improvement["steps"][-1]["rmse"]
    row["verdict"], row["suspects"] = improvement["verdict"], [s["effect"] for s in improvement.get("suspects") or []]
    row["floors"] = round(_size(last["validate"]) / truth["floor"], 2)
    row["floors_identify"] = round(_size(last["identify"]) / truth["floor"], 2)
    row["floors_before"] = round(_size(improvement["steps"][0]["rmse"]["validate"]) / truth["floor"], 2)
    row["noise"] = round(_size(improvement.get("noise_floor")) / truth["floor"], 3)
    row["tied"] = [sorted(group) for group in groups.values() if len(group) > 1]
    following = improvement.get("next_experiment") or {}
    return row | {"proposed": following.get("why"), "reason": improvement.get("reason")}


def _other(truth):
    return "none" if truth["y"] is None else "measured" if truth["y_measured"] else "driven"


def rows(out):
    """Scores of all solved cases below a folder."""
    found = []
    for path in sorted(Path(out).glob("*/solved.json")):
        truth = json.loads((path.parent / "truth.json").read_text())
        row, second = score(truth, json.loads(path.read_text())), path.parent / "followed" / "solved.json"
        if second.exists():
            row["followed"] = score(truth, json.loads(second.read_text()))
        found.append(row)
    return found
