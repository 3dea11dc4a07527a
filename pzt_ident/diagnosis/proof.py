"""Which of the effects that were added are proven, and which only take up a part of what nothing explains."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.cost import has_many_amounts
from pzt_ident.diagnosis.criteria import (
    DECISIVE,
    MOST_OF_OTHERS,
    adequate,
    beyond_form,
    form_of_others,
    near_noise,
    reaches_noise,
    removed_rms,
)
from pzt_ident.diagnosis.displaced import displaced_operator
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.limit import (
    curve_of,
    differs_by_record,
    excess_of,
    harmonic_of,
    limit_of,
    own_bounds,
    settle_beyond,
    size_of,
)
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.refit import change_if_too_coarse, refit
from pzt_ident.diagnosis.spectral_line import is_own_line
from pzt_ident.diagnosis.step import effects_without
from pzt_ident.diagnosis.suspect import Suspect
from pzt_ident.diagnosis.ties import TIE, are_look_alikes, strangers
from pzt_ident.model.registry import blocks, word_of

ENOUGH = 3 / 4  # of the misfit as given, of all records together: what the first of several effects must remove
SINGLE = 0.9  # of it, which one effect must remove that is alone
WITHOUT_EQUAL = DECISIVE  # the same where no other effect but its look-alikes explains RIVALS of what it does
RIVALS = 1 / 2
AS_MUCH = 0.9  # of what an effect explains: a look-alike that explains no less than this may as well be meant
OF_MANY = 0.95  # the same of one with many amounts, which take up a part of anything
EACH = 1 / 2  # of that of the identification and of the validation records
ALONE = 1 / 3  # of the misfit beside the others: what each of several must remove that leave no more than they may
SHADED = 1 / 2  # root mean square, of what an effect removes that is something else: less may be its form
BESIDE = DECISIVE  # of the same: the most that is asked of each of several that leave more, in proportion


def unproven(
    case: Case, first: Fit, now: Fit, rivals: Mapping[str, Collection[str]], known: Sequence[Fit] = ()
) -> list[Suspect]:
    """The effects to be taken out again, the least first. known: other fits of the case.

    Each takes up more than the form of the others may leave. Where a model does not reach the noise, effects may stand
    in for what is not in the catalogue: they must also remove together as much of the misfit as given as if the first
    removed ENOUGH of all records (SINGLE, WITHOUT_EQUAL or OF_MANY, if it is alone), or DECISIVE where the
    identification records are at the noise, and EACH of either kind of them, and each of the others half of the rest,
    and each the share ALONE beside the others; of several that leave more than that each must remove more in
    proportion, and none is proven where that is more than BESIDE. None may have rivals that fit as well and are not its
    look-alikes: what any effect takes up is not that of one. And none may have a shape, or all its amounts, on a bound,
    as a cyclic error of one period in a stroke: it stands for what it is like there, unless the model is adequate with
    it. Even then none may be in a limit that is declared to be something else, or beyond what the catalogue expects
    with a shape on a bound, or a low harmonic of the drive, or of another size in each record where it is the device's;
    nor a line of few periods in the stroke unless the model is adequate. Beside an effect that leaves its trace where
    its form is another one each must remove SINGLE, as if it were alone: a gain by the swing beside a memory. A line of
    the spectrum that takes up all of its band is proven whatever is left elsewhere. Nor may one take the place of the
    model's operator, whose loops are gone beside it, unless the model is adequate. What takes up enough and only may be
    something else is a suspect beside which the others are judged: without it what they take up is nothing; of those
    that remove little beside what is in a limit none is proven. What is proven on one of several axes, and clear there,
    is proven, whatever another lacks. What is flexible is proven only where the model is adequate with it, or if it
    removes SINGLE. None is proven by a model that is simulated too coarsely with it.
    """
    judge = partial(taken_out, case, first, now, rivals, known)
    if coarse := simulated_too_coarsely(case, first, now, known):
        return coarse + unproven(case, first, coarse[-1].without, rivals, known)
    suspects, axes = judge(), len(now.problem.model.measured)
    doubted = [item.effect for item in suspects]
    for axis in range(axes) if axes > 1 and suspects else ():
        unsure = {item.effect for item in judge(axis)}
        doubted = [effect for effect in doubted if effect in unsure or not is_clear(case, first, now, effect, axis)]
    if len(doubted) == len(suspects):
        return suspects
    suspects = []
    for effect in doubted:
        suspects.append(suspect(case, first, now, effect, rivals.get(effect, ()), known))
        now = suspects[-1].without
    return suspects


def simulated_too_coarsely(case: Case, first: Fit, now: Fit, known: Sequence[Fit]) -> list[Suspect]:
    """The last effects of a model that is not adequate, as long as its misfit may come from the simulation."""
    found = list[Suspect]()
    while now.effects != first.effects and not adequate(case, first, now) and change_if_too_coarse(case, now):
        found.append(replace(suspect(case, first, now, now.effects[-1], (), known), is_coarse=True))
        now = found[-1].without
    return found


def is_clear(case: Case, first: Fit, now: Fit, effect: str, axis: int) -> bool:
    """Whether an effect takes up more of what is measured on an axis than the form of any other may leave; of many
    amounts, which take up a part of anything, whether it leads to the noise there, too."""
    view, before = case.on_axis(axis), on_axis(refit(case, now, effects_without(now, effect), {}), axis)
    if is_of_many(effect) and not adequate(view, on_axis(first, axis), on_axis(now, axis)):
        return False
    return removed_rms(before.identify, on_axis(now, axis).identify) > MOST_OF_OTHERS * view.floor


def taken_out(
    case: Case,
    first: Fit,
    now: Fit,
    rivals: Mapping[str, Collection[str]],
    known: Sequence[Fit],
    axis: int | None = None,
) -> list[Suspect]:
    """Those that are not proven by the errors of all axes together, or by those of one alone; see `unproven`."""
    seen, view = partial(on_axis, axis=axis), case.on_axis(axis)
    given = seen(first)

    def doubt(now: Fit, effect: str) -> Suspect:
        return suspect(case, first, now, effect, rivals.get(effect, ()), known, axis)

    suspects, held, judged = list[Suspect](), list[str](), list[Suspect]()
    while added := now.effects[len(first.effects) :]:
        near, explained = near_noise(view, given, seen(now)), adequate(view, given, seen(now))
        left = left_of_allowed(view, given, seen(now), added, rivals)
        judged = [doubt(now, item) for item in added if item not in held]
        doubted = [item for item in judged if item.is_doubtful or (item.on_bounds and not explained) or not near]
        suspected = [item for item in doubted if not item.is_line]
        if not suspected:
            break
        least = least_of(case, suspected)
        needed = near or least.share >= least_share(left, len(added))
        alike = (least.on_bounds and not explained) or (least.strangers and not near)
        other = least.limit or least.displaced or alike
        if least.beyond_form and needed and not other:
            break
        if least.beyond_form and needed and not least.displaced:
            held.append(least.effect)
        else:
            suspects.append(least)
            now = least.without
    for effect in [*in_the_shade(now, judged, [doubt(now, item) for item in held]), *held]:
        suspects.append(doubt(now, effect))
        now = suspects[-1].without
    for effect in now.effects[len(first.effects) :] if held else ():
        last = doubt(now, effect)  # beside what was taken out it was on no bound
        if last.on_bounds and not last.is_line and not adequate(view, given, seen(now)):
            suspects.append(last)
            now = last.without
    return suspects


def in_the_shade(now: Fit, judged: Sequence[Suspect], held: Sequence[Suspect]) -> list[str]:
    """The effects that remove less than half as much, root mean square, as one beside them which is declared to be
    something else there: they may be what its form leaves of that."""
    most = max((removed_rms(item.without.total, now.total) for item in held if item.limit), default=0.0)
    small = (item for item in judged if removed_rms(item.without.total, now.total) < SHADED * most)
    return [item.effect for item in small if not item.is_line]


def on_axis(fit: Fit, axis: int | None) -> Fit:
    """A fit with the errors of one measured axis alone, or as it is."""
    if axis is None:
        return fit
    identify, *validate = map(float, fit.by_use[:, axis])
    return replace(fit, identify=identify, validate=validate[0] if validate else None)


def least_of(case: Case, suspected: Sequence[Suspect]) -> Suspect:
    """The first to be taken out: of those without which a model fits as well, the one with most parameters."""
    least = min(suspected, key=lambda item: item.rank)
    equal = [
        item
        for item in suspected
        if item.rank[:-1] == least.rank[:-1]
        and abs(removed_rms(least.without.total, item.without.total)) < 2 * TIE * case.floor
    ]
    return min(equal, key=lambda item: (item.without.freedom, item.rank))


def left_of_allowed(
    case: Case, first: Fit, now: Fit, added: Sequence[str], rivals: Mapping[str, Collection[str]]
) -> float:
    """What a fit leaves of the misfit as given, in multiples of what the effects added may leave: of all records
    together, or of the identification or of the validation records, whichever is more."""
    above = least_of_single(case, first, now, added[0], rivals) if len(added) == 1 else ENOUGH
    one, rest = DECISIVE if reaches_noise(case, first, now) else above, (1 - DECISIVE) ** (len(added) - 1)
    of_all = share_explained(first.total, now.total, case.floor)
    both = [(first.identify, now.identify), (first.validate, now.validate)]
    least = min(share_explained(before, after, case.floor) for before, after in both if before and after)
    return max((1 - of_all) / (1 - one), (1 - least) / (1 - EACH)) / rest


def least_of_single(case: Case, first: Fit, now: Fit, effect: str, rivals: Mapping[str, Collection[str]]) -> float:
    """The share of the misfit as given that an effect which is alone must remove."""
    if is_of_many(effect):
        return OF_MANY
    share = share_explained(first.total, now.total, case.floor)
    return WITHOUT_EQUAL if is_without_equal(case, [effect, *rivals.get(effect, ())], share) else SINGLE


def is_without_equal(case: Case, alike: Sequence[str], share: float) -> bool:
    """Whether an effect, the first of some that are alike here, has no equal in a share of the misfit as given: none
    explains RIVALS of it but what looks like these, or like a look-alike that explains as much, and nothing that
    follows any slow misfit does. One with amounts of its own for each record might follow anything."""
    if not case.shares or is_flexible(alike[0]) or blocks[alike[0]].amounts():
        return False
    as_much = [word for word, explained in case.shares.items() if explained >= AS_MUCH * share]
    names = {*map(word_of, alike), *(word for word in as_much if are_look_alikes(alike[0], word))}
    kin = names | {word for word in case.shares if any(are_look_alikes(name, word) for name in names)}
    others = (explained for word, explained in case.shares.items() if word not in kin or is_flexible(word))
    return max(others, default=0.0) < RIVALS * share


def is_of_many(effect: str) -> bool:
    """Whether an effect has many amounts, as a density of plays."""
    return has_many_amounts(blocks[effect])


def least_share(left: float, effects: int) -> float:
    """The share that each of so many effects must remove beside the others: ALONE where no more is left than allowed,
    in proportion more of several that leave more, as far as BESIDE. Of those that leave still more, and of a single one
    that leaves more than allowed, none suffices."""
    share = ALONE * max(left, 1.0)
    return share if share <= (ALONE if effects == 1 else BESIDE) else np.inf


def suspect(
    case: Case,
    first: Fit,
    now: Fit,
    effect: str,
    rivals: Collection[str],
    known: Sequence[Fit] = (),
    axis: int | None = None,
) -> Suspect:
    """What an effect of a fit takes up beside the others, on all axes or on one, of which a known fit may leave less
    than the refit that the budget suffices for."""
    others_only = effects_without(now, effect)
    fits = [refit(case, now, others_only, {}), *(fit for fit in known if {*fit.effects} == {*others_only})]
    without = min(fits, key=lambda fit: fit.total)
    others, on_bounds = strangers(effect, rivals), own_bounds(now, effect)
    on_bounds = () if on_bounds and settle_beyond(case, now, on_bounds) else on_bounds
    view, (given, before, after) = case.on_axis(axis), (on_axis(fit, axis) for fit in (first, without, now))
    settled = adequate(view, given, after)
    limit = limit_of(now, on_bounds) or excess_of(now, effect, on_bounds)
    limit = limit or harmonic_of(now, effect) or size_of(now, effect)
    limit = limit or ("" if settled else curve_of(now, effect))
    is_line = not limit and is_own_line(case, without, now, effect)
    displaced = "" if settled else displaced_operator(case, first, now, effect)
    validate = of_all = None
    if after.validate is not None and before.validate is not None:
        validate = share_explained(before.validate, after.validate, view.floor)
    identify = share_explained(before.identify, after.identify, view.floor)
    clear = beyond_form(view, given, before, after)
    if validate is not None and differs_by_record(effect):
        of_all = share_explained(before.total, after.total, view.floor)
        clear = removed_rms(before.total, after.total) > form_of_others(view, given.total)
    found = Suspect(effect, identify, validate, without, clear, others, on_bounds, limit, displaced, of_all, is_line)
    bent = is_flexible(effect) and not settled
    little = (bent or is_trace(effect, others_only)) and found.share < SINGLE
    return replace(found, beyond_form=False) if little else found


def is_flexible(effect: str) -> bool:
    """Whether an effect follows a part of any slow misfit, in the records kept back as well."""
    return blocks[effect].flexible


def is_trace(effect: str, others: Collection[str]) -> bool:
    """Whether an effect may be what one of the others leaves whose form is another one."""
    return any(word_of(effect) in blocks[other].leaves for other in others)
