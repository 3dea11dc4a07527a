"""python -m experiments.fifty_stages cases|solve|table --out DIR --jobs 2 --only s01,p03"""

import argparse
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from experiments.foreign_effect.solve import solve

from . import jobs, score, stages, tally


def _make(name, out):
    if not (out / name / "truth.json").exists():
        jobs.write(name, out)
        print(out / name, flush=True)


def _solve(name, out, limit):
    answer = solve(out / name, limit)
    found = (answer["improvement"] or {}).get("effects")
    print(f"{name}: exit {answer['exit']}, named {found}, {answer['cpu']:.0f} s CPU", flush=True)


def main():
    """Make cases, let the tool answer them, or print the tables; what is done is skipped."""
    parser = argparse.ArgumentParser(prog="python -m experiments.fifty_stages", description=main.__doc__)
    parser.add_argument("task", choices=("cases", "solve", "table"))
    parser.add_argument("--out", type=Path, default=Path("results/fifty_stages"))
    parser.add_argument("--only", default="", help="comma between starts of names, such as s01,p")
    parser.add_argument("--jobs", type=int, default=2, help="how many are solved at a time")
    parser.add_argument("--limit", type=float, default=900, help="seconds for each answer")
    given = parser.parse_args()
    names = [name for name in stages.STAGES if name.startswith(tuple(given.only.split(",")))]
    if given.task == "table":
        rows = score.rows(given.out)
        (given.out / "rows.json").write_text(json.dumps(rows, indent=1) + "\n")
        print(tally.markdown(rows), end="")
        return
    for name in names:
        _make(name, given.out)
    if given.task == "solve":
        with ThreadPoolExecutor(given.jobs) as threads:
            list(threads.map(lambda name: _solve(name, given.out, given.limit), names))


if __name__ == "__main__":
    main()
