"""Which of the effects that were added are proven, and which only take up a part of what nothing explains."""

from __future__ import annotations

from dataclasses import dataclass

from pzt_ident.diagnosis.criteria import DECISIVE, near_noise
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.refit import Case, Fit, refit
from pzt_ident.model.registry import phrase_of

PROVEN = 2 / 3  # of the misfit of the model without it, on one kind of records, and DECISIVE on the other


@dataclass(frozen=True)
class Suspect:
    """An effect that is not proven: the shares of the misfit that it takes up beside the others, on the identification
    and on the validation records (None without any), and the fit without it."""

    effect: str
    identify: float
    validate: float | None
    without: Fit

    @property
    def share(self) -> float:
        """The smaller of both shares."""
        return self.identify if self.validate is None else min(self.identify, self.validate)

    @property
    def proven(self) -> bool:
        """Whether it removes most of the misfit that there is without it, on all records."""
        most = max(self.identify, self.identify if self.validate is None else self.validate)
        return self.share >= DECISIVE and most >= PROVEN

    @property
    def why_not(self) -> str:
        """A sentence on why it is not proven."""
        seen = f"{self.identify:.0%} of the misfit on the identification records"
        unseen = "" if self.validate is None else f" and {max(self.validate, 0):.0%} on the validation records"
        sentence = f"{phrase_of(self.effect)} takes up {seen}{unseen} of a model that stays above the noise with it"
        return sentence.replace("%", " %") + ": it may stand in for something else."


def unproven(case: Case, first: Fit, now: Fit) -> list[Suspect]:
    """The effects to be taken out again, the least first, so that all that remain are decisive beside each other.

    Where a model reaches the noise, what it has is needed. Where it does not, an effect may stand in for what is not
    in the catalogue, and must remove most of the misfit.
    """
    suspects: list[Suspect] = []
    while not near_noise(case, first, now):
        found = [suspect(case, now, effect) for effect in now.effects[len(first.effects) :]]
        doubted = [item for item in found if not item.proven]
        if not doubted:
            break
        suspects.append(min(doubted, key=lambda item: item.share))
        now = suspects[-1].without
    return suspects


def suspect(case: Case, now: Fit, effect: str) -> Suspect:
    """What an effect of a fit takes up beside the others."""
    without = refit(case, now, tuple(item for item in now.effects if item != effect), {})
    validate = None
    if now.validate is not None and without.validate is not None:
        validate = share_explained(without.validate, now.validate, case.floor)
    return Suspect(effect, share_explained(without.identify, now.identify, case.floor), validate, without)
