"""Whether thinning turns a verdict: cases of hidden_effect improved with all samples and with fewer."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from experiments.hidden_effect import campaign, cases

SHARE = 3  # records to identify from are taken for long where they have more than a third of their samples
KINDS = {"single": 32, "pair": 8, "none": 6, "outside": 4}
TIMES, BACK = 4, 0.05  # s, in which a drive goes back to 0 V before it is played again
BUDGET = 300.0  # s of CPU an improvement, more than any needs: CPU seconds do less on a busy machine
Json = dict[str, Any]


def long(rng: np.random.Generator) -> list[campaign.Drive]:
    """The short campaign of hidden_effect, sampled four times as fast or played four times."""
    drives = campaign.short(rng)
    return [faster(drive) for drive in drives] if rng.random() < 0.5 else [again(drive) for drive in drives]


def faster(drive: campaign.Drive) -> campaign.Drive:
    fine = np.arange(TIMES * (len(drive.u_x) - 1) + 1) / (TIMES * drive.rate)
    u_x, u_y = (np.interp(fine, drive.time, u) for u in (drive.u_x, drive.u_y))
    return campaign.Drive(drive.name, drive.use, TIMES * drive.rate, u_x, u_y)


def again(drive: campaign.Drive) -> campaign.Drive:
    back = 1 - np.arange(1, round(BACK * drive.rate) + 1) / round(BACK * drive.rate)
    u_x, u_y = (np.tile(np.append(u, u[-1] * back), TIMES) for u in (drive.u_x, drive.u_y))
    return campaign.Drive(drive.name, drive.use, drive.rate, u_x, u_y)


campaign.CAMPAIGNS["rich"] = long


def named(kinds: dict[str, int], seed: int) -> list[tuple[str, int]]:
    """Kinds and seeds of the cases, kind after kind in turn, so that the first ones are of every kind."""
    places = [(number / count, kind, seed + number) for kind, count in kinds.items() for number in range(count)]
    return [(kind, seed) for _, kind, seed in sorted(places)]


def compare(folder: Path, kinds: dict[str, int], seed: int, workers: int) -> Iterator[Json]:
    """What was found in each case both ways; goes on where it was stopped. seed: of the first case of each kind."""
    with ThreadPoolExecutor(workers) as pool:
        yield from pool.map(lambda case: both(*case, folder), named(kinds, seed))


def both(kind: str, seed: int, folder: Path) -> Json:
    """What was found in one case, which is drawn where it is not there yet."""
    name = f"{kind}-{seed}"
    result, case = folder / "verdicts" / f"{name}.json", folder / "cases" / name
    if not result.exists():
        result.parent.mkdir(parents=True, exist_ok=True)
        if not (case / "job.yaml").exists():
            cases.write(*cases.draw(kind, seed), folder)
        found: Json = {"case": name}
        for way in ("all", "fewer"):
            command = [sys.executable, "-m", "experiments.long_records.verdicts", str(case), way]
            found[way] = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        result.write_text(json.dumps(found, indent=1))
    return dict(json.loads(result.read_text()))


def found_in(case: Path, way: str) -> Json:
    """Verdict, effects, CPU seconds, and how many samples it took."""
    from tempfile import TemporaryDirectory

    from pzt_ident.diagnosis import thinning
    from pzt_ident.job.schema import load_job
    from pzt_ident.run.computing import computing
    from pzt_ident.run.improve import improve
    from pzt_ident.run.statement import Statement

    job = load_job(case / "job.yaml")
    samples = sum(record.samples for record in Statement(job).records if record.use == "identify")
    thinning.LONG = samples // SHARE if way == "fewer" else samples
    begun = time.process_time()
    with TemporaryDirectory() as folder, computing():
        content = json.loads((improve(job, Path(folder) / "out", budget=BUDGET) / "improvement.json").read_text())
    facts = {name: content[name] for name in ("verdict", "effects", "forms", "reason")}
    facts["classes"] = {step["added"]: step["class"] for step in content["steps"] if step["added"]}
    facts["suspects"] = [suspect["effect"] for suspect in content["suspects"]]
    floors = [step["rmse"]["identify"] / content["floor"] for step in content["steps"]]
    seconds = time.process_time() - begun
    return (
        facts
        | {"samples": samples, "seconds": seconds, "held": "Effects were sought on" in content["reason"]}
        | {"floors": floors}
    )


def same(found: Json) -> bool:
    """Whether both ways end with the same verdict and the same effects, or with others that both say these data cannot
    tell from them."""
    every, few = found["all"], found["fewer"]
    ours, theirs = set(every["effects"]) - set(few["effects"]), set(few["effects"]) - set(every["effects"])
    tied = {a: [b for b in theirs if b in every["classes"][a] and a in few["classes"][b]] for a in ours}
    return every["verdict"] == few["verdict"] and len(ours) == len(theirs) and all(tied.values())


def table(found: list[Json]) -> str:
    """One line for a single case, else the counts."""
    if len(found) == 1:
        both = [f"{found[0][way]['verdict']} {' '.join(found[0][way]['effects'])}" for way in ("all", "fewer")]
        return f"{found[0]['case']}: {both[0]}; with fewer samples {both[1] if not same(found[0]) else 'the same'}"
    held = [one for one in found if one["fewer"]["held"]]
    seconds = [sum(one[way]["seconds"] for one in found) for way in ("all", "fewer")]
    return (
        f"{len(found)} cases: {sum(map(same, found))} with the same verdict and effects; what fewer samples said held"
        f" on all in {len(held)}, in {sum(map(same, held))} of these the same; {seconds[0]:.0f} s CPU with all samples,"
        f" {seconds[1]:.0f} s with fewer"
    )


if __name__ == "__main__":
    print(json.dumps(found_in(Path(sys.argv[1]), sys.argv[2])))
