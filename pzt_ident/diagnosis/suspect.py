"""What takes up a part of a misfit and is not proven, with the reason in words."""

from __future__ import annotations

from dataclasses import dataclass

from pzt_ident.data.notation import listed
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.model.registry import phrase_of


@dataclass(frozen=True)
class Suspect:
    """What an effect takes up beside the others: the shares of the misfit on the identification and on the validation
    records (None without any), the fit without it, whether that is more than the form of the others may leave, the
    effects of another kind that fitted as well when it was added, its shapes or all its amounts that ended on a bound,
    what it is there if that is declared, the operator of the model that it takes the place of, and the share of all
    records together where each has its own amount of it: one that has little says nothing against it; whether it is a
    line of the spectrum that takes up all of its band, and whether the steps of the simulation are too long for it."""

    effect: str
    identify: float
    validate: float | None
    without: Fit
    beyond_form: bool = True
    strangers: tuple[str, ...] = ()
    on_bounds: tuple[str, ...] = ()
    limit: str = ""
    displaced: str = ""
    of_all: float | None = None
    is_line: bool = False
    is_coarse: bool = False

    @property
    def rank(self) -> tuple[bool, bool, bool, bool, float]:
        """The order in which effects are taken out."""
        return not self.displaced, self.beyond_form, not self.strangers, not (self.on_bounds or self.limit), self.share

    @property
    def is_doubtful(self) -> bool:
        """Whether it may be less than the form of the others leaves, is something else in its limit, or displaces the
        operator."""
        return bool(self.limit or self.displaced) or not self.beyond_form

    @property
    def share(self) -> float:
        """The smaller of both shares, or that of all records."""
        if self.of_all is not None:
            return self.of_all
        return self.identify if self.validate is None else min(self.identify, self.validate)

    @property
    def why_not(self) -> str:
        """A sentence on why it is not proven."""
        seen = f"{max(self.identify, 0):.0%} of the misfit on the identification records"
        unseen = "" if self.validate is None else f" and {max(self.validate, 0):.0%} on the validation records"
        if self.is_coarse:
            rest = " of a model whose simulation is too coarse with it."
        elif self.beyond_form and self.strangers:
            names = listed(map(phrase_of, self.strangers))
            rest = f" of a model that stays above the noise with it, and {names} fitted as well when it was added."
        elif self.beyond_form and self.displaced:
            rest = (
                f" of a model that stays above the noise with it, where it takes the place of {self.displaced}'s loops."
            )
        elif self.beyond_form and self.limit:
            where = f"{listed(self.on_bounds)} ended at a limit, where the effect" if self.on_bounds else "it"
            rest = f", but {where} is {self.limit}."
        elif self.beyond_form and self.on_bounds:
            rest = f" of a model that stays above the noise with it, and {listed(self.on_bounds)} ended on a bound."
        elif self.beyond_form:
            rest = " of a model that stays above the noise with it: it may stand in for something else."
        else:
            rest = " beside the other effects, no more than their form may leave."
        return f"{phrase_of(self.effect)} takes up {seen}{unseen}".replace("%", " %") + rest
