"""What an answer is worth, from improvement.json and the truth."""

import json
import math
from pathlib import Path

from experiments.foreign_effect.score import classes

from .stages import STAGES


def _held(effect, groups, also_right):
    """Named effects that are right for a hidden one."""
    return {name for name, group in groups.items() if effect in group or name in also_right}


def score(truth, solved):
    """Row of a table.

    exact: the effects named are the true ones. in_class: every true effect is named, or is in the class of one that is,
    or one is named that was written down as right for it, too. extra: named without being any of these.
    """
    sizes = dict(zip(truth["truth"] or truth["outside"], truth["floors"], strict=True))
    row = {"name": truth["name"], "kind": truth["kind"], "truth": truth["truth"], "outside": truth["outside"]}
    row |= {"words": truth["words"], "sizes": sizes, "base": truth["base"], "cpu": solved["cpu"]}
    improvement = solved["improvement"]
    if improvement is None:
        verdict = "out of time" if solved["exit"] == "time" else f"exit {solved['exit']}"
        row |= {"named": [], "exact": False, "in_class": False, "extra": [], "missed": truth["truth"]}
        return row | {"suspects": [], "tied": [], "verdict": verdict, "floors_left": None}
    effects = [effect.partition(".")[0] for effect in improvement["effects"]]
    groups = classes(improvement | {"effects": effects})
    hidden = [*truth["truth"], *truth["outside"]]
    held = {effect: _held(effect, groups, truth["also_right"].get(effect, ())) for effect in hidden}
    row |= {"named": effects, "exact": set(effects) == set(truth["truth"])}
    row["extra"] = [name for name in effects if not any(name in names for names in held.values())]
    row["missed"] = [effect for effect in truth["truth"] if not held[effect]]
    row["in_class"] = not row["missed"] if truth["truth"] else not row["extra"]
    row["suspects"] = [suspect["effect"] for suspect in improvement.get("suspects") or []]
    row["tied"] = [sorted(group) for group in groups.values() if len(group) > 1]
    scale = truth["sigma_nm"] / (1e3 if improvement["unit"] == "um" else 1.0)
    left = improvement["steps"][-1]["rmse"]["validate"] / scale
    return row | {"verdict": improvement["verdict"], "floors_left": None if math.isnan(left) else round(left, 2)}


def rows(out):
    """Scores of all solved cases below a folder, in the order of the list of stages."""
    found = []
    for path in Path(out).glob("*/solved.json"):
        truth = json.loads((path.parent / "truth.json").read_text())
        found.append(score(truth, json.loads(path.read_text())))
    return sorted(found, key=lambda row: list(STAGES).index(row["name"]))
