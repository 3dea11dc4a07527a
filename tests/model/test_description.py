"""What is told of a word is what its forms declare."""

import pytest

from pzt_ident.model.block import Term
from pzt_ident.model.description import description_of
from pzt_ident.model.registry import blocks


@pytest.mark.parametrize("item", [item for word in blocks.effects() for item in blocks.forms(word)])
def test_each_form_is_told_with_its_own_bounds_and_value(item):
    word = item.partition(".")[0]
    own = {} if issubclass(blocks[item], Term) else blocks[item].parameters()
    rows = description_of(word)["parameters"]
    for name, declared in own.items():
        of_form = [
            row for row in rows if row["name"] == name and (not row["form"] or f"`{item}`" in f"`{row['form']}`")
        ]
        told = [(row["bounds"], row["value"], row["doc"]) for row in of_form]
        assert told == [(declared.bounds, declared.value, declared.doc)]
