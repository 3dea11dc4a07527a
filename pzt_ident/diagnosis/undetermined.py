"""Mechanics that the data do not determine, or that do not ring: a suspect like any effect, so the model is tried
without them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import CLEAR, adequate, removed_rms
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.modes import values_of
from pzt_ident.diagnosis.possible import fits
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.starts import restart
from pzt_ident.model.block import Place
from pzt_ident.model.chain import Entry
from pzt_ident.model.modes import Mode, modes_of
from pzt_ident.model.registry import blocks, word_of

SURE = 0.1  # of the search range: a direction of parameters with a smaller standard error is determined
MODE = "resonance"  # the effect that declares how much a mode of a stage is damped at most
OF_A_MODE = 2  # numbers that the data determine of a mode which they show: its frequency and its damping


@dataclass(frozen=True)
class Undetermined:
    """Mechanics that the last model does without: their word, the share of the misfit that they took up, the RMSE in
    noise floors at which the staircase without them ends, and their mode where it does not ring."""

    effect: str
    share: float
    end: float
    mode: Mode | None = None

    @property
    def why_not(self) -> str:
        """A sentence on why the last model does without them."""
        shared = f"{self.effect} takes up {self.share:.0%} of the misfit without it".replace("%", " %")
        reason = "these data determine at most one number of it, where a mode has a frequency and a damping"
        if self.mode:
            where = f"{self.mode.frequency:.3g} Hz with a damping ratio of {self.mode.damping:.2g}"
            reason = f"its mode at {where} rings in no record, and may be a lag"
        return f"{shared}, but {reason}: the model without it ends at {self.end:.3g} noise floors."


def without_mechanics(case: Case, first: Fit) -> tuple[str, Case, Fit] | None:
    """The word of the mechanics, the case without them and its fit, where the data do not show the mechanics and the
    model is clearly worse without them; None elsewhere."""
    return clearly_worse_without(case, first, unseen_mechanics(first))


def clearly_worse_without(case: Case, fit: Fit, word: str | None) -> tuple[str, Case, Fit] | None:
    """The word of mechanics, the case without them and its fit, if that is clearly worse; None elsewhere."""
    lean = without(case, word) if word else None
    if word is None or lean is None or not all(fits(lean, (), effect) for effect in fit.effects):
        return None
    worse = restart(lean, refit(lean, fit, fit.effects, {}))
    return (word, lean, worse) if removed_rms(worse.total, fit.total) > CLEAR * case.floor else None


def enough_without_mechanics(case: Case, first: Fit) -> tuple[str, Case, Fit] | None:
    """The word of the mechanics, all of them free, the case without them and its fit, where that is at the noise and
    the model with them is not: their bounds do not reach to mechanics as stiff as these."""
    entries = mechanics_of(first)
    word = next((entry.block.name for entry in entries.values()), "")
    lean = without(case, word) if entries.keys() <= {*first.problem.free} else None
    if lean is None:
        return None
    fit = refit(lean, first, first.effects, {})
    return (word, lean, fit) if adequate(lean, fit, fit) else None


def without(case: Case, word: str) -> Case | None:
    """The case without a block; None where nothing makes a response of the drive then, or an effect acts in it."""
    lean = case.with_words([item for item in case.words if word_of(item) != word])
    return lean if has_operator(lean) and all(fits(lean, (), effect) for effect in case.effects) else None


def undetermined_mechanics(fit: Fit) -> str | None:
    """The word of the mechanics, if the data determine them on no axis."""
    axes = {entry.axis for entry in mechanics_of(fit).values()}
    return word_of_mechanics(fit) if undetermined_axes(fit) == axes else None


def unseen_mechanics(fit: Fit) -> str | None:
    """The word of mechanics that the data do not determine, or that ring in no record."""
    return undetermined_mechanics(fit) or (word_of_mechanics(fit) if mode_that_is_silent(fit) else None)


def word_of_mechanics(fit: Fit) -> str | None:
    """The word of the mechanics; None without any."""
    return next((entry.block.name for entry in mechanics_of(fit).values()), None)


def mode_that_is_silent(fit: Fit) -> Mode | None:
    """The least damped mode of the mechanics where all of their parameters are free and none of their modes rings in
    any record: each is damped more than any mode of a stage, or above half of all sampling rates. None elsewhere."""
    most, rate = blocks[MODE].parameters()["damping"].bounds[1], max(1 / record.dt for record in fit.problem.records)
    modes = modes_of(fit.problem.model, values_of(fit))
    free = mechanics_of(fit).keys() <= {*fit.problem.free}
    if not free or any(mode.damping <= most and 2 * mode.frequency < rate for mode in modes):
        return None
    return min(modes, key=lambda mode: mode.damping, default=None)


def undetermined_axes(fit: Fit) -> set[int]:
    """The axes on which all parameters of the mechanics are free, and the data determine at most one number of them."""
    entries, places = mechanics_of(fit), {column: place for place, column in enumerate(fit.problem.free)}
    fixed = {entry.axis for column, entry in entries.items() if column not in places}
    free = {entry.axis for entry in entries.values()} - fixed
    if not free:
        return set()
    own = {axis: [places[column] for column, entry in entries.items() if entry.axis == axis] for axis in free}
    variances = {axis: np.linalg.eigvalsh(fit.covariance[np.ix_(rows, rows)]) for axis, rows in own.items()}
    return {axis for axis, values in variances.items() if np.count_nonzero(values < SURE**2) < OF_A_MODE}


def mechanics_of(fit: Fit) -> dict[int, Entry]:
    """The parameters of the mechanics themselves, by their columns."""
    entries = dict(enumerate(fit.problem.model.entries))
    return {
        column: entry
        for column, entry in entries.items()
        if entry.block.place == Place.MECHANICS and not entry.parameter.effects
    }


def has_operator(case: Case) -> bool:
    """Whether the model has a block that makes a response of the drive."""
    return any(block.place == Place.OPERATOR for block in blocks.chain(case.words))
