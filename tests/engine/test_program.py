"""The program of a model holds on any record once what is of the record is put in."""

from dataclasses import replace

import numpy as np
import pytest

from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.block import Term
from pzt_ident.model.registry import blocks, word_of
from rig import candidates, model, record

T = 1e-3 * np.arange(400)
FIRST = 50 + 50 * np.sin(2 * np.pi * 7 * T), 60 * np.sin(2 * np.pi * 11 * T)
OTHER = 30 * np.sin(2 * np.pi * 5 * T[:300]), 20 + 20 * np.sin(2 * np.pi * 3 * T[:300])
BASES = "bouc_wen", "prandtl_ishlinskii", "homogenized_energy"
FORMS = [item for word in blocks.effects() for item in blocks.forms(word)]
PAIRS = [
    (base, form)
    for base in BASES
    for form in FORMS
    if not issubclass(blocks[form], Term) or blocks[base].holds(blocks[form])
]


@pytest.mark.parametrize(("base", "form"), PAIRS)
def test_the_simulator_of_another_record_is_the_one_made_on_it(base, form):
    words = dict.fromkeys([base, *({"lumped"} - {word_of(form)}), form])
    made = model(*blocks.chain(words), axes=2)
    first = record(*FIRST, response=1e-7 * np.array(FIRST))
    other = replace(record(*OTHER, response=1e-7 * np.array(OTHER)), dt=5e-4, start=2.0, steps=2, settle=40)
    theta = candidates(made, np.array(OTHER), 2, seed=4, response=1e-5)
    moved, fresh = Simulator(made, first).on(other), Simulator(made, other)
    np.testing.assert_array_equal(moved.simulate(theta), fresh.simulate(theta))
    np.testing.assert_array_equal(moved.errors(theta), fresh.errors(theta))
    np.testing.assert_array_equal(moved.squares(theta), fresh.squares(theta))
