"""Where a word is in the atlas, said by the command that shows it."""

import pytest
from click.testing import CliRunner

from pzt_ident.atlas.href import href
from pzt_ident.cli.commands import main


def test_a_form_has_its_own_place():
    assert href("creep") == "atlas.html#word-creep"
    assert href("creep.voltage") == "atlas.html#word-creep.voltage"
    assert href("creep", "/atlas") == "/atlas#word-creep"


def test_what_is_no_form_is_in_the_section_of_its_word():
    assert href("creep.tau") == href("creep") and href("pso.particles") == href("pso")


@pytest.mark.parametrize("word", ["creep.voltage", "pso", "lumped"])
def test_show_says_where_the_word_is_in_the_atlas(word):
    last = CliRunner().invoke(main, ["show", word]).output.splitlines()[-1]
    assert last == f"Pictures and more: `pzt-ident atlas` writes {href(word)}"
