"""A fit from elsewhere that a run, a diagnosis or an improvement starts from."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.units import factor, same_kind
from pzt_ident.errors import InputError
from pzt_ident.files import write_json
from pzt_ident.job.schema import Job
from pzt_ident.model.registry import blocks
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]
Start = Mapping[str, tuple[float, str]]  # values with their units, by name

START = "start"  # stands where an optimizer's word does
STARTS = "starts.json"
REMEDY = "give the folder of a run, a diagnosis or an improvement, or a JSON file with `parameters`"


def read_start(path: Path, job: Job) -> dict[str, tuple[float, str]]:
    """The parameters of the fit in a folder of results that is nearest to the model of a job: that of the run, the
    refit in which a diagnosis tried the effect that the job has more, else the model that was diagnosed; or those of a
    JSON file.

    Raises InputError where there is none, or it has no parameter of the job's model.
    """
    parameters = next(filter(None, _fits(path, job)), None)
    if parameters is None:
        raise InputError("holds no fit", where=str(path), remedy=REMEDY)
    start = _values(parameters)
    if not set(start) & set(job.chain.names):
        message = f"has no parameter of the model, which has {', '.join(job.chain.names[:3])}"
        raise InputError(message, where=str(path), remedy=REMEDY)
    return start


@dataclass(frozen=True)
class Starts:
    """Fits from elsewhere that a run polishes beside its searches: where each came from, and its parameters; `search`:
    whether the optimizers search too."""

    given: tuple[tuple[str, Start], ...] = ()
    search: bool = True

    @classmethod
    def kept(cls, folder: Path) -> Starts:
        """Those that a run began with, of the file in its folder."""
        content = _json(folder / STARTS)
        given = ((entry["from"], _values(entry["parameters"])) for entry in content.get("starts", ()))
        return cls(tuple(given), content.get("search", True))

    def keep(self, folder: Path) -> None:
        starts = [{"from": place, **file_of(start)} for place, start in self.given]
        if starts:
            write_json(folder / STARTS, {"search": self.search, "starts": starts})

    def and_(self, path: Path | None, job: Job) -> Starts:
        """These and the fit in another place, if one is given. Raises InputError where it holds none."""
        return self if path is None else replace(self, given=(*self.given, (str(path), read_start(path, job))))


def file_of(start: Start) -> dict[str, Any]:
    """The content of a JSON file that says the same as a start."""
    return {"parameters": {name: {"value": value, "unit": unit} for name, (value, unit) in start.items()}}


def starts_of(runs: Sequence[Mapping[str, Any]]) -> Starts:
    """What the runs of a result began from, as far as it is known: the fits that they came to."""
    given = [(run["run"], _values(run["parameters"])) for run in runs if run["optimizer"] == START]
    return Starts(tuple(given), search=len(given) < len(runs))


def _values(parameters: Mapping[str, Any]) -> dict[str, tuple[float, str]]:
    return {
        name: (float(parameter["value"]), str(parameter["unit"]))
        for name, parameter in parameters.items()
        if _known(parameter)
    }


def _known(parameter: Any) -> bool:
    return (
        isinstance(parameter, dict)
        and isinstance(parameter.get("value"), int | float)
        and np.isfinite(parameter["value"])
    )


def _fits(path: Path, job: Job) -> Iterator[dict[str, Any] | None]:
    """The parameters of the fits that lie in a place, the nearest to the model of a job first."""
    if path.is_file():
        yield _json(path).get("parameters")
        return
    diagnosis = _json(path / "diagnosis.json")
    added = set(map(_item, job.effects)) - set(map(_item, diagnosis.get("effects", ())))
    for candidate in diagnosis.get("candidates", ()):
        if added == {_item(candidate["item"])}:
            yield candidate.get("parameters")
    best = _json(path / "result.json").get("best") or {}
    yield best.get("fixed", {}) | best["parameters"] if best else None
    steps = _json(path / "improvement.json").get("steps", ())
    same = [step for step in steps if set(map(_item, step.get("effects", ()))) == set(map(_item, job.effects))]
    yield from (step["parameters"] for step in [*same[-1:], *steps[-1:]])
    yield diagnosis.get("parameters")


def _item(effect: str) -> str:
    """An effect in its form, however a job names it."""
    return blocks[effect].item() if effect in blocks else effect


def _json(path: Path) -> dict[str, Any]:
    """The content of a file; empty where there is none. Raises InputError where it is no JSON mapping."""
    if not path.is_file():
        return {}
    try:
        return dict(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        raise InputError("is not JSON as `pzt-ident` writes it", where=str(path), remedy=REMEDY) from None


def start_values(problem: Problem, start: Start) -> dict[str, float]:
    """The free parameters of a problem in its units: those of a start; of one that it lacks the null, where there is
    one, else the middle of its range. Raises InputError where a unit is of another kind."""
    middle = problem.physical(np.full(problem.dimensions, 0.5))[0]
    values = {}
    for name, unit, column, between in zip(problem.names, problem.units, problem.free, middle, strict=True):
        null = problem.model.entries[column].parameter.null
        given = _in_unit(start[name], unit, name) if name in start else null
        values[name] = float(between) if given is None else given
    return values


def _in_unit(given: tuple[float, str], unit: str, name: str) -> float:
    value, of = given
    if of != "1" and not same_kind(of, unit):
        raise InputError(f"{name} is in {of}, not in {unit}", where="--from", remedy=f"give it in {unit}")
    return value * factor(of) / factor(unit)


def start_point(problem: Problem, start: Start) -> Array:
    """The point of the unit cube where a search from a start begins."""
    return problem.unit_point(start_values(problem, start))


def theta_of(problem: Problem, start: Start) -> Array:
    """All parameters of a problem in SI units: those of a start as they are, the others as `start_values`."""
    theta = problem.parameters_at(np.array([start_values(problem, start)[name] for name in problem.names]))
    for column, (name, unit) in enumerate(zip(problem.model.names, problem.all_units, strict=True)):
        if name in start:
            theta[column] = _in_unit(start[name], unit, name) * factor(unit)
    return theta
