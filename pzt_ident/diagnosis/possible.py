"""What a model may miss: the effects, and the forms of them, that can act in it."""

from __future__ import annotations

from pzt_ident.diagnosis.case import Case
from pzt_ident.model.block import Coupling, Term
from pzt_ident.model.registry import blocks, word_of

NO_TERM = "no block of this model has a term for such an effect, and `pzt-ident show` tells which have"


def applicable(case: Case, effects: tuple[str, ...], in_setup: bool = False) -> list[str]:
    """The effects of the stage that can be added to this model, which has `effects`, or the faults of its set-up."""
    present = (*map(word_of, effects), *case.ruled_out)
    words = (word for word in blocks.effects() if blocks[word].in_setup == in_setup)
    return [word for word in words if word not in present and fitting_forms(case, effects, word)]


def out_of_place(case: Case) -> dict[str, list[str]]:
    """The effects of which no form can act in this model, by the reason."""
    found: dict[str, list[str]] = {NO_TERM: [], "there is no second axis": []}
    reasons = [*found]
    for word in blocks.effects():
        forms = [blocks[item] for item in blocks.forms(word)]
        if word not in (*map(word_of, case.effects), *case.ruled_out) and not fitting_forms(case, case.effects, word):
            found[reasons[any(issubclass(form, Coupling) for form in forms)]].append(word)
    return {reason: words for reason, words in found.items() if words}


def fitting_forms(case: Case, effects: tuple[str, ...], word: str) -> list[str]:
    """The items of the forms of an effect that can act in the model with `effects`, in the order of the declaration; of
    those that are one there, as in a block that has the effect in one form only, the first."""
    forms: dict[object, str] = {}
    for item in blocks.forms(word):
        if fits(case, effects, item):
            forms.setdefault(held_by(case, effects, item), item)
    return list(forms.values())


def held_by(case: Case, effects: tuple[str, ...], item: str) -> object:
    """What tells a form from others: in the equations of blocks, their parameters and their own forms with it."""
    if not issubclass(blocks[item], Term):
        return item
    names, chain = {word_of(item), item}, blocks.chain((*case.words, *effects))
    declared = (
        (block, word) for block in chain for word, item in block.parameters().items() if names & {*item.effects}
    )
    return frozenset((*declared, *((block, name) for block in chain for name in names if name in block.forms)))


def fits(case: Case, effects: tuple[str, ...], item: str) -> bool:
    """Whether the model with `effects` has what a form of an effect acts in: a block with the term, a second axis, a
    block that it is ahead of, the mechanics that it asks."""
    form, chain = blocks[item], blocks.chain((*case.words, *effects))
    if issubclass(form, Term):
        return any(block.holds(form) for block in chain)
    if form.ahead_of is not None and form.ahead_of not in {getattr(block, "place", None) for block in chain}:
        return False
    if not issubclass(form, Coupling):
        return True
    return len(case.records[0].axes) > 1 and not form.lacks_mechanics(chain)
