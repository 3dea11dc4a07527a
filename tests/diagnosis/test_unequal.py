"""A grating has one size, wherever on it a record begins."""

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.limit import is_limited
from pzt_ident.diagnosis.unequal import differs_in_size
from pzt_ident.model.registry import blocks

ITEM = "encoder_cyclic_error.rezeroed"
PITCH = 1e-6


@pytest.mark.parametrize(
    ("sizes", "differs"), [((20e-9, 20e-9), False), ((20e-9, 12e-9), False), ((20e-9, 4e-9), True)]
)
def test_a_grating_of_another_size_in_each_record_is_none(sizes, differs):
    blank = stage.case()
    sized = dict(zip((record.name for record in blank.records), sizes, strict=True))

    def change(record):
        phase = 2.0 * len(record.name)
        return sized[record.name] * np.sin(2 * np.pi * record.response / PITCH + phase)

    case = stage.with_response(blank, change)
    problem = case.problem((ITEM,))
    known = {name: value for name, value in stage.STAGE.items() if name in problem.names} | {"bouc_wen.gain": 0.082}
    fit = fit_at((ITEM,), problem, problem.unit_point(known | {"encoder_cyclic_error.pitch": 1.0}))
    assert fit.total < 1.3 * case.floor
    assert differs_in_size(fit, ITEM) == is_limited(fit) == differs


def test_effects_that_declare_nothing_alike_may_be_of_any_size():
    case = stage.case()
    fit = fit_at(("drift",), problem := case.problem(("drift",)), np.full(problem.dimensions, 0.5))
    assert not differs_in_size(fit, "drift")


@pytest.mark.parametrize(
    "item", [item for word in blocks.effects() for item in blocks.forms(word) if blocks[item].alike]
)
def test_what_is_alike_are_amounts_of_a_record(item):
    parameters = blocks[item].parameters()
    assert all(parameters[word].per_record for word in blocks[item].alike)
