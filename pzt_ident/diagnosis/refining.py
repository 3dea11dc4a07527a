"""Effects with which the operator of a model is no more than finer: what they take up is no effect of the stage."""

from __future__ import annotations

from pzt_ident.diagnosis.fit import Fit
from pzt_ident.model.registry import blocks, phrase_of


def refined_operator(fit: Fit, effect: str) -> str:
    """The operator of the model of a fit that an effect refines; empty where there is none."""
    return next((block.name for block in fit.problem.model.blocks if block.name in blocks[effect].refines), "")


def refining_sentence(fit: Fit) -> str:
    """A sentence on each effect of a fit that refines its operator."""
    refined = {effect: refined_operator(fit, effect) for effect in fit.effects}
    return "".join(
        f" {phrase_of(effect)} makes {operator} finer, and is no effect of the stage."
        for effect, operator in refined.items()
        if operator
    )
