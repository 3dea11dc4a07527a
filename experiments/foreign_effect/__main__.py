"""python -m experiments.foreign_effect cases|solve|follow|table --kind single --seeds 100:130 --jobs 2"""

import argparse
import json
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path

from . import cases, follow, score, solve, tally


def _seeds(text):
    first, _, last = text.partition(":")
    return range(int(first), int(last or int(first) + 1))


def _make(job):
    kind, seed, out = job
    home = Path(out) / f"{kind}-{seed}"
    if not (home / "truth.json").exists():
        cases.write(kind, seed, out)
    return home


def _solve(job, **how):
    _say(job, solve.solve(Path(job[2]) / f"{job[0]}-{job[1]}", **how))


def _follow(job, **how):
    if answer := follow.follow(Path(job[2]) / f"{job[0]}-{job[1]}", **how):
        _say(job, answer)


def _say(job, answer):
    found = (answer["improvement"] or {}).get("effects")
    print(f"{job[0]} {job[1]}: exit {answer['exit']}, named {found}, {answer['cpu']:.0f} s CPU", flush=True)


def main():
    """Make cases, let the tool answer them, play the drives it proposes, or print tables; what is done is skipped."""
    parser = argparse.ArgumentParser(prog="python -m experiments.foreign_effect", description=main.__doc__)
    parser.add_argument("task", choices=("cases", "solve", "follow", "table"))
    parser.add_argument("--kind", default="single", help="comma between " + ", ".join(cases.KINDS))
    parser.add_argument("--seeds", type=_seeds, default=range(1, 9), help="first:last, the last one left out")
    parser.add_argument("--out", default="results/foreign_effect")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--limit", type=float, default=900, help="seconds for each answer")
    parser.add_argument("--on", default="", help="where the answers are found, as of `pzt-ident improve --on`")
    parser.add_argument("--budget", default="", help="of each answer, as of `pzt-ident improve --budget`")
    given = parser.parse_args()
    work = [(kind, seed, given.out) for kind in given.kind.split(",") for seed in given.seeds]
    if given.task in ("cases", "solve"):
        with get_context("fork").Pool(given.jobs, maxtasksperchild=4) as pool:
            for home in pool.imap_unordered(_make, work):
                print(home, flush=True)
    if given.task in ("solve", "follow"):
        act = _solve if given.task == "solve" else _follow
        with ThreadPoolExecutor(given.jobs) as threads:
            list(threads.map(partial(act, limit=given.limit, on=given.on, budget=given.budget), work))
    if given.task == "table":
        rows = score.rows(given.out)
        (Path(given.out) / "rows.json").write_text(json.dumps(rows, indent=1))
        print(tally.markdown(rows))


if __name__ == "__main__":
    main()
