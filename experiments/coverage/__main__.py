"""python -m experiments.coverage solve|table --seeds 1000:1200 --out DIR"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from experiments.coverage.campaign import COLOURS
from experiments.coverage.fit import solve
from experiments.coverage.tally import text


def main() -> None:
    """Identify campaigns, or print the table; what is done is skipped."""
    parser = argparse.ArgumentParser(prog="python -m experiments.coverage", description=main.__doc__)
    parser.add_argument("task", choices=("solve", "table"))
    parser.add_argument("--seeds", default="1000:1200", help="first:last, the last one left out")
    parser.add_argument("--out", type=Path, default=Path("results/coverage"))
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    path = given.out / "campaigns.jsonl"
    done = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    if given.task == "table":
        print(text(done))
        return
    known = {(row["seed"], row["colour"]) for row in done}
    with path.open("a") as file:
        for seed in range(*map(int, given.seeds.split(":"))):
            for colour in COLOURS:
                if (seed, colour) not in known:
                    file.write(json.dumps({"seed": seed, "colour": colour} | solve(seed, colour)) + "\n")
                    file.flush()


if __name__ == "__main__":
    main()
