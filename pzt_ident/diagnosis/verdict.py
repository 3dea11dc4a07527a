"""What the refits of the short list say: missing, a tie, nothing, or something that no effect explains."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from pzt_ident.diagnosis.refit import Case, Fit, elsewhere, refit, step_errors
from pzt_ident.diagnosis.score import Score, Scorer, applicable, misfit
from pzt_ident.diagnosis.wording import percent
from pzt_ident.model.registry import blocks

SHORT = 5  # effects that are refitted
LEAST = 0.02  # of the misfit: what scores less is not refitted
CLEAR = 0.6  # noise floors: an effect removes at least this much, root mean square
SHARE = 0.15  # and at least this much of the misfit
TIED = 0.2  # noise floors between two refits: less than that, these data cannot tell; of look-alikes twice that
CLOSE = 0.01  # of what is left: as close are two refits of look-alikes where that is far above the noise
HELD = 3.0  # times as much may be left of the records that the fit never saw
FORM = 0.03  # of the misfit at first: less is as likely the form of the effects found as another effect
COARSE = 0.6  # of what is left: if halving the step of the simulation changes more, it is mostly the step's fault
DOUBTED = 8  # starts of a look-alike's own parameters
VISIBLE = 0.3  # noise floors that the strongest plausible effect would leave


@dataclass
class Candidate:
    score: Score
    fit: Fit | None = None
    decision: str = "not missing"


@dataclass
class Diagnosis:
    """verdict and reason, candidates best first, and which of them these data cannot tell from the best."""

    verdict: str
    reason: str
    before: Fit
    candidates: list[Candidate]
    tied: list[str]
    passing: list[Candidate] = field(default_factory=list)

    @property
    def best(self) -> Candidate | None:
        return next((item for item in self.candidates if item.decision == "missing"), None)


def drop(before: float | None, after: float | None) -> float:
    """What an effect removes, root mean square, negative where the error grew; infinite without records."""
    if before is None or after is None:
        return np.inf
    return float(np.sign(before - after) * np.sqrt(abs(before**2 - after**2)))


def least(case: Case, first: Fit) -> float:
    """What an effect must remove at least, root mean square, SI units; a model that leaves no more above the noise is
    adequate. `first` is the model before anything was added."""
    return max(CLEAR * case.floor, FORM * misfit(case, first) ** 0.5)


def earns(case: Case, first: Fit, before: Fit, after: Fit) -> bool:
    """Whether an effect removes enough, of the identify records and of those that the fit never saw; where these show
    nothing of it, it must explain all."""
    gone = drop(before.identify, after.identify)
    enough = least(case, first)
    seen = drop(before.validate, after.validate) > enough / 2 or unseen(case, first, before, after)
    return gone > enough and gone**2 > SHARE * misfit(case, before) and seen


def unseen(case: Case, first: Fit, before: Fit, after: Fit) -> bool:
    """Whether an effect explains all that is left, and the records that the fit never saw are at the noise with it and
    without."""
    noise = np.hypot(case.floor, least(case, first))
    return all(error is not None and error <= noise for error in (before.validate, after.validate, after.identify))


def adequate(case: Case, first: Fit, fit: Fit) -> bool:
    return reaches(case, first, fit) and bool(
        fit.validate is None or fit.validate <= np.hypot(case.floor, HELD * least(case, first))
    )


def reaches(case: Case, first: Fit, fit: Fit) -> bool:
    """Whether a fit comes down to the noise of the records that it was fitted to."""
    return bool(fit.identify <= np.hypot(case.floor, least(case, first)))


def diagnose(case: Case, before: Fit, first: Fit | None = None) -> Diagnosis:
    """Score every effect, refit the short list, judge; `first` as for `least`, by default the model itself."""
    first = first or before
    if refusal := faulty(case, first, before):
        return Diagnosis("refused", refusal, before, [], [])
    scorer = Scorer(case, before)
    candidates = sorted(map(Candidate, scored(case, before, scorer)), key=lambda item: -item.score.explained)
    if adequate(case, first, before) and not any(_worth(case, first, before, item) for item in candidates):
        settle(case, first, before, candidates)
        return nothing(case, first, before, candidates)
    shortlist = [item for item in candidates if item.score.explained > LEAST][:SHORT]
    refits(case, before, shortlist)
    doubted(case, first, before, shortlist)
    candidates.sort(key=lambda item: (item.fit.total if item.fit else np.inf, -item.score.explained))
    settle(case, first, before, candidates)
    passing = [item for item in shortlist if item.fit and earns(case, first, before, item.fit)]
    if not passing:
        return nothing(case, first, before, candidates)
    best = min(passing, key=lambda item: item.fit.total)  # type: ignore[union-attr]
    tied = [item for item in passing if drop(item.fit.total, best.fit.total) < TIED * case.floor]  # type: ignore[union-attr]
    best = min(tied, key=lambda item: (item.fit.problem.dimensions, item.fit.total))  # type: ignore[union-attr]
    tied = [item for item in passing if item in tied or alike(case, best.score.effect, best.fit, item.fit)]  # type: ignore[arg-type]
    for item in tied:
        item.decision = "missing"
    candidates.sort(key=lambda item: (item is not best, item.fit.total if item.fit else np.inf))
    words = [best.score.effect, *(item.score.effect for item in tied if item is not best)]
    verdict = "missing" if len(words) == 1 else "inconclusive"
    rest = sorted((item for item in passing if item not in tied), key=lambda item: item.fit.total)  # type: ignore[union-attr]
    return Diagnosis(verdict, sentence(case, first, before, best, words), before, candidates, words, [best, *rest])


def faulty(case: Case, first: Fit, fit: Fit) -> str:
    """Why what a fit leaves may not be blamed on the model; empty where it may."""
    if adequate(case, first, fit):
        return ""
    if not fit.converged:
        return "Two starts of the fit do not agree: what is left may be the search's fault. Narrow the bounds."
    coarse = float(np.sqrt(np.mean(np.square(step_errors(case, fit)))))
    if coarse <= COARSE * misfit(case, fit) ** 0.5:
        return ""
    return (
        f"What is left, an RMSE of {fit.identify / case.floor:.1f} noise floors, may be the simulation's fault: halving"
        f" its step changes the response by {coarse / case.floor:.1f} of them. Sample faster, or drive slower."
    )


def scored(case: Case, before: Fit, scorer: Scorer) -> list[Score]:
    """Every effect that the model could have more."""
    words, found = applicable(case, before.effects), list[Score]()
    with ThreadPoolExecutor(2) as pool:
        for score in pool.map(scorer.score, words):
            found.append(score)
            facts = {"effect": score.effect, "explained": score.explained}
            case.tell({"event": "scored", **facts, "done": len(found), "of": len(words)})
    return found


def related(one: str, other: str) -> bool:
    """Whether one of two effects counts the other among its look-alikes."""
    return one in blocks[other].look_alikes or other in blocks[one].look_alikes


def alike(case: Case, effect: str, fit: Fit, rival: Fit) -> bool:
    """Whether a fit with a look-alike in the place of an effect leaves hardly more."""
    close = drop(rival.total, fit.total) < 2 * TIED * case.floor or rival.total < (1 + CLOSE) * fit.total
    return close and related(effect, rival.effects[-1])


def _worth(case: Case, first: Fit, before: Fit, item: Candidate) -> bool:
    """Whether the score promises more than what counts as an effect."""
    return item.score.explained * misfit(case, before) > least(case, first) ** 2


def refits(case: Case, before: Fit, items: list[Candidate]) -> None:
    def one(item: Candidate) -> Fit:
        return refit(case, before, (*before.effects, item.score.effect), item.score.guess)

    with ThreadPoolExecutor(2) as pool:
        for item, fit in zip(items, pool.map(one, items), strict=True):
            item.fit = fit


def doubted(case: Case, first: Fit, before: Fit, items: list[Candidate]) -> None:
    """Fit look-alikes of the best that leave hardly more of the records to identify, but more of the others, from
    elsewhere: with several parameters they may have come to rest in a side minimum."""
    passing = [item for item in items if item.fit and earns(case, first, before, item.fit)]
    best = min(passing, key=lambda item: item.fit.total, default=None)  # type: ignore[union-attr]
    if best is None or best.fit is None:
        return
    for item in items:
        one, other = item.score.effect, best.score.effect
        close = item.fit and drop(item.fit.identify, best.fit.identify) < 2 * TIED * case.floor
        if item.fit and close and related(one, other) and len(item.score.guess) > 1:
            item.fit = elsewhere(item.fit, one, DOUBTED)


def settle(case: Case, first: Fit, before: Fit, candidates: list[Candidate]) -> None:
    """What is decided without a refit."""
    for item in candidates:
        if item.score.power < VISIBLE:
            item.decision = "cannot be seen"
        elif item.fit is None and item.score.explained > LEAST and not _worth(case, first, before, item):
            item.decision = "too small"


def nothing(case: Case, first: Fit, before: Fit, candidates: list[Candidate]) -> Diagnosis:
    """No effect earns its place: the model is at the noise, or what is left is unexplained."""
    left = leaves(case, before)
    if adequate(case, first, before):
        said = f"The model is adequate: it leaves {left}.{form(case, first, before)}"
        return Diagnosis("adequate", said, before, candidates, [])
    if before.validate is not None and reaches(case, first, before):
        said = (
            f"The model leaves {left}: these show something that the others do not, or do not determine. Give a record"
            " of their kind `use: identify`."
        )
    else:
        said = f"No effect of the catalogue explains what is left, an RMSE of {left}."
    return Diagnosis("unexplained", said + fitted_only(case, first, before, candidates), before, candidates, [])


def leaves(case: Case, fit: Fit) -> str:
    """`1.02 noise floors on the records to identify and 1.05 noise floors on those to validate`."""
    own = f"{fit.identify / case.floor:.2f} noise floors"
    if fit.validate is None:
        return own
    return f"{own} on the records to identify and {fit.validate / case.floor:.2f} noise floors on those to validate"


def form(case: Case, first: Fit, fit: Fit) -> str:
    """A sentence where more is left than noise, but so little of what there was that another effect cannot be told from
    the form of those found."""
    if max(fit.identify, fit.validate or 0.0) <= np.hypot(1, HELD * CLEAR) * case.floor:
        return ""
    share = percent(misfit(case, fit) / misfit(case, first))
    return (
        f" That is above the noise, but {share} of the misfit at first: as likely the form of what was found as more."
    )


def fitted_only(case: Case, first: Fit, before: Fit, candidates: list[Candidate]) -> str:
    """A sentence about an effect that would explain the records to identify alone."""
    tried = [(item.score.effect, item.fit) for item in candidates if item.fit and item.fit.validate is not None]
    word, fit = min(tried, key=lambda pair: pair[1].identify, default=("", None))
    if fit is None or before.validate is None or fit.validate is None:
        return ""
    gone, unseen = drop(before.identify, fit.identify), drop(before.validate, fit.validate)
    if gone**2 <= SHARE * misfit(case, before) or gone <= least(case, first) or unseen > least(case, first) / 2:
        return ""
    share = percent(gone**2 / misfit(case, before))
    floors = f"{before.validate / case.floor:.2f} to {fit.validate / case.floor:.2f} noise floors"
    return f" {word} would take {share} of it from the records to identify; those to validate go from {floors}."


def sentence(case: Case, first: Fit, before: Fit, best: Candidate, words: list[str]) -> str:
    assert best.fit is not None
    share = percent(drop(before.identify, best.fit.identify) ** 2 / misfit(case, before))
    floors = f"{before.identify / case.floor:.1f} to {best.fit.identify / case.floor:.1f} noise floors"
    said = f"it explains {share} of the misfit; the RMSE falls from {floors}."
    if unseen(case, first, before, best.fit):
        said += " The records to validate show nothing of it, so only those that it was fitted to speak for it."
    if not adequate(case, first, best.fit):
        said += " More than that is missing, or it stands in for something else: `pzt-ident improve` follows it up."
    if len(words) == 1:
        return f"Missing: {words[0]}. {said[0].upper()}{said[1:]}"
    return f"{' or '.join(words)}: these data cannot tell them apart. Take {words[0]}: {said}"


def pair(case: Case, first: Fit, before: Fit, candidates: list[Candidate]) -> Fit | None:
    """Two effects that hide each other: of the pairs of the short list the one whose refit is best, if it earns."""
    words = [item for item in candidates if item.score.explained > LEAST][:3]
    tries = [
        refit(case, before, (*before.effects, a.score.effect, b.score.effect), a.score.guess | b.score.guess)
        for a, b in combinations(words, 2)
    ]
    good = [fit for fit in tries if earns(case, first, before, fit)]
    return min(good, key=lambda fit: fit.total, default=None)
