"""CPU seconds and peak memory of one search with its polish: python -m experiments.long_records.measure FOLDER ..."""

from __future__ import annotations

import json
import resource
import sys
import time
from pathlib import Path

from experiments.long_records.stage import density, problem, write
from pzt_ident.model.registry import optimizers
from pzt_ident.search.descent import DAMPINGS, polish
from pzt_ident.search.loop import Stop, optimize
from pzt_ident.search.uncertainty import estimates

POPULATION, GENERATIONS = 70, 50
OF_DENSITIES = 2  # generations of a search each of whose candidates is solved for


def measured(folder: Path, records: int, axes: int, free: int) -> dict[str, float]:
    """Seconds of CPU, MiB. free: parameters that are searched for; 0 for a free density."""
    begun = time.process_time()
    made = problem(folder, records, axes, free) if free else density(folder, records)
    generations = GENERATIONS if free else OF_DENSITIES
    made.loss([[0.5] * made.dimensions])
    found = {"prepare": time.process_time() - begun, "prepare_peak": peak()}
    begun = time.process_time()
    chosen = optimizers["pso"].make(population=POPULATION, generations=generations)
    outcome = optimize(chosen, made.dimensions, made.loss, 1, Stop(POPULATION * generations))
    found |= {
        "candidates": outcome.evaluations,
        "search": time.process_time() - begun,
        "search_peak": peak(),
        "rmse_before": outcome.loss,
    }
    begun = time.process_time()
    point, spent = polish(made, outcome.point)
    a_step = 2 * made.dimensions + 1 + len(DAMPINGS)
    found |= {"polish": time.process_time() - begun, "polish_peak": peak(), "steps": spent // a_step}
    found["rmse"] = float(made.loss(point)[0])
    begun = time.process_time()
    estimates(made, point)
    return found | {"errors": time.process_time() - begun, "peak": peak()}


def peak() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


if __name__ == "__main__":
    what, folder, *numbers = sys.argv[1:]
    if what == "write":
        write(Path(folder), *map(int, numbers))
    else:
        print(json.dumps(measured(Path(folder), *map(int, numbers))))
