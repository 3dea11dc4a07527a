"""The scores of all effects that may be missing, in their forms, and what promises most."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

from pzt_ident.diagnosis.budget import EXPLORING, PROVING, WHOLE
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import DECISIVE, adequate
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.forms import NEARLY_ALL, Candidate
from pzt_ident.diagnosis.possible import applicable
from pzt_ident.diagnosis.refit import refit_from
from pzt_ident.diagnosis.score import Scorer, scorer_of
from pzt_ident.diagnosis.threads import side_by_side
from pzt_ident.diagnosis.ties import are_look_alikes
from pzt_ident.model.registry import word_of

PROMISING = 0.6  # of the misfit: what an effect explains by its score, so that it is tried ahead of anything else


def score_all(case: Case, first: Fit, before: Fit, scorer: Scorer, in_every_form: bool = True) -> list[Candidate]:
    """Every effect that can be added to the model, with the scores of its forms; beside the model as given all of them,
    beside other effects those that the budget suffices for, of other forms while it is for exploring: what scores best
    is still to be refitted. Of an adequate model the first forms: what they are far from, no other form shows. Where
    the first form of an effect explains nearly all, other forms of it and of its look-alikes only."""
    words, candidates = applicable(case, before.effects), dict[str, Candidate]()

    def scored(some: Sequence[str], share: float, in_every_form: bool) -> Iterator[str]:
        scores_of = partial(scorer.scores, in_every_form=in_every_form)
        allowed = (each for each in some if before is first or case.budget.allows("the scores of all effects", share))
        for scores in side_by_side(scores_of, allowed):
            candidates[word_of(scores[0].effect)] = Candidate.of(scores)
            yield word_of(scores[0].effect)

    for done, word in enumerate(scored(words, PROVING if adequate(case, first, before) else WHOLE, False), 1):
        facts = {"effect": word, "explained": candidates[word].score.explained}
        case.on_event({"event": "scored", **facts, "done": done, "of": len(words)})
    if in_every_form and (before is first or not adequate(case, first, before)):
        list(scored(worth_other_forms(candidates), EXPLORING, True))
    return list(candidates.values())


def worth_other_forms(candidates: Mapping[str, Candidate]) -> list[str]:
    """Words of the effects of which other forms may change what is found, those that explain most first."""
    words = sorted(candidates, key=lambda word: -candidates[word].score.explained_in_bounds)
    if not words or candidates[words[0]].score.explained_in_bounds < NEARLY_ALL:
        return words
    return [word for word in words if word == words[0] or are_look_alikes(words[0], word)]


def promises_most(case: Case, first: Fit, fit: Fit, least: float = PROMISING) -> str:
    """The effect that explains most of what a fit leaves by its score, in its first form, at least such a share, unless
    it is a look-alike of one that was added: it may belong in the place of that. Empty where there is none."""
    candidates = score_all(case, first, fit, scorer_of(case, fit), in_every_form=False)
    scores = [item.score for item in candidates if item.score.explained_in_bounds >= least]
    best = max(scores, key=lambda score: score.explained_in_bounds, default=None)
    added = fit.effects[len(first.effects) :]
    return "" if best is None or any(are_look_alikes(effect, best.effect) for effect in added) else best.effect


def likeliest(case: Case, first: Fit) -> Fit | None:
    """The model as given with the effect that explains most by its score, in its first form; None where none explains
    most."""
    scores = [item.score for item in score_all(case, first, first, scorer_of(case, first), in_every_form=False)]
    best = max(scores, key=lambda score: score.explained_in_bounds, default=None)
    if best is None or best.explained_in_bounds < DECISIVE:
        return None
    return refit_from(case, first, (*first.effects, best.effect), best.guesses)
