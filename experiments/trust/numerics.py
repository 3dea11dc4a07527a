"""Whether one measurement told in other words comes to the same physics, and to the same verdict."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from itertools import chain, count
from math import ceil, log10, sqrt
from pathlib import Path

import numpy as np

from experiments.coverage.stage import MASS, displacement
from experiments.trust.bench import Bench, Case, command
from experiments.trust.good import measurement
from experiments.trust.malformed import identified
from experiments.trust.oversampled import HIDDEN, NOISE, RATE, SAMPLES, Array, record, step_error, with_mechanics
from experiments.trust.tellings import OTHERWISE, PLAIN, THINNED, USES, Telling

SAME = 1e-9
FAR = 3.0
"""Times the noise that is in the parameters: of seven the square sum stays below its sevenfold 9 but once in 10^9."""
UNITS = {"V": 1.0, "kV": 1e3, "mV": 1e-3, "um": 1e-6, "m": 1.0, "nm": 1e-9, "": 1.0, "1": 1.0}


def cases(numbers: range, seed: int, scratch: Path) -> Iterator[Case]:
    """Round after round, each on other measurements."""
    with Bench() as bench:
        rounds = (around(bench, scratch / f"{seed}", seed) for seed in count(seed))
        for number, case in zip(numbers, chain.from_iterable(rounds), strict=False):
            case.number = number
            yield case


def around(bench: Bench, home: Path, seed: int) -> Iterator[Case]:
    yield from told_otherwise(bench, home / "told", seed, OTHERWISE)
    yield thinned(bench, home / "thinned", seed)
    yield from diagnosed_otherwise(bench, home / "diagnosed", seed, (*OTHERWISE, THINNED))


def told_otherwise(bench: Bench, home: Path, seed: int, tellings: Sequence[Telling]) -> Iterator[Case]:
    """The physics of tellings against those of the plain one."""
    records = {name: measurement(seed + 1000 * place, use) for place, (name, use) in enumerate(USES.items())}

    def answer(telling: Telling) -> str:
        return bench.call(identified, telling.write(home / telling.name, records, "bouc_wen", seed)).answer

    plain = answer(PLAIN)
    for telling in tellings:
        yield compared(Case(0, telling.name, ""), plain, answer(telling))


def compared(case: Case, plain: str, other: str) -> Case:
    true, told = physics(plain), physics(other)
    apart = {name: abs(told[name] - value) / abs(value) for name, value in true.items() if value}
    worst = max(apart.values())
    case.came = f"within {10.0 ** ceil(log10(max(worst, 1e-16))):.0e}"
    if worst > SAME:
        case.faults.append(f"{worst:.1e} apart: {', '.join(name for name, far in apart.items() if far > SAME)}")
    if verdicts(plain) != verdicts(other):
        case.faults.append("another verdict")
    return case


def in_si(value: float, unit: str) -> float:
    above, _, below = unit.partition("/")
    return value * UNITS[above] / UNITS[below]


def physics(answer: str) -> dict[str, float]:
    """Errors, noise, parameters and standard errors of a result, in SI units."""
    result = json.loads(answer)
    facts = {f"RMSE, {use}": in_si(value, result["unit"]) for use, value in result["best"]["rmse"].items()}
    facts["noise floor"] = in_si(result["floor"], result["unit"])
    for name, parameter in result["best"]["parameters"].items():
        word = name.split(".", name.count(".") - 1)[-1]
        facts[word] = in_si(parameter["value"], parameter["unit"])
        facts[f"{word}, standard error"] = in_si(parameter["standard_error"] or 0.0, parameter["unit"])
    return facts


def verdicts(answer: str) -> list[str]:
    return [parameter["verdict"] for parameter in json.loads(answer)["best"]["parameters"].values()]


def thinned(bench: Bench, home: Path, seed: int) -> Case:
    """A record with mechanics, of which every second sample is left.

    To first order the two fits differ by what least squares make of two changes: that of the response under a step
    twice as long, and that of the noise. They can give no more to the response than there is of the first; of the
    second, the share of so many parameters.
    """
    records = {name: record(seed + 1000 * place, use, with_mechanics) for place, (name, use) in enumerate(USES.items())}
    answers = []
    for telling in (PLAIN, THINNED):
        folder = telling.write(home / telling.name, records, "bouc_wen, lumped", seed)
        with (folder / "job.yaml").open("a", encoding="utf-8") as job:
            job.write(f"parameters: {{lumped.mass: {{value: {MASS}}}}}\n")
        answers.append(bench.call(identified, folder).answer)
    plain, other = map(stage_of, answers)
    fitted = sum(use == "identify" for use in USES.values())
    statistical = FAR * NOISE * sqrt((len(IDENTIFIED) + 1) / (fitted * SAMPLES))
    case = Case(0, THINNED.name, "within what step and noise allow")
    for name, columns in records.items():
        u = columns["u [V]"]
        apart = float(np.std(other(u, 1 / RATE) - plain(u, 1 / RATE)))
        if apart > (allowed := step_error(u, plain) + statistical):
            case.faults.append(f"{name}: {apart:.1e} um apart, more than {allowed:.1e}")
    if verdicts(answers[0]) != verdicts(answers[1]):
        case.faults.append("another verdict")
    return case


IDENTIFIED = ("gain", "alpha", "beta", "gamma", "stiffness", "damping")


def stage_of(answer: str) -> Callable[[Array, float], Array]:
    """The stage with the parameters of a result."""
    parameters = {name.rpartition(".")[2]: facts for name, facts in json.loads(answer)["best"]["parameters"].items()}
    truth = {name: parameters[name]["value"] for name in IDENTIFIED}
    return lambda u, dt: displacement(u, dt, truth)


def diagnosed_otherwise(bench: Bench, home: Path, seed: int, tellings: Sequence[Telling]) -> Iterator[Case]:
    """What is missing by tellings and by the plain one; what is hidden changes with the seed."""
    hidden, stage = list(HIDDEN.items())[seed % len(HIDDEN)]
    records = {name: record(seed + 1000 * place, use, stage) for place, (name, use) in enumerate(USES.items())}
    words = ["diagnose", "job.yaml", "--budget", "30s", "--no-report", "--json", "--out", "out"]

    def verdict(telling: Telling) -> tuple[str, list[list[str]]]:
        return missing(bench.call(command, words, telling.write(home / telling.name, records, "bouc_wen", seed)).answer)

    plain = verdict(PLAIN)
    for telling in tellings:
        case = Case(0, f"diagnosis of {hidden}, {telling.name}", plain[0])
        if (other := verdict(telling)) != plain:
            case.faults.append(f"{plain} became {other}")
        yield case


def missing(answer: str) -> tuple[str, list[list[str]]]:
    """The verdict of a diagnosis, and the effects that it names, each with those that it cannot be told from."""
    diagnosis = json.loads(answer)["diagnosis"]
    named = [entry["class"] for entry in diagnosis["candidates"] if entry["decision"] == "missing"]
    return diagnosis["verdict"], named
