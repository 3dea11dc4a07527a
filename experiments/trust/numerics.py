"""Whether one measurement told in other words comes to the same physics, and to the same verdict."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from itertools import chain, count
from math import ceil, log10, sqrt
from pathlib import Path
from typing import Any

import numpy as np

from experiments.coverage.stage import MASS, displacement
from experiments.trust.bench import Bench, Case, command
from experiments.trust.good import Array, Columns, measurement
from experiments.trust.malformed import identified
from experiments.trust.oversampled import (
    HIDDEN,
    NOISE,
    RATE,
    SAMPLES,
    coupled_record,
    record,
    step_error,
    with_mechanics,
)
from experiments.trust.tellings import OF_TWO_AXES, OTHERWISE, PLAIN, SI, THINNED, USES, Telling

SAME = 1e-9
FAR = 3.0
"""Times the noise that is in the parameters: of seven the square sum stays below its sevenfold 9 but once in 10^9."""
SINGLE, COUPLED = "model: [bouc_wen]\n", "model: [bouc_wen]\neffects: [cross_coupling]\n"
MECHANICAL = f"model: [bouc_wen, lumped]\nparameters: {{lumped.mass: {{value: {MASS}}}}}\n"


def cases(numbers: range, seed: int, scratch: Path) -> Iterator[Case]:
    """Round after round, each on other measurements."""
    with Bench() as bench:
        rounds = (around(bench, scratch / f"{seed}", seed) for seed in count(seed))
        for number, case in zip(numbers, chain.from_iterable(rounds), strict=False):
            case.number = number
            yield case


def around(bench: Bench, home: Path, seed: int) -> Iterator[Case]:
    yield from told_otherwise(bench, home / "one axis", seed, measurement, SINGLE, OTHERWISE)
    yield from told_otherwise(bench, home / "two axes", seed, coupled_record, COUPLED, OF_TWO_AXES)
    yield thinned(bench, home / "thinned", seed)
    yield from diagnosed_otherwise(bench, home / "diagnosed", seed, (*OTHERWISE, THINNED))


def told_otherwise(
    bench: Bench, home: Path, seed: int, draw: Callable[[int, str], Columns], model: str, tellings: Sequence[Telling]
) -> Iterator[Case]:
    """The physics of tellings against those of the plain one."""
    records = {name: draw(seed + 1000 * place, use) for place, (name, use) in enumerate(USES.items())}

    def answer(telling: Telling) -> str:
        return bench.call(identified, telling.write(home / telling.name, records, model, seed)).answer

    plain = answer(PLAIN)
    for telling in tellings:
        yield compared(Case(0, f"{home.name}: {telling.name}", ""), telling, plain, answer(telling))


def compared(case: Case, telling: Telling, plain: str, other: str) -> Case:
    true, told = physics(plain, PLAIN), physics(other, telling)
    apart = {name: abs(told[name] - value) / abs(value) for name, value in true.items() if value}
    worst = max(apart.values())
    case.came = f"within {10.0 ** ceil(log10(max(worst, 1e-16))):.0e}"
    if worst > SAME:
        case.faults.append(f"{worst:.1e} apart: {', '.join(name for name, far in apart.items() if far > SAME)}")
    if verdicts(plain, PLAIN) != verdicts(other, telling):
        case.faults.append("another verdict")
    return case


def in_si(value: float, unit: str) -> float:
    above, _, below = unit.partition("/")
    return value * SI[above] / SI[below]


def parameters(answer: str, telling: Telling) -> dict[str, dict[str, Any]]:
    """Those of a result by their names in the plain telling."""
    axes = {told: plain for plain, told in telling.axes.items()}
    facts: dict[str, dict[str, Any]] = json.loads(answer)["best"]["parameters"]
    return {".".join(axes.get(word, word) for word in name.split(".")): entry for name, entry in facts.items()}


def physics(answer: str, telling: Telling) -> dict[str, float]:
    """Errors, noise, parameters and standard errors of a result, in SI units."""
    result = json.loads(answer)
    facts = {f"RMSE, {use}": in_si(value, result["unit"]) for use, value in result["best"]["rmse"].items()}
    facts["noise floor"] = in_si(result["floor"], result["unit"])
    for name, parameter in parameters(answer, telling).items():
        facts[name] = in_si(parameter["value"], parameter["unit"])
        facts[f"{name}, standard error"] = in_si(parameter["standard_error"] or 0.0, parameter["unit"])
    return facts


def verdicts(answer: str, telling: Telling) -> dict[str, str]:
    return {name: parameter["verdict"] for name, parameter in parameters(answer, telling).items()}


def thinned(bench: Bench, home: Path, seed: int) -> Case:
    """A record with mechanics, of which every second sample is left.

    To first order the two fits differ by what least squares make of two changes: that of the response under a step
    twice as long, and that of the noise. They can give no more to the response than there is of the first; of the
    second, the share of so many parameters.
    """
    records = {name: record(seed + 1000 * place, use, with_mechanics) for place, (name, use) in enumerate(USES.items())}
    answers = [
        bench.call(identified, telling.write(home / telling.name, records, MECHANICAL, seed)).answer
        for telling in (PLAIN, THINNED)
    ]
    plain, other = map(stage_of, answers)
    fitted = sum(use == "identify" for use in USES.values())
    statistical = FAR * NOISE * sqrt((len(IDENTIFIED) + 1) / (fitted * SAMPLES))
    case = Case(0, f"mechanics: {THINNED.name}", "within what step and noise allow")
    for name, columns in records.items():
        u = columns["u [V]"]
        apart = float(np.std(other(u, 1 / RATE) - plain(u, 1 / RATE)))
        if apart > (allowed := step_error(u, plain) + statistical):
            case.faults.append(f"{name}: {apart:.1e} um apart, more than {allowed:.1e}")
    if verdicts(answers[0], PLAIN) != verdicts(answers[1], THINNED):
        case.faults.append("another verdict")
    return case


IDENTIFIED = ("gain", "alpha", "beta", "gamma", "stiffness", "damping")


def stage_of(answer: str) -> Callable[[Array, float], Array]:
    """The stage with the parameters of a result."""
    values = {name.rpartition(".")[2]: facts["value"] for name, facts in parameters(answer, PLAIN).items()}
    truth = {name: values[name] for name in IDENTIFIED}
    return lambda u, dt: displacement(u, dt, truth)


def diagnosed_otherwise(bench: Bench, home: Path, seed: int, tellings: Sequence[Telling]) -> Iterator[Case]:
    """What is missing by tellings and by the plain one; what is hidden changes with the seed."""
    hidden, stage = list(HIDDEN.items())[seed % len(HIDDEN)]
    records = {name: record(seed + 1000 * place, use, stage) for place, (name, use) in enumerate(USES.items())}
    words = ["diagnose", "job.yaml", "--budget", "30s", "--no-report", "--json", "--out", "out"]

    def verdict(telling: Telling) -> tuple[str, list[list[str]]]:
        return missing(bench.call(command, words, telling.write(home / telling.name, records, SINGLE, seed)).answer)

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
