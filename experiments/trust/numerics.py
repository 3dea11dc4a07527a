"""The same measurement told in other words: other units, other names, another order. The physics must be the same."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from experiments.trust.bench import Bench, Case
from experiments.trust.good import Columns, measurement, table
from experiments.trust.malformed import identified

SAME = 1e-9
JOB = """\
name: told
records:
{records}
channels:
  time: "{time}"
  axes:
    {axis}: {{drive: "{drive}", response: "{response}"}}
model: [bouc_wen]
optimizers:
  - {{name: pso, population: 30, generations: 40}}
seed: {seed}
"""


@dataclass(frozen=True)
class Telling:
    """scales: of the columns of a file. headers: the columns' names there."""

    name: str
    scales: tuple[float, float, float] = (1, 1, 1)
    headers: tuple[str, str, str] = ("time [s]", "u [V]", "x [um]")
    axis: str = "x"
    backwards: bool = False


TELLINGS = (
    Telling("kV", (1, 1e-3, 1), ("time [s]", "u [kV]", "x [um]")),
    Telling("mV", (1, 1e3, 1), ("time [s]", "u [mV]", "x [um]")),
    Telling("m", (1, 1, 1e-6), ("time [s]", "u [V]", "x [m]")),
    Telling("nm", (1, 1, 1e3), ("time [s]", "u [V]", "x [nm]")),
    Telling("ms", (1e3, 1, 1), ("time [ms]", "u [V]", "x [um]")),
    Telling("kV, m and ms", (1e3, 1e-3, 1e-6), ("time [ms]", "u [kV]", "x [m]")),
    Telling("records in another order", backwards=True),
    Telling("an axis of another name", axis="piezo"),
    Telling("columns of other names", headers=("t [s]", "drive [V]", "path [um]")),
)


def write(folder: Path, telling: Telling, columns: dict[str, Columns], seed: int) -> Path:
    folder.mkdir()
    for name, values in columns.items():
        told = (values[key] * scale for key, scale in zip(("time [s]", "u [V]", "x [um]"), telling.scales, strict=True))
        text = table(dict(zip(telling.headers, told, strict=True)))
        (folder / f"{name}.csv").write_text(text, encoding="utf-8")
    uses = {"a": "identify", "c": "identify", "b": "validate"}
    lines = [f"  - {{file: {name}.csv, use: {use}}}" for name, use in uses.items()]
    time, drive, response = telling.headers
    facts = {"records": "\n".join(lines[::-1] if telling.backwards else lines), "axis": telling.axis, "seed": seed}
    (folder / "job.yaml").write_text(JOB.format(time=time, drive=drive, response=response, **facts), encoding="utf-8")
    return folder


UNITS = {"V": 1.0, "kV": 1e3, "mV": 1e-3, "um": 1e-6, "m": 1.0, "nm": 1e-9, "": 1.0, "1": 1.0}


def in_si(value: float, unit: str) -> float:
    above, _, below = unit.partition("/")
    return value * UNITS[above] / UNITS[below]


def physics(answer: str) -> dict[str, float]:
    """Errors, noise, parameters and standard errors of a result, in SI units."""
    result = json.loads(answer)
    found = {f"RMSE, {use}": in_si(value, result["unit"]) for use, value in result["best"]["rmse"].items()}
    found["noise floor"] = in_si(result["floor"], result["unit"])
    for name, facts in result["best"]["parameters"].items():
        word = name.split(".", name.count(".") - 1)[-1]
        found[word] = in_si(facts["value"], facts["unit"])
        found[f"{word}, standard error"] = in_si(facts["standard_error"] or 0.0, facts["unit"])
    return found


def verdicts(answer: str) -> list[str]:
    return [facts["verdict"] for facts in json.loads(answer)["best"]["parameters"].values()]


def cases(numbers: range, seed: int, scratch: Path) -> Iterator[Case]:
    """Each is one telling of one measurement, against the plain one."""
    with Bench() as bench:
        for number in numbers:
            round_, which = divmod(number, len(TELLINGS))
            drawn = seed + round_
            columns = {name: measurement(drawn + 1000 * i, use) for i, (name, use) in enumerate(USES.items())}
            home = scratch / f"{number}"
            home.mkdir()
            told = [Telling("plain"), TELLINGS[which]]
            answers = [bench.call(identified, write(home / str(i), t, columns, drawn)) for i, t in enumerate(told)]
            yield compared(Case(number, told[1].name, ""), *(answer.answer for answer in answers))


USES = {"a": "identify", "b": "validate", "c": "identify"}


def compared(case: Case, plain: str, other: str) -> Case:
    true, found = physics(plain), physics(other)
    worst = max(abs(found[name] - value) / abs(value) for name, value in true.items() if value)
    case.came = f"within {10.0 ** exponent(worst):.0e}"
    if worst > SAME:
        far = [name for name, value in true.items() if value and abs(found[name] - value) > SAME * abs(value)]
        case.faults.append(f"{worst:.1e} apart: {', '.join(far)}")
    if verdicts(plain) != verdicts(other):
        case.faults.append("another verdict")
    return case


def exponent(value: float) -> int:
    from math import ceil, log10

    return ceil(log10(max(value, 1e-16)))
