"""More plays beside plays are a finer operator, and no effect of the stage."""

from types import SimpleNamespace

import pytest

import stage
from pzt_ident.diagnosis.refining import refined_operator, refining_sentence
from pzt_ident.diagnosis.staircase import improve
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.model.block import Place
from pzt_ident.model.registry import blocks, word_of
from pzt_ident.run.findings import improvement_of

REFINING = [item for word in blocks.effects() for item in blocks.forms(word) if blocks[item].refines]


def fit_of(*words, effects=()):
    chain = [blocks[word] for word in words]
    return SimpleNamespace(problem=SimpleNamespace(model=SimpleNamespace(blocks=chain)), effects=effects)


@pytest.mark.parametrize("item", REFINING)
def test_what_refines_an_operator_is_no_effect_beside_that_one_alone(item):
    for operator in blocks[item].refines:
        assert blocks[operator].place == Place.OPERATOR
        fit = fit_of(operator, effects=(item, "creep"))
        assert refined_operator(fit, item) == operator
        assert f"makes {operator} finer" in refining_sentence(fit) and "creep" not in refining_sentence(fit)
    assert refined_operator(fit_of("bouc_wen"), item) == ""


def test_plays_that_are_bent_are_another_operator():
    assert refined_operator(fit_of("prandtl_ishlinskii"), "distributed_memory.bent_plays") == ""


def test_an_improvement_names_no_effect_for_a_finer_operator():
    """A stage of plays between those of the model."""
    weights = {f"prandtl_ishlinskii.weight_{i + 1}": 4e-9 for i in range(8)}
    plays = {"prandtl_ishlinskii.gain": 5e-8, "prandtl_ishlinskii.reach": 60.0} | weights
    case = stage.case(plays, model=("prandtl_ishlinskii",)).with_specs(stage.specs({"prandtl_ishlinskii.reach": 70.0}))
    case.ruled_out = tuple({*blocks.effects()} - {"distributed_memory"})
    found = improve(case, first_fit(case, 0))
    job = SimpleNamespace(name="plays", effects=[], limits=SimpleNamespace())
    content = improvement_of(job, case, found, {"reason": found.last.reason, "verdict": found.last.verdict})
    assert [word_of(step.added) for step in found.steps[1:]] == ["distributed_memory"]
    assert content["effects"] == [] and "makes prandtl_ishlinskii finer" in content["reason"]
