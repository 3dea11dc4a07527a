"""What is told of a word is what its forms declare."""

from inspect import getdoc

import pytest

from pzt_ident.errors import InputError
from pzt_ident.model.block import Term
from pzt_ident.model.description import description_of
from pzt_ident.model.registry import blocks


@pytest.mark.parametrize("item", [item for word in blocks.effects() for item in blocks.forms(word)])
def test_each_form_is_told_with_its_equation(item):
    found = description_of(item)
    assert (found["kind"], found["doc"]) == ("effects", getdoc(blocks[item]))


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


def test_each_parameter_is_told_by_its_name_in_a_job():
    """But for one that is a form of its block, too."""
    for block in blocks:
        forms = blocks.forms(block.name) if blocks.is_effect(block.name) else []
        for name in (name for name in block.parameters() if f"{block.name}.{name}" not in forms):
            found = description_of(f"{block.name}.{name}")
            assert {row["name"] for row in found["parameters"]} == {name}, (block.name, name)


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("payload", "did you mean 'load_mass'?"),
        ("mass", "did you mean bouc_wen_oscillator.mass or lumped.mass?"),
        ("preisach", "homogenized_energy speaks of it"),
        ("hysterisis", "known: "),
        ("fricton", "did you mean 'friction' or 'drift'?"),
    ],
)
def test_an_unknown_word_leads_to_what_may_be_meant(name, remedy):
    with pytest.raises(InputError, match=f"unknown word {name!r}") as raised:
        description_of(name)
    assert remedy in raised.value.remedy


def test_look_alikes_are_told_by_both():
    """As a diagnosis takes them."""
    told = {word: description_of(word)["look_alikes"] for word in blocks.effects()}
    assert all(len({*others}) == len(others) for others in told.values())
    assert all(word in told[other] for word, others in told.items() for other in others)
    assert all({*blocks[word].look_alikes} <= {*others} for word, others in told.items())


def test_the_nodes_of_a_density_are_told_with_the_forms_that_have_them():
    rows = {row["name"]: row for row in description_of("homogenized_energy")["settings"]}
    assert rows["nodes"]["form"] == "density: free` or `density: shared" and rows["density"]["form"] == ""
