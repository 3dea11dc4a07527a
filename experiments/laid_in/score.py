"""What the answers are worth, from improvement.json and what was laid in, and the tables of it."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from experiments.foreign_effect.score import classes
from experiments.laid_in.cases import AS_IT_IS
from experiments.laid_in.effects import EFFECTS, WORDS
from experiments.tables import number, table

Row = dict[str, Any]
LATE = ("delay.time", "amplifier_lag.tau", "sensor_lag.tau")
OUTCOMES = ("exact", "in class", "suspect", "missed")


def rows(out: Path) -> list[Row]:
    """Scores of all solved cases in a folder."""
    found = [_read(path.parent) for path in sorted(out.glob("*/solved.json"))]
    own = {truth["record"]: solved for truth, solved in found if truth["effect"] == AS_IT_IS}
    order = [AS_IT_IS, *EFFECTS]
    found.sort(key=lambda case: (list(own).index(case[0]["record"]), order.index(case[0]["effect"]), case[0]["units"]))
    return [score(truth, solved, own[truth["record"]]) for truth, solved in found]


def _read(home: Path) -> tuple[Row, Row]:
    return json.loads((home / "truth.json").read_text()), json.loads((home / "solved.json").read_text())


def score(truth: Row, solved: Row, own: Row) -> Row:
    """own: the answer on the record as it is. `known`: what it names there holds the effect, or one of its class."""
    found, base = solved["improvement"], own["improvement"]
    words = set(WORDS.get(truth["effect"], ()))
    groups, lacks = classes(found), classes(base)
    named, suspects = set(groups), {entry["effect"] for entry in found["suspects"]}
    tied = {name for name, group in groups.items() if group & words}
    outcome = "exact" if named & words else "in class" if tied else "suspect" if suspects & words else "missed"
    kept = {lack for lack, group in lacks.items() if any(group & other for other in groups.values())}
    accounted = words | tied | set().union(*lacks.values(), *(groups[name] for name in named & set(lacks)))
    steps = found["steps"]
    row = {key: truth[key] for key in ("record", "effect", "units", "size")}
    row |= {"named": sorted(named), "class": {name: sorted(group) for name, group in groups.items()}}
    row |= {"suspects": sorted(suspects), "verdict": found["verdict"], "reason": found["reason"]}
    row |= {"known": bool(words & set().union(*lacks.values())), "outcome": outcome}
    row |= {"own": sorted(lacks), "kept": sorted(kept), "other": sorted(named - accounted)}
    row |= {"before": steps[0]["rmse"]["validate"], "after": steps[-1]["rmse"]["validate"], "unit": found["unit"]}
    row |= {"as_it_is": base["steps"][-1]["rmse"]["validate"], "cpu": solved["cpu"]}
    return row | {"later": _late(found) - _late(base)}


def _late(improvement: Row) -> float:
    """Delays and lags in all, s; of several axes their mean."""
    last = next(step for step in reversed(improvement["steps"]) if step["parameters"])
    named = [entry["value"] for name, entry in last["parameters"].items() if name.endswith(LATE)]
    axes = {name.split(".")[0] for name in last["parameters"] if name.count(".") == 2}
    return sum(named) / max(1, len(axes))


def text(found: list[Row]) -> str:
    """Tables by effect and by record, of the records as they are, and of all cases."""
    laid = [row for row in found if row["effect"] != AS_IT_IS]
    parts = ["**By effect**", _counts(laid, "effect"), "**By record**", _counts(laid, "record")]
    parts += ["**By size in noise floors**", _counts(laid, "units"), "**The records as they are**", _own(found)]
    return "\n\n".join([*parts, "**All cases**", _cases(laid)])


def _counts(found: list[Row], key: str) -> str:
    """One row a value of the key, and of all, those that the record lacks anyway apart."""
    header = [key, "cases", *OUTCOMES, "with another name", "own lacks still named", "CPU s, median / largest"]
    lines = [_count(str(name), [row for row in found if row[key] == name]) for name in _unique(found, key)]
    known = [row for row in found if row["known"]]
    fresh = [row for row in found if not row["known"]]
    totals = [_count("the record lacks it anyway", known), _count("it does not", fresh), _count("all", found)]
    return table(header, lines + totals)


def _unique(found: Iterable[Row], key: str) -> list[Any]:
    return list(dict.fromkeys(row[key] for row in found))


def _count(name: str, chosen: list[Row]) -> list[Any]:
    cpu = sorted(row["cpu"] for row in chosen) or [0.0]
    cells = [sum(row["outcome"] == outcome for row in chosen) for outcome in OUTCOMES]
    lacks, kept = sum(len(row["own"]) for row in chosen), sum(len(row["kept"]) for row in chosen)
    other = sum(bool(row["other"]) for row in chosen)
    return [name, len(chosen), *cells, other, f"{kept} of {lacks}", f"{cpu[len(cpu) // 2]:.0f} / {cpu[-1]:.0f}"]


def _own(found: list[Row]) -> str:
    header = ["record", "named", "suspects", "validated before", "after", "verdict", "CPU s"]
    lines = []
    for row in found:
        if row["effect"] == AS_IT_IS:
            cells = [", ".join(row["named"]), ", ".join(row["suspects"]), *_errors(row)]
            lines.append([row["record"], *cells, row["verdict"], f"{row['cpu']:.0f}"])
    return table(header, lines)


def _errors(row: Row) -> list[str]:
    return [f"{number(row['before'], 3)} {row['unit']}", number(row["after"], 3)]


def _cases(found: list[Row]) -> str:
    header = ["record", "effect", "floors", "size", "outcome", "own lacks lost", "also named", "suspects"]
    header += ["validated before", "after", "as it is", "verdict", "CPU s"]
    lines = []
    for row in found:
        size = f"{row['size']:.3g}"
        if row["effect"] in ("lag", "delay"):
            size = f"{1e3 * row['size']:.3g} ms, found {1e3 * row['later']:.3g}"
        outcome = row["outcome"] + (" (lacked anyway)" if row["known"] else "")
        lost = ", ".join(sorted(set(row["own"]) - set(row["kept"])))
        cells = [row["record"], row["effect"], row["units"], size, outcome, lost, ", ".join(row["other"])]
        cells += [", ".join(row["suspects"]), *_errors(row), number(row["as_it_is"], 3), row["verdict"]]
        lines.append([*cells, f"{row['cpu']:.0f}"])
    return table(header, lines)
