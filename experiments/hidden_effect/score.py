"""Hold what was found against the sealed truth: only this reads both."""

from __future__ import annotations

import csv
import json
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from experiments.hidden_effect.cases import KINDS
from experiments.hidden_effect.follow import follow
from experiments.hidden_effect.solve import TWO_ROUNDS

Json = dict[str, Any]
NOTHING = "nothing"


@dataclass(frozen=True)
class Answer:
    """The effects that a solution ends with and, of each, the class that its data cannot tell apart."""

    effects: tuple[str, ...]
    classes: dict[str, frozenset[str]]
    verdict: str


@dataclass(frozen=True)
class Score:
    """One case: what was hidden, what was found, and the error in noise floors at each step."""

    name: str
    kind: str
    hidden: tuple[str, ...]
    sizes: tuple[float, ...]
    answer: Answer
    pairs: tuple[tuple[str, str], ...]
    steps: tuple[Json, ...]
    seconds: float | None
    proposed: bool = False
    separated: bool = False

    @property
    def exact(self) -> bool:
        return set(self.answer.effects) == set(self.hidden)

    @property
    def inside(self) -> bool:
        """Each effect that was hidden is in the class of one found, and nothing else was found."""
        return len(self.pairs) == len(self.hidden) == len(self.answer.effects)

    @property
    def false_alarms(self) -> list[str]:
        matched = {found for _, found in self.pairs}
        return [effect for effect in self.answer.effects if effect not in matched]

    @property
    def missed(self) -> list[str]:
        matched = {hidden for hidden, _ in self.pairs}
        return [effect for effect in self.hidden if effect not in matched]

    @property
    def validated(self) -> float:
        return self.steps[-1]["validate"]


def load(path: Path) -> Json:
    return json.loads(path.read_text(encoding="utf-8"))


def answer(improvement: Json) -> Answer:
    classes = {
        step["added"]: frozenset(step.get("class") or ()) | {step["added"]}
        for step in improvement["steps"]
        if step["added"]
    }
    effects = tuple(improvement["effects"])
    return Answer(effects, {word: classes.get(word, frozenset({word})) for word in effects}, improvement["verdict"])


def match(hidden: Sequence[str], found: Answer) -> tuple[tuple[str, str], ...]:
    """Pairs of a hidden effect and the one found for it: by name first, then by class, as many as there can be."""
    pairs = [(effect, effect) for effect in hidden if effect in found.effects]
    rest = [effect for effect in hidden if effect not in found.effects]
    free = [effect for effect in found.effects if effect not in hidden]
    return tuple(pairs + _pair(rest, free, found))


def _pair(rest: list[str], free: list[str], found: Answer) -> list[tuple[str, str]]:
    if not rest:
        return []
    first, others = rest[0], rest[1:]
    options = [_pair(others, free, found)]
    for word in free:
        if first in found.classes[word]:
            options.append([(first, word), *_pair(others, [other for other in free if other != word], found)])
    return max(options, key=len)


def score(folder: Path, on: str = "") -> tuple[list[Score], list[str]]:
    """The scores of the cases that were solved, and the names of the others. on: the place where drives that were
    proposed are followed."""
    scores, failed = [], []
    for path in sorted((folder / "sealed").glob("*.json")):
        solved = folder / "solved" / path.stem
        if (solved / "improve" / "improvement.json").exists():
            scores.append(score_case(folder, load(path), solved, on))
        else:
            failed.append(path.stem)
    return scores, failed


def score_case(folder: Path, truth: Json, solved: Path, on: str) -> Score:
    improvement = load(solved / "improve" / "improvement.json")
    hidden, found = tuple(entry["effect"] for entry in truth["effects"]), answer(improvement)
    steps = tuple({**step, **_floors(step["rmse"], truth["noise_floor"])} for step in improvement["steps"])
    seconds = solved / "improve_seconds.json"
    more: Json = {}
    if truth["kind"] in TWO_ROUNDS:
        if not found.effects:
            found = _first_candidate(solved / "diagnose" / "diagnosis.json", found)
        second = follow(folder, truth["name"], on)
        more = {"proposed": second is not None, "separated": _separated(second, hidden)}
    return Score(
        truth["name"],
        truth["kind"],
        hidden,
        tuple(entry["size"] for entry in truth["effects"]),
        found,
        match(hidden, found),
        steps,
        float(seconds.read_text()) if seconds.exists() else None,
        **more,
    )


def _floors(rmse: Json, floor: float) -> Json:
    return {use: value / floor if value is not None else float("nan") for use, value in rmse.items()}


def _first_candidate(path: Path, found: Answer) -> Answer:
    """What a diagnosis without a decision puts first, with what it cannot tell from it."""
    first = next(iter(load(path)["candidates"]), None) if path.exists() else None
    if first is None:
        return found
    word = first["effect"]
    return Answer((word,), {word: frozenset(first["class"]) | {word}}, found.verdict)


def _separated(second: Path | None, hidden: tuple[str, ...]) -> bool:
    path = second / "improve" / "improvement.json" if second else None
    return bool(path and path.exists() and set(answer(load(path)).effects) == set(hidden))


def summary(scores: Iterable[Score], failed: Sequence[str]) -> list[Json]:
    """One row a kind."""
    rows = []
    for kind in KINDS:
        some = [one for one in scores if one.kind == kind]
        lost = sum(name.rpartition("-")[0] == kind for name in failed)
        if some or lost:
            rows.append({"kind": kind, "cases": len(some) + lost, "failed": lost, **_counts(some, len(some) + lost)})
    return rows


def _counts(some: list[Score], cases: int) -> Json:
    def share(count: int) -> float:
        return round(count / cases, 4)

    floors = [one.validated for one in some]
    seconds = [one.seconds for one in some if one.seconds is not None]
    return {
        "exact": share(sum(one.exact for one in some)),
        "inside": share(sum(one.inside for one in some)),
        "false_alarms": sum(len(one.false_alarms) for one in some),
        "missed": sum(len(one.missed) for one in some),
        "adequate": share(sum(one.answer.verdict == "adequate" for one in some)),
        "unexplained": share(sum(one.answer.verdict == "unexplained" for one in some)),
        "proposed": share(sum(one.proposed for one in some)),
        "separated": share(sum(one.separated for one in some)),
        "validate_median": median(floors) if floors else None,
        "validate_90": float(np.quantile(floors, 0.9)) if floors else None,
        "seconds_median": median(seconds) if seconds else None,
    }


def confusion(scores: Iterable[Score]) -> Counter[tuple[str, str]]:
    """Counts of (hidden, found): an effect that is missed stands against what was found in its place, or nothing."""
    counts: Counter[tuple[str, str]] = Counter()
    for one in scores:
        counts.update(one.pairs)
        instead = one.false_alarms or [NOTHING]
        counts.update((hidden, found) for hidden in one.missed for found in instead)
        if not one.missed:
            counts.update((NOTHING, found) for found in one.false_alarms or ([] if one.hidden else [NOTHING]))
    return counts


def write(scores: list[Score], failed: list[str], out: Path) -> None:
    """score.json, cases.csv and confusion.csv."""
    out.mkdir(parents=True, exist_ok=True)
    rows = summary(scores, failed)
    (out / "score.json").write_text(json.dumps({"kinds": rows, "failed": failed}, indent=1) + "\n", encoding="utf-8")
    _write_csv(out / "cases.csv", [_row(one) for one in scores])
    counts = confusion(scores)
    found = sorted({pair[1] for pair in counts})
    table = [
        {"hidden": hidden} | {word: counts[hidden, word] for word in found}
        for hidden in sorted({pair[0] for pair in counts})
    ]
    _write_csv(out / "confusion.csv", table)


def _row(one: Score) -> Json:
    return {
        "case": one.name,
        "hidden": " ".join(one.hidden),
        "sizes": " ".join(f"{size:.3g}" for size in one.sizes),
        "found": " ".join(one.answer.effects),
        "classes": " ".join("|".join(sorted(one.answer.classes[word])) for word in one.answer.effects),
        "verdict": one.answer.verdict,
        "exact": one.exact,
        "inside": one.inside,
        "identify": f"{one.steps[-1]['identify']:.4g}",
        "validate": f"{one.validated:.4g}",
        "proposed": one.proposed,
        "separated": one.separated,
        "seconds": one.seconds,
    }


def _write_csv(path: Path, rows: list[Json]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]) if rows else ["case"])
        writer.writeheader()
        writer.writerows(rows)
