"""Which of the effects that were added are proven, and which only take up a part of what nothing explains."""

from __future__ import annotations

from dataclasses import dataclass

from pzt_ident.diagnosis.criteria import near_noise
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.refit import Case, Fit, refit
from pzt_ident.model.registry import phrase_of

JOINT = 2 / 3  # of the misfit of the model as given: what all that is added must remove together
ALONE = 1 / 3  # of the misfit without it: what each must remove beside the others


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
    def why_not(self) -> str:
        """A sentence on why it is not proven."""
        seen = f"{self.identify:.0%} of the misfit on the identification records"
        unseen = "" if self.validate is None else f" and {max(self.validate, 0):.0%} on the validation records"
        sentence = f"{phrase_of(self.effect)} takes up {seen}{unseen} of a model that stays above the noise with it"
        return sentence.replace("%", " %") + ": it may stand in for something else."


def unproven(case: Case, first: Fit, now: Fit) -> list[Suspect]:
    """The effects to be taken out again, the least first.

    Where a model reaches the noise, what it has is needed. Where it does not, effects may stand in for what is not in
    the catalogue: together they must remove the share JOINT of the misfit as given, and each beside the others the
    share ALONE, on the identification and on the validation records.
    """
    suspects: list[Suspect] = []
    while (added := now.effects[len(first.effects) :]) and not near_noise(case, first, now):
        least = min((suspect(case, now, effect) for effect in added), key=lambda item: item.share)
        if least.share >= ALONE and removed_by_all(case, first, now) >= JOINT:
            break
        suspects.append(least)
        now = least.without
    return suspects


def removed_by_all(case: Case, first: Fit, now: Fit) -> float:
    """Share of the misfit as given that a fit removes, the smaller one of both kinds of records."""
    both = [(first.identify, now.identify), (first.validate, now.validate)]
    return min(share_explained(before, after, case.floor) for before, after in both if before and after)


def suspect(case: Case, now: Fit, effect: str) -> Suspect:
    """What an effect of a fit takes up beside the others."""
    without = refit(case, now, tuple(item for item in now.effects if item != effect), {})
    validate = None
    if now.validate is not None and without.validate is not None:
        validate = share_explained(without.validate, now.validate, case.floor)
    return Suspect(effect, share_explained(without.identify, now.identify, case.floor), validate, without)
