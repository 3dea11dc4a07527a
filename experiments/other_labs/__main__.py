"""python -m experiments.other_labs cases|solve|table --out DIR --only n01,n02 --budget 60s --jobs 1"""

import argparse
import json
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from experiments.foreign_effect.solve import solve

from . import score, tally, writing
from .names import NAMES


def _make(name, out):
    if not (out / name / "truth.json").exists():
        print(writing.write(name, out), flush=True)


def _solve(name, given):
    answer = solve(given.out / name, given.limit, budget=given.budget)
    found = (answer["improvement"] or {}).get("effects")
    print(f"{name}: exit {answer['exit']}, named {found}, {answer['cpu']:.0f} s CPU", flush=True)


def _names(text):
    names = text.split(",")
    if unknown := sorted(set(names) - set(NAMES)):
        raise argparse.ArgumentTypeError(f"no campaign {', '.join(unknown)}; they are {NAMES[0]} to {NAMES[-1]}")
    return names


def _table(out):
    rows = score.rows(out)
    part = out / "rows.part"
    part.write_text(json.dumps(rows, indent=1) + "\n")
    os.replace(part, out / "rows.json")
    print(tally.markdown(rows), end="")


def main():
    """Make cases, let the tool answer them, or print the tables; what is done is skipped."""
    parser = argparse.ArgumentParser(prog="python -m experiments.other_labs", description=main.__doc__)
    parser.add_argument("task", choices=("cases", "solve", "table"))
    parser.add_argument("--out", type=Path, default=Path("results/other_labs"))
    parser.add_argument("--only", type=_names, default=NAMES, help="comma between names, such as n01,n02")
    parser.add_argument("--jobs", type=int, default=1, help="how many are solved at a time")
    parser.add_argument("--limit", type=float, default=900, help="seconds for each answer")
    parser.add_argument("--budget", default="", help="of each answer, as of `pzt-ident improve --budget`")
    given = parser.parse_args()
    if given.task == "table":
        _table(given.out)
        return
    for name in given.only:
        _make(name, given.out)
    if given.task == "solve":
        with ThreadPoolExecutor(given.jobs) as threads:
            list(threads.map(lambda name: _solve(name, given), given.only))


if __name__ == "__main__":
    main()
