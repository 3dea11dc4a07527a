"""python -m experiments.laid_in cases|solve|table --records bender,stack --seed 101 --out DIR"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from experiments.foreign_effect.solve import solve
from experiments.laid_in import cases, score
from experiments.laid_in.records import RECORDS


def main() -> None:
    """Make cases, let the tool answer them, or print the tables; what is done is skipped."""
    parser = argparse.ArgumentParser(prog="python -m experiments.laid_in", description=main.__doc__)
    parser.add_argument("task", choices=("cases", "solve", "table"))
    parser.add_argument("--records", default=",".join(RECORDS), help="comma between them")
    parser.add_argument("--effects", help="comma between them; all where not given")
    parser.add_argument("--seed", type=int, default=101, help="of phases; below 100 for development")
    parser.add_argument("--out", type=Path, default=Path("results/laid_in"))
    parser.add_argument("--limit", type=float, default=600, help="seconds for each answer")
    parser.add_argument("--budget", default="", help="as of `pzt-ident improve --budget`; its own where not given")
    parser.add_argument("--on", default="", help="where the answers are found, as of `pzt-ident improve --on`")
    given = parser.parse_args()
    if given.task == "table":
        rows = score.rows(given.out)
        (given.out / "rows.json").write_text(json.dumps(rows, indent=1))
        print(score.text(rows))
        return
    wanted = given.effects.split(",") if given.effects else None
    for record, effect, units in cases.names(given.records.split(",")):
        if wanted and effect not in wanted:
            continue
        home = cases.write(record, effect, units, given.seed, given.out)
        name = f"{record} {effect} {units}"
        if home is None:
            print(f"{name}: no plausible size is seen so large", flush=True)
        elif given.task == "cases":
            print(f"{name}: {json.loads((home / 'truth.json').read_text())['size']:.3g}", flush=True)
        else:
            answer = solve(home, given.limit, given.on, given.budget)
            found = (answer["improvement"] or {}).get("effects")
            print(f"{name}: exit {answer['exit']}, named {found}, {answer['cpu']:.0f} s CPU", flush=True)


if __name__ == "__main__":
    main()
