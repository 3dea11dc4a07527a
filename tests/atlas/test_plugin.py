"""A word of the user's own is in the atlas like any other."""

import sys

import pytest

from pzt_ident.atlas.look_alikes import look_alikes
from pzt_ident.atlas.manual import code_blocks, source
from pzt_ident.atlas.symptoms import table
from pzt_ident.atlas.words import Word
from pzt_ident.model.registry import blocks


@pytest.fixture
def cubic_gain(tmp_path):
    (code,) = (code.text for code in code_blocks(source("50_your_own.md")) if code.file == "cubic_gain.py")
    path = tmp_path / "cubic_gain.py"
    path.write_text(code, encoding="utf-8")
    blocks.plug(path)
    yield "cubic_gain"
    blocks._items.pop("cubic_gain")
    sys.modules.pop("pzt_ident_plugins.cubic_gain")


def test_it_has_equation_pictures_and_look_alikes(cubic_gain):
    word = Word(cubic_gain)
    assert word.group.startswith("Actuator") and word.null == "bend = 0"
    assert "<math>" in word.texts[1]
    assert max(picture.change for picture in word.pictures) > 0.02
    alike = {other.word: other.together for other in word.look_alikes}
    assert alike["saturation"] > 0.9 and "delay" not in alike
    assert cubic_gain in [other.word for other in look_alikes("saturation")]


def test_it_is_found_from_what_is_seen(cubic_gain):
    bent = next(effects for sentence, effects in table() if "bent curve" in sentence)
    assert cubic_gain in dict(bent)
