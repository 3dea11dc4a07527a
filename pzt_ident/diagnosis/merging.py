"""Two effects that make up for one, which explains as much in their place."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from pzt_ident.diagnosis.budget import PROVING
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import adequate, removed_rms
from pzt_ident.diagnosis.exchange import exchange_step
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.forms import Candidate
from pzt_ident.diagnosis.limit import is_limited
from pzt_ident.diagnosis.possible import applicable
from pzt_ident.diagnosis.refit import refit, refit_beside
from pzt_ident.diagnosis.score import scorer_of
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.step import Step, effects_without, explained_share
from pzt_ident.diagnosis.ties import TIE
from pzt_ident.model.registry import blocks, word_of

FEWEST = 3  # effects of which two may make up for one: of two, one alone was tried in every form at first
NEARLY_ALL = 0.9  # of what two effects explain: what one explains by its score that may be in their place
MOST = 2  # effects that are refitted in the place of two


def merge_effects(case: Case, first: Fit, now: Fit) -> list[Step]:
    """The steps from an adequate model of several effects that take out two of them and put one in their place, where
    the model is as good so."""
    added = now.effects[len(first.effects) :]
    if len(added) < FEWEST or not adequate(case, first, now):
        return []
    for pair in combinations(reversed(added), 2):
        if not case.budget.allows("one effect in the place of two", PROVING):
            return []
        without = refit(case, now, tuple(effect for effect in now.effects if effect not in pair), {})
        for alone in in_place_of_two(case, now, without, pair):
            as_good = removed_rms(alone.total, now.total) < TIE * case.floor
            if as_good and adequate(case, first, alone) and not is_limited(alone):
                single = refit(case, now, effects_without(now, pair[0]), {})
                taken_out = Step(single, None, pair[0], {}, explained_share(case, now, single))
                return [taken_out, exchange_step(case, single, alone, pair[1])]
    return []


def in_place_of_two(case: Case, now: Fit, without: Fit, pair: tuple[str, str]) -> Iterator[Fit]:
    """The model refitted with each of the effects that explain most beside the others, in the place of two; from random
    points, too, where it rests on bounds: two effects may make up for a side minimum."""
    scorer = scorer_of(case, without)
    words = [word for word in applicable(case, without.effects) if word not in map(word_of, pair)]
    best = [Candidate.of(scorer.scores(word)).score for word in words]
    for score in sorted(best, key=lambda score: -score.explained)[:MOST]:
        if score.explained < NEARLY_ALL:
            return
        effects = (*without.effects, score.effect)
        alone = refit_beside(case, (without, now), effects, score.guess, now.identify)
        yield alone
        if alone.on_bounds and not blocks[score.effect].amounts() and case.budget.allows("other starts", PROVING):
            yield first_fit(case, 0, effects=effects, rival=now.identify)
