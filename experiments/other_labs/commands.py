"""The commands of a set of campaigns: make cases, let the tool answer them, print the tables."""

import argparse
import json
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from experiments.foreign_effect.solve import solve

from . import score, tally


def _make(name, out, write):
    if not (out / name / "truth.json").exists():
        print(write(name, out), flush=True)


def _solve(name, given):
    answer = solve(given.out / name, given.limit, budget=given.budget)
    found = (answer["improvement"] or {}).get("effects")
    print(f"{name}: exit {answer['exit']}, named {found}, {answer['cpu']:.0f} s CPU", flush=True)


def _some(known):
    """Reader of names with commas between them."""

    def names(text):
        found = text.split(",")
        if unknown := sorted(set(found) - set(known)):
            raise argparse.ArgumentTypeError(f"no campaign {', '.join(unknown)}; they are {known[0]} to {known[-1]}")
        return found

    return names


def _table(out):
    rows = score.rows(out)
    part = out / "rows.part"
    part.write_text(json.dumps(rows, indent=1) + "\n")
    os.replace(part, out / "rows.json")
    print(tally.markdown(rows), end="")


def _parser(experiment, names):
    parser = argparse.ArgumentParser(prog=f"python -m experiments.{experiment}", description=main.__doc__)
    parser.add_argument("task", choices=("cases", "solve", "table"))
    parser.add_argument("--out", type=Path, default=Path("results") / experiment)
    some = f"comma between names, such as {','.join(names[:2])}"
    parser.add_argument("--only", type=_some(names), default=names, help=some)
    parser.add_argument("--jobs", type=int, default=1, help="how many are solved at a time")
    parser.add_argument("--limit", type=float, default=900, help="seconds for each answer")
    parser.add_argument("--budget", default="", help="of each answer, as of `pzt-ident improve --budget`")
    return parser


def main(experiment, names, write):
    """Make cases, let the tool answer them, or print the tables; what is done is skipped."""
    given = _parser(experiment, names).parse_args()
    if given.task == "table":
        _table(given.out)
        return
    for name in given.only:
        _make(name, given.out, write)
    if given.task == "solve":
        with ThreadPoolExecutor(given.jobs) as threads:
            list(threads.map(lambda name: _solve(name, given), given.only))
