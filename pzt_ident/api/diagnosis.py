"""Which effect a fit misses, and the staircase that adds what is missing."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.api.arguments import of_kind
from pzt_ident.api.fit import Fit
from pzt_ident.api.printed import html, table_text
from pzt_ident.api.refit import as_given, from_refit
from pzt_ident.data.notation import number, percent, quantity, unit
from pzt_ident.diagnosis import thinning
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import Fit as Fitted
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.run.computing import computing
from pzt_ident.run.events import step_name, verdict_line
from pzt_ident.run.findings import diagnosis_of, improvement_of
from pzt_ident.run.improve import case_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class NextExperiment:
    """The drive to run on the rig, t (samples,) in s and u in the user's units by axis, which tells `splits` apart."""

    splits: tuple[str, ...]
    why: str
    t: Array
    u: dict[str, Array]


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """What a model misses: `verdict` is missing, adequate, unexplained, inconclusive or refused, and `reason` says why.

    candidates: as in `diagnosis.json`, best first. content: all of that file.
    """

    verdict: str
    reason: str
    candidates: list[dict[str, Any]]
    next_experiment: NextExperiment | None
    content: dict[str, Any]

    @property
    def missing(self) -> list[str]:
        """The effects that these data call missing; of several they cannot tell which."""
        return [item["effect"] for item in self.candidates if item["decision"] == "missing"]

    def __str__(self) -> str:
        return f"{verdict_line(self.verdict, self.reason)}\n\n{table_text(*self._table())}"

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return html(verdict_line(self.verdict, self.reason), *self._table())

    def _table(self) -> tuple[list[str], list[list[str]]]:
        printed = unit(self.content["unit"]) or "1"
        tried = [item for item in self.candidates if item["rmse"] or item["explained"] > 0.01]
        rows = [[item["item"], percent(item["explained"]), *_errors(item["rmse"]), item["decision"]] for item in tried]
        return ["effect", "explains", f"identification [{printed}]", f"validation [{printed}]", "decision"], rows


@dataclass(frozen=True, eq=False)
class Step:
    """One stair: the fit after it, the effect added or removed, and the effects that these data cannot tell from it."""

    fit: Fit
    added: str | None
    removed: str | None
    tied: tuple[str, ...]
    explained: float

    @property
    def rmse(self) -> dict[str, float | None]:
        return self.fit.rmse


@dataclass(frozen=True, eq=False)
class Improvement:
    """The staircase from the model as given to the last one: `steps`, the verdict on the last model, the `effects` that
    were added, and all of `improvement.json` as `content`."""

    steps: list[Step]
    verdict: str
    reason: str
    effects: list[str]
    content: dict[str, Any]

    @property
    def fit(self) -> Fit:
        """The last one."""
        return self.steps[-1].fit

    def plot(self, width: float = 180) -> Figure:
        """RMSE after each step on both kinds of records, and the noise floor. width: mm."""
        from pzt_ident.api.drawing import staircase_figure

        return staircase_figure(self.content, width)

    def __str__(self) -> str:
        return f"{table_text(*self._table())}\n\n{self._foot()}"

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return html("", *self._table(), self._foot())

    def _foot(self) -> str:
        floor = quantity(self.content["floor"], self.content["unit"])
        return f"noise floor: {floor}\n{verdict_line(self.verdict, self.reason)}"

    def _table(self) -> tuple[list[str], list[list[str]]]:
        printed, floor = unit(self.content["unit"]) or "1", self.content["floor"]
        rows = [
            [step_name(step), *_errors(step["rmse"]), number(step["rmse"]["identify"] / floor, 3) if floor else ""]
            for step in self.content["steps"]
        ]
        return ["step", f"identification [{printed}]", f"validation [{printed}]", "in floors"], rows


def diagnose(fit: Fit) -> Diagnosis:
    """Which effect the model of a fit misses, by the steps of `pzt-ident diagnose`: every effect scored, the best
    refitted, judged on both kinds of records."""
    with _case(fit) as (case, first, folder):
        content = diagnosis_of(fit.statement.job, case, thinning.diagnosed(case, first), folder)
        return Diagnosis(
            content["verdict"], content["reason"], content["candidates"], _proposed(content, folder), content
        )


def improve(fit: Fit, budget: float | None = None) -> Improvement:
    """Add what is missing and diagnose again, until nothing is missing or nothing more is known; budget: seconds of
    work, after which the verdict is on what was found by then. Without end if None."""
    with _case(fit) as (case, first, folder):
        case.budget = Budget(budget)
        job, stairs = fit.statement.job, thinning.improve(case, first)
        content = improvement_of(job, case, stairs, diagnosis_of(job, case, stairs.last, folder))
        steps = [
            Step(Fit(*from_refit(fit, case, step.fit)), step.added, step.removed, step.tied, step.explained)
            for step in stairs.steps
        ]
        return Improvement(steps, content["verdict"], content["reason"], content["effects"], content)


@contextmanager
def _case(fit: Fit) -> Iterator[tuple[Case, thinning.First, Path]]:
    """The case of a fit, how to come to the better of it and of a fit from other starts, and a folder for what is
    written."""
    of_kind(fit, Fit, "fit", "give what pzt_ident.identify or pzt_ident.load returned")
    with computing(), TemporaryDirectory() as folder:

        def first(case: Case) -> Fitted:
            other, given = first_fit(case, fit.statement.job.seed), as_given(case, fit)
            return other if other.identify <= given.identify else given

        yield case_of(fit.statement), first, Path(folder)


def _proposed(content: dict[str, Any], folder: Path) -> NextExperiment | None:
    proposal = content["next_experiment"]
    if not proposal:
        return None
    path = folder / proposal["file"]
    header = path.read_text(encoding="utf-8").splitlines()[0].split(",")
    columns = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2).T
    drives = {name.partition(" ")[0].removeprefix("u_"): u for name, u in zip(header[1:], columns[1:], strict=True)}
    return NextExperiment(tuple(proposal["splits"]), proposal["why"], columns[0], drives)


def _errors(rmse: dict[str, float | None] | None) -> list[str]:
    return [number(rmse[use]) if rmse else "" for use in ("identify", "validate")]
