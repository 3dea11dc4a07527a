"""When two fits are one on these data: ties, look-alikes, and effects in the limit in which they are others."""

from __future__ import annotations

from collections.abc import Collection

from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import CLEAR, removed_rms
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.model.block import Place
from pzt_ident.model.registry import blocks, form_of, word_of

TIE = 0.2  # noise floors between two refits: less does not distinguish them; of look-alikes twice that
TWIN = 1e-3  # noise floors: two models that fit as closely are one on these data
LOOK_ALIKE_TIE = 0.01  # of the total RMSE: less does not distinguish refits of look-alikes far above the noise
LIMIT_TIE = 0.1  # of the total RMSE, by which a look-alike may be worse than an effect that rests on its own bounds


def are_look_alikes(one: str, other: str) -> bool:
    """Whether one of two effects counts the other among its look-alikes."""
    return word_of(one) in blocks[other].look_alikes or word_of(other) in blocks[one].look_alikes


def differ(one: float, other: float, floor: float) -> bool:
    """Whether two errors differ by more than the noise leaves open."""
    return abs(one**2 - other**2) ** 0.5 > TIE * floor


def at_noise(case: Case, fit: Fit) -> bool:
    """Whether what a fit leaves above the noise would not distinguish two look-alikes."""
    return removed_rms(fit.total, case.floor) < 2 * TIE * case.floor


def is_tied(case: Case, effect: str, fit: Fit, rival: Fit) -> bool:
    """Whether a fit with a look-alike in the place of an effect is hardly worse, or only on the records kept back, and
    less so than either is off there."""
    equal = is_equal(case, fit, rival) or is_equal_where_fitted(case, fit, rival)
    return equal and are_look_alikes(effect, rival.effects[-1])


def is_twin(case: Case, effect: str, forms: Collection[Fit], rival: Fit) -> bool:
    """Whether a fit with a look-alike in the place of an effect is that with another form of the effect, which does not
    contain the look-alike: a form that this does not have tells nothing between them."""
    word = word_of(rival.effects[-1])
    own = [fit for fit in forms if word not in blocks[fit.effects[-1]].contains]
    twin = any(abs(fit.total - rival.total) < TWIN * case.floor for fit in own)
    return twin and are_look_alikes(effect, rival.effects[-1])


def is_equal(case: Case, fit: Fit, rival: Fit) -> bool:
    """Whether a rival is hardly worse than a fit."""
    close = removed_rms(rival.total, fit.total) < 2 * TIE * case.floor
    return close or rival.total < (1 + LOOK_ALIKE_TIE) * fit.total


def is_equal_where_fitted(case: Case, fit: Fit, rival: Fit) -> bool:
    """Whether a rival is hardly worse on the identification records, and by less on the others than what a fit itself
    leaves there above the noise, and clearly does: what these show that the former do not tells of neither."""
    if fit.validate is None or rival.validate is None:
        return False
    close = removed_rms(rival.identify, fit.identify) < 2 * TIE * case.floor
    left, worse = removed_rms(fit.validate, case.floor), removed_rms(rival.validate, fit.validate)
    return close and left > CLEAR * case.floor and worse < left


def strangers(effect: str, rivals: Collection[str]) -> tuple[str, ...]:
    """The rivals of an effect that are neither a form of it nor a look-alike."""
    return tuple(item for item in rivals if word_of(item) != word_of(effect) and not are_look_alikes(effect, item))


def rests_on_own_bounds(before: Fit, fit: Fit) -> bool:
    """Whether a parameter that an effect brought along ended on a bound: the effect may be the limit in which it is
    another one, as friction that is smoothed over all speeds is a lag."""
    return bool(set(fit.on_bounds) - set(before.problem.names))


def nearness_of(effect: str) -> int:
    """How near to the reading an effect acts in its first form, which says what it is, or that of which it is the
    equation; one in the equation of an operator or of mechanics is between what acts on the drive and what acts on the
    displacement."""
    return getattr(blocks[word_of(blocks[effect].equation_of or effect)], "place", Place.OPERATOR)


def is_better(case: Case, fit: Fit, rival: Fit) -> bool:
    """Whether a rival leaves less by half of what is a tie: what it has more of may be needed."""
    return removed_rms(fit.total, rival.total) > TIE / 2 * case.floor


def generalises(rival: Fit, fit: Fit) -> bool:
    """Whether a rival fits in a form of more parameters than its first, which contains the other effect or a look-alike
    of it, or may: with one more for each axis a filter of second order is no delay."""
    own = word_of(fit.effects[-1])
    contains = any(item == own or are_look_alikes(item, own) for item in blocks[rival.effects[-1]].contains)
    most = 0 if contains else max(1, len(fit.problem.model.measured))
    return form_of(rival.effects[-1]) is not None and rival.freedom - fit.freedom > most
