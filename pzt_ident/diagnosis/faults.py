"""Faults of the set-up, which are mended and not modelled: whether one alone accounts for what a model lacks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from pzt_ident.data.notation import listed
from pzt_ident.diagnosis.budget import WHOLE
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.climb import Staircase
from pzt_ident.diagnosis.criteria import DECISIVE, adequate, removed_rms
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.limit import own_bounds
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.paths import SETTLED
from pzt_ident.diagnosis.possible import applicable
from pzt_ident.diagnosis.proof import SINGLE, suspect
from pzt_ident.diagnosis.reasons import fault_explains
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.score import scorer_of
from pzt_ident.diagnosis.starts import restart
from pzt_ident.diagnosis.step import Step, explained_share
from pzt_ident.diagnosis.ties import TIE
from pzt_ident.diagnosis.verdict import Diagnosis, diagnose
from pzt_ident.model.registry import blocks, phrase_of

AHEAD = 0.2  # of the budget, after which no fault is fitted from elsewhere ahead of effects
LIKELY = 0.3  # of the misfit: a fault that scores less is not all that is missing, and is not fitted
BACK = "back to the model as given"  # the step that takes out what a fault of the set-up does better


@dataclass(frozen=True)
class Fault:
    """A fault of the set-up that alone accounts for what a model lacks: its share of the misfit, what it leaves in
    noise floors, and the effects that leave more."""

    effect: str
    share: float
    left: float
    outdone: tuple[str, ...] = ()

    @property
    def why_not(self) -> str:
        """A sentence on why it is not in the last model."""
        beside = f", where {listed(map(phrase_of, self.outdone))} would leave more" if self.outdone else ""
        return (
            f"{self.effect} alone takes up {self.share:.0%}".replace("%", " %")
            + f" of the misfit and leaves {self.left:.3g} noise floors{beside}: a fault of the set-up, which is mended"
            f" and not modelled. {blocks[self.effect].remedy} To have it in the model nevertheless, add it by hand."
        )


def faults_of(case: Case, first: Fit, share: float = WHOLE) -> Iterator[tuple[str, Fit]]:
    """The faults that score, each with the fit of the model as given with it, the best first, from elsewhere too where
    that explains most and is not at the noise, as long as less than a share of the budget is spent. Where all of it is
    spent, those that are known."""
    fits = dict[str, Fit]()
    for word in applicable(case, first.effects, in_setup=True):
        if not case.budget.allows("faults of the set-up", WHOLE):
            fits = case.faults | fits
            break
        score = scorer_of(case, first).score(word)
        if score.explained > LIKELY:
            fits[word] = refit(case, first, (*first.effects, word), score.guess)
    for word in sorted(fits, key=lambda word: fits[word].total):
        fit = fits[word]
        at_side = share_explained(first.total, fit.total, case.floor) >= DECISIVE and not adequate(case, first, fit)
        case.faults[word] = restart(case, fit, share=share) if at_side else fit
        yield word, case.faults[word]


def fault_instead(case: Case, first: Fit, share: float = WHOLE) -> Staircase | None:
    """The staircase of the model as given where a fault of the set-up alone leads to the noise, and no effect stands
    beside it. share: as of `faults_of`."""
    at_noise = [(word, fit) for word, fit in faults_of(case, first, share) if adequate(case, first, fit)]
    if not at_noise:
        return None
    word, fit = simplest(case, at_noise)
    diagnosis = diagnose(case, first)
    if any(item.fit and stands_beside(case, fit, item.fit) for item in diagnosis.candidates):
        return None
    return told_instead(case, first, diagnosis, word, fit)


def told_instead(case: Case, first: Fit, diagnosis: Diagnosis, word: str, fit: Fit) -> Staircase:
    """The staircase of the model as given of which a fault is the account. fit: with it."""
    steps = [Step(first), *there_and_back(case, first, word, fit)]
    return Staircase(steps, blamed_on(case, first, diagnosis, word), [fault_in(case, first, word, fit)])


def fault_within_bounds(case: Case, first: Fit, mended: Staircase) -> Staircase | None:
    """The same of a fault that was told beyond the bounds of the job, if it leads to the noise within them, too: then
    these are not too narrow. None where it does not."""
    (word,) = mended.last.faults
    fit = case.faults.get(word)
    return told_instead(case, first, mended.last, word, fit) if fit and adequate(case, first, fit) else None


def with_faults(case: Case, diagnosis: Diagnosis) -> Diagnosis:
    """The diagnosis of a model, of which a fault of the set-up that alone leads to the noise is the account if any
    effect leaves clearly more."""
    mended = None if diagnosis.verdict in SETTLED else fault_instead(case, diagnosis.before)
    if mended is None:
        return diagnosis
    return replace(mended.last, reason=f"{mended.last.reason} {mended.suspects[0].why_not}")


def simplest(case: Case, accounts: list[tuple[str, Fit]]) -> tuple[str, Fit]:
    """The account with the fewest parameters of those that leave hardly more than the best. A dead zone that ends
    beyond the largest command is a supply that is reached."""
    best = min((fit for _, fit in accounts), key=lambda fit: fit.total)
    close = [account for account in accounts if not leaves_less(case, best, account[1])]
    return min(close, key=lambda account: (account[1].freedom, account[1].total))


def stands_beside(case: Case, fit: Fit, other: Fit) -> bool:
    """Whether an effect may be there as well as a fault: it leaves hardly more, and is not in a limit of its own in
    which it leaves hardly less. Dry friction without inertia is a play."""
    return not leaves_less(case, fit, other) and (
        leaves_less(case, other, fit) or not own_bounds(other, other.effects[-1])
    )


def leaves_less(case: Case, fit: Fit, other: Fit) -> bool:
    """Whether a fit leaves clearly less than another one."""
    return removed_rms(other.total, fit.total) > TIE * case.floor


def without_outdone(case: Case, staircase: Staircase) -> Staircase:
    """The staircase back at the model as given, where a fault of the set-up alone leaves clearly less than the effects
    that were added; as it is where none does."""
    home, end = staircase.case or case, staircase.end
    as_given = staircase.steps[0].fit.effects
    added = end.effects[len(as_given) :]
    known = any(isinstance(item, Fault) for item in staircase.suspects)
    if known or not (added or staircase.last.verdict == "unexplained"):
        return staircase
    first = refit(home, end, as_given, {}) if added else end
    accounts = [
        (word, fit)
        for word, fit in faults_of(home, first)
        if share_explained(first.total, fit.total, home.floor) >= SINGLE and leaves_less(home, fit, end)
    ]
    if not accounts:
        return staircase
    word, fit = simplest(home, accounts)
    staircase.suspects = [
        *(replace(suspect(home, first, end, item, (word,)), strangers=(word,)) for item in added),
        *staircase.suspects,
        fault_in(home, first, word, fit, added),
    ]
    staircase.last = blamed_on(home, first, staircase.last, word)
    if added:
        staircase.steps.append(Step(first, explained=explained_share(home, end, first), change=BACK))
    staircase.steps += there_and_back(home, first, word, fit)
    return staircase


def there_and_back(case: Case, first: Fit, word: str, fit: Fit) -> list[Step]:
    """The steps that show what a fault accounts for, and take it out again."""
    with_it = Step(fit, word, None, {word: fit}, explained_share(case, first, fit))
    return [with_it, Step(first, None, word, {}, explained_share(case, fit, first))]


def fault_in(case: Case, first: Fit, word: str, fit: Fit, outdone: tuple[str, ...] = ()) -> Fault:
    """What a fault accounts for of what the model as given leaves."""
    share = share_explained(first.total, fit.total, case.floor)
    return Fault(word, share, fit.total / case.floor, outdone)


def blamed_on(case: Case, first: Fit, diagnosis: Diagnosis, word: str) -> Diagnosis:
    """The diagnosis of the model as given, of which a fault is the account and no effect."""
    for candidate in diagnosis.candidates:
        candidate.decision = "suspect" if candidate.decision == "missing" else candidate.decision
    reason = fault_explains(case, first)
    return Diagnosis("unexplained", reason, first, diagnosis.candidates, [], faults=(word,))
