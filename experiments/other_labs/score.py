"""What an answer is worth, from improvement.json and the truth."""

import json
import math
from pathlib import Path

from experiments.foreign_effect.score import classes, matched

PER_UM = {"um": 1, "nm": 1e3, "mm": 1e-3, "m": 1e-6}


def _accepted(improvement, truth):
    """{named effect: effects that it stands for}: its class, and the true ones for which it was written down."""
    named = [effect.partition(".")[0] for effect in improvement["effects"]]
    groups = classes(improvement | {"effects": named})
    also = truth["also_right"]
    return {name: group | {true for true in also if name in also[true]} for name, group in groups.items()}


def _floors(improvement, truth):
    """RMSE of the records kept back over the noise, None if there is none."""
    left = improvement["steps"][-1]["rmse"]["validate"]
    if left is None or math.isnan(left):
        return None
    return round(left / PER_UM[improvement["unit"]] / truth["noise_um"], 2)


def score(truth, solved):
    """Row of a table.

    exact: the effects named are the true ones. in_class: every true effect has a named one of its own that stands for
    it, and nothing else is named. wrong: named without standing for a true one.
    """
    row = {"name": truth["name"], "kind": truth["kind"], "effects": truth["effects"], "what": truth["what"]}
    row |= {"size": truth["floors"], "cpu": solved["cpu"], "named": [], "exact": False, "in_class": False}
    row |= {"wrong": [], "tied": [], "unexplained": False, "floors_left": None}
    improvement = solved["improvement"]
    if improvement is None:
        return row | {"verdict": "out of time" if solved["exit"] == "time" else f"exit {solved['exit']}"}
    groups, true = _accepted(improvement, truth), truth["effects"]
    row |= {"named": list(groups), "exact": set(groups) == set(true), "in_class": matched(true, groups)}
    row["wrong"] = [name for name, group in groups.items() if not group & set(true)]
    row["tied"] = [sorted(group) for group in groups.values() if len(group) > 1]
    row |= {"verdict": improvement["verdict"], "unexplained": improvement["verdict"] == "unexplained"}
    return row | {"floors_left": _floors(improvement, truth)}


def rows(out):
    """Scores of all solved cases below a folder, by name."""
    found = []
    for path in sorted(Path(out).glob("*/solved.json")):
        truth = json.loads((path.parent / "truth.json").read_text())
        found.append(score(truth, json.loads(path.read_text())))
    return found
