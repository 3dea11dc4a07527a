"""Solve the COCO BBOB functions with our optimizers and with those they stand on, at equal evaluations.

    python experiments/bbob/run.py [--instances 1 2 3] [--only WORD ...]

Prints the table and writes results/reference/bbob/; what is there already is not run again.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np
from upstream import DIMENSIONS, HIGH, LOW, PAIRS

from pzt_ident.search.loop import minimize

OUT = Path(__file__).parents[2] / "results" / "reference" / "bbob"
BUDGET = 1000 * DIMENSIONS
TARGETS = (1e-1, 1e-3, 1e-5, 1e-8)


class Ended(Exception):
    """The budget is spent or the last target hit."""


class Counted:
    """A BBOB function that counts its evaluations and keeps the best distance to its optimum inside the box."""

    def __init__(self, function: int, instance: int) -> None:
        from cocoex import BareProblem

        self.problem = BareProblem("bbob", function, DIMENSIONS, instance)
        self.optimum = self.problem.best_value()
        self.evaluations, self.best = 0, np.inf

    def __call__(self, x: np.ndarray) -> float:
        if self.evaluations >= BUDGET or self.best <= TARGETS[-1]:
            raise Ended
        self.evaluations += 1
        value = float(self.problem(np.asarray(x, dtype=float)))
        if np.all(np.abs(x) <= HIGH):
            self.best = min(self.best, value - self.optimum)
        return value


def ours(word: str, function: Counted, seed: int) -> None:
    minimize(function, [(LOW, HIGH)] * DIMENSIONS, word, seed=seed, evaluations=BUDGET)


def distances(solve: Callable[[Counted, int], None], instances: list[int]) -> list[list[float]]:
    """Best distance to the optimum, (functions, instances). The seed is made of function and instance."""
    found = []
    for function in range(1, 25):
        row = []
        for instance in instances:
            counted = Counted(function, instance)
            with suppress(Ended):
                solve(counted, 1000 * function + instance)
            row.append(counted.best)
        found.append(row)
    return found


def solved(found: list[list[float]]) -> list[int]:
    """Problems of all on which each target was reached."""
    return [int((np.array(found) <= target).sum()) for target in TARGETS]


def line(name: str, found: list[list[float]]) -> str:
    counts = solved(found)
    return f"| {name} | " + " | ".join(map(str, counts)) + f" | {sum(counts)} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--instances", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--only", nargs="+", default=list(PAIRS))
    chosen = parser.parse_args()
    kept = OUT / f"distances-{'-'.join(map(str, chosen.instances))}.json"
    known = json.loads(kept.read_text()) if kept.exists() else {}
    lines = [
        f"| of {24 * len(chosen.instances)} problems | " + " | ".join(f"{t:g}" for t in TARGETS) + " | sum |",
        "|---|" + "---|" * (len(TARGETS) + 1),
    ]
    for word in chosen.only:
        entries = {word: partial(ours, word)}
        entries |= {f"{word}: upstream {solve.__name__}": solve for solve in PAIRS[word]}
        for name, solve in entries.items():
            if name not in known:
                known[name] = distances(solve, chosen.instances)
                OUT.mkdir(parents=True, exist_ok=True)
                beside = kept.with_suffix(".tmp")
                beside.write_text(json.dumps(known))
                beside.replace(kept)
            lines.append(line(name, known[name]))
            print(lines[-1], flush=True)
    text = "\n".join(lines) + "\n"
    if chosen.only == list(PAIRS):
        (OUT / "table.md").write_text(text)
    print("\n" + text)


if __name__ == "__main__":
    main()
