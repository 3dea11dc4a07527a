"""What Python runs and numba does not compile is told of the author's own line, without the compiler's trace."""

import re
import sys

import pytest

from authors import GAIN, HEAD
from pzt_ident.engine.lanes import compile_block
from pzt_ident.errors import InputError
from pzt_ident.model.registry import blocks

LAST = "return w, u, u + bend * (u * u + w)"
HELPER = "\n\ndef helper(u):\n    return len(sorted([u], key=str)) * u\n"


@pytest.fixture
def plug(tmp_path):
    """Registers a block of an author's file."""

    def plugged(text):
        own = tmp_path / "own_gain.py"
        text = text.replace("class Gain", "@blocks.register\nclass Gain")
        own.write_text(HEAD + "from pzt_ident.model.registry import blocks\n" + text)
        blocks.plug(own)
        return blocks["own_gain"]

    yield plugged
    blocks._items.pop("own_gain", None)
    sys.modules.pop("pzt_ident_plugins.own_gain", None)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("line", "more", "where"),
    [
        ('words = {"a": u, 2: w}', "", "Gain.step"),
        ('v = u + len("%s" % u)', "", "Gain.step"),
        ("v = sum(sorted([u, w], key=abs))", "", "Gain.step"),
        ("v = float(np.interp(u, [0, 1], [w, 'a'][:1] * 2))", "", "Gain.step"),
        ("u = helper(u)", HELPER, "Gain: helper"),
    ],
)
def test_numba_is_quoted_by_the_line_that_it_refuses(plug, line, more, where):
    block = plug(GAIN.replace(LAST, f"{line}\n        {LAST}") + more)
    with pytest.raises(InputError) as raised:
        compile_block(block)
    assert raised.value.where == where
    quoted = "return len(sorted([u], key=str)) * u" if more else line
    assert re.fullmatch(rf"line \d+ cannot be compiled: `{re.escape(quoted)}`", raised.value.message)
    assert "math" in raised.value.remedy and raised.value.__cause__ is None


def test_a_form_that_is_no_part_of_the_registry_is_told_too(plug):
    more = (
        "\n\nclass Other(Gain):\n    def step(w, u, bend, share):\n        return w, u\n\nGain.forms = {'creep': Other}"
    )
    block = plug(GAIN + more)
    with pytest.raises(InputError, match=r"Other.step: takes .*'state 2' missing"):
        compile_block(block.forms["creep"])


def test_a_file_that_breaks_the_contract_is_not_plugged(plug):
    with pytest.raises(InputError, match=r"^Gain.prepare: asks for 'tua'"):
        plug(GAIN.replace("tau, dt)", "tua, dt)"))
    assert "own_gain" not in blocks
