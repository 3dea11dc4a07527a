"""The path without mechanics that the data do not show: they do not determine them, or none of their modes rings."""

from __future__ import annotations

from typing import NamedTuple

from pzt_ident.diagnosis.budget import WHOLE
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.climb import Staircase
from pzt_ident.diagnosis.criteria import adequate, removed_rms
from pzt_ident.diagnosis.exchange import find_rivals
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.modes import mechanics_at_second_mode
from pzt_ident.diagnosis.paths import SETTLED, Begun, begin, conclude, improve_within
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.step import Step, StepListener, explained_share
from pzt_ident.diagnosis.ties import TIE
from pzt_ident.diagnosis.undetermined import (
    Undetermined,
    mode_that_is_silent,
    undetermined_mechanics,
    unseen_mechanics,
    without_mechanics,
)
from pzt_ident.diagnosis.verdict import Diagnosis, diagnose

MOVED = "mechanics at another mode"  # the step that puts them where a second mode is


def settles_for(case: Case, first: Fit, lean: Staircase) -> bool:
    """Whether the staircase without mechanics is better than the model as given, and there is no time for another."""
    return lean.end.total < first.total and not case.budget.allows("effects beside the mechanics", WHOLE)


class Alternative(NamedTuple):
    """The model without its mechanics: their word, its case and fit."""

    word: str
    case: Case
    start: Fit


class Lean(NamedTuple):
    """The model without its mechanics, as far as its first path climbs: the steps to it, and that path."""

    alternative: Alternative
    steps: list[Step]
    begun: Begun

    @property
    def settled(self) -> bool:
        """Whether nothing is missing at the end of that path."""
        return self.begun.path.last.verdict in SETTLED


def lean_or_begun(
    case: Case, first: Fit, diagnosis: Diagnosis, on_step: StepListener
) -> tuple[Staircase | None, Begun | None]:
    """The staircase without mechanics that the data do not show, None where the first path with them alone reaches
    the noise, or as of `alternative_to`; and that path, None where it was not begun. Where two effects account for all
    with the mechanics and not without, that path is the first, and the only one where the data show the mechanics at
    its end. diagnosis: of the fit `first`."""
    alternative = alternative_to(case, first, diagnosis)
    if alternative is None:
        return None, None
    begun, lean = None, begin_alike(case, first, alternative, diagnosis, on_step)
    if diagnosis.account and lean is None:
        begun = begin(case, [Step(first)], on_step, diagnosis)
        shown = reaches(begun) and unseen_mechanics(begun.path.end) is None
        if shown or (reaches(begun) and not case.budget.allows("effects without the mechanics")):
            return None, begun
    lean = lean or begin_lean(case, first, alternative, on_step)
    if begun is None and not lean.settled and case.budget.allows("effects beside the mechanics"):
        begun = begin(case, [Step(first)], on_step, diagnosis)
    if reaches(begun) and not lean.settled:
        return None, begun
    return improve_lean(case, first, lean, on_step), begun


def reaches(begun: Begun | None) -> bool:
    """Whether a path was begun, and reaches the noise."""
    return begun is not None and begun.path.last.verdict == "adequate"


def alternative_to(case: Case, first: Fit, diagnosis: Diagnosis) -> Alternative | None:
    """The model without mechanics that the data do not show; None where these show them, alone or beside the best
    effect, or where the model needs one effect at most beside them. diagnosis: of the fit `first`."""
    settled = diagnosis.verdict in SETTLED or any(
        adequate(case, first, candidate.fit) for candidate in diagnosis.passing if candidate.fit
    )
    best = min((item.fit for item in diagnosis.passing if item.fit), key=lambda fit: fit.total, default=first)
    found = None if settled or unseen_mechanics(best) is None else without_mechanics(case, first)
    return Alternative(*found) if found else None


def begin_lean(case: Case, first: Fit, alternative: Alternative, on_step: StepListener) -> Lean:
    """The first path without mechanics."""
    steps = steps_without(case, first, *alternative)
    return Lean(alternative, steps, begin(alternative.case, steps, on_step))


def begin_alike(
    case: Case, first: Fit, alternative: Alternative, diagnosis: Diagnosis, on_step: StepListener
) -> Lean | None:
    """The path without mechanics to the two effects that account for all with them; None where there are none, or these
    do not without. diagnosis: of the model with mechanics."""
    account = diagnosis.account
    if account is None:
        return None
    _, lean, start = alternative
    base = steps_without(case, first, *alternative)
    steps = [*base]
    for number in range(len(start.effects), len(account.effects)):
        effects = account.effects[: number + 1]
        fit = refit(lean, steps[-1].fit, effects, account.values)
        steps.append(Step(fit, effects[-1], None, {effects[-1]: fit}, explained_share(lean, steps[-1].fit, fit)))
    if not adequate(lean, start, steps[-1].fit):
        return None
    for step in steps:
        on_step(step)
    return Lean(alternative, base, Begun(diagnosis, Staircase(steps, diagnose(lean, steps[-1].fit, start))))


def improve_lean(case: Case, first: Fit, lean: Lean, on_step: StepListener) -> Staircase:
    """The staircase without mechanics, or that with them at a second mode which it has. first: the model with them."""
    word, without, start = lean.alternative
    staircase = improve_within(without, lean.steps, on_step, begun=lean.begun)
    if moved := with_mechanics_moved(case, first, staircase.end, on_step):
        return moved
    share = explained_share(case, start, first)
    mode = None if undetermined_mechanics(first) else mode_that_is_silent(first)
    staircase.suspects.append(Undetermined(word, share, staircase.end.total / case.floor, mode))
    return staircase


def steps_without(case: Case, first: Fit, word: str, lean: Case, start: Fit) -> list[Step]:
    """The steps from the model as given to the one without its mechanics."""
    return [
        Step(first),
        Step(start, explained=explained_share(case, first, start), change=f"without {word}", case=lean),
    ]


def with_mechanics_moved(case: Case, first: Fit, end: Fit, on_step: StepListener) -> Staircase | None:
    """The staircase with the mechanics of the job where a second mode is that is missing without them: it is theirs.
    None where there is none, or the model fits worse so. end: the last fit without mechanics."""
    effects, there = mechanics_at_second_mode(end, first)
    if not there or not case.budget.allows("mechanics at another mode", WHOLE):
        return None
    fit = refit(case, first, effects, end.values | there)
    if removed_rms(fit.total, end.total) > TIE * case.floor:
        return None
    steps = [Step(first)]
    for number in range(len(first.effects), len(effects) + 1):
        now = refit(case, fit, effects[:number], {}) if number < len(effects) else fit
        added = effects[number - 1] if number > len(first.effects) else None
        share = explained_share(case, steps[-1].fit, now)
        steps.append(Step(now, added, None, {added: now} if added else {}, share, change="" if added else MOVED))
    for step in steps:
        on_step(step)
    find_rivals(case, first, steps, on_step)
    staircase = Staircase(steps, diagnose(case, steps[-1].fit, first))
    conclude(case, first, staircase)
    return staircase
