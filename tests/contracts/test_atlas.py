"""Laws of the atlas over the registry: a new word has its section, its pictures and its links by existing."""

import re
from html.parser import HTMLParser
from xml.etree import ElementTree

import numpy as np
import pytest

from pzt_ident.atlas.href import anchor, href
from pzt_ident.atlas.look_alikes import look_alikes
from pzt_ident.atlas.pictures import change
from pzt_ident.atlas.shown import shown
from pzt_ident.atlas.symptoms import SHOWN, table
from pzt_ident.atlas.traces import traced
from pzt_ident.atlas.words import Word
from pzt_ident.model.registry import blocks, optimizers, word_of

WORDS = [*blocks.words(), *optimizers.words()]
EFFECTS = blocks.effects()
LARGEST_FILE, LARGEST_WORD = 1.7e6, 1.6e5


class Page(HTMLParser):
    """The ids of a page and what it refers to."""

    def __init__(self, html):
        super().__init__()
        self.ids, self.links, self.sources = [], [], []
        self.feed(html)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.ids += [values["id"]] if "id" in values else []
        self.links += [values["href"]] if "href" in values else []
        self.sources += [values["src"]] if "src" in values else []


@pytest.fixture(scope="module")
def html(atlas_page):
    return atlas_page.read_text(encoding="utf-8")


@pytest.mark.parametrize("word", WORDS)
def test_every_word_has_its_section(word, html):
    section = re.search(rf'<article id="{anchor(word)}".*?</article>', html, re.S)[0]
    assert f'<a href="{href(word, "")}"' in html
    assert "<h4>Parameters</h4>" in section or "<h4>Settings</h4>" in section
    assert len(section) < LARGEST_WORD


@pytest.mark.parametrize("word", blocks.words())
def test_every_block_has_its_equation_set(word):
    _, equation, _ = Word(word).texts
    for piece in re.findall("<math>.*?</math>", equation):
        ElementTree.fromstring(piece.replace("&#x2061;", ""))
    assert "<math>" in equation


@pytest.mark.parametrize("form", [form for word in EFFECTS for form in blocks.forms(word)])
def test_every_effect_in_every_form_does_what_can_be_seen(form):
    traces = traced(form)
    assert max(change(traces, name) for name in traces.with_it) > 0.01
    assert traces.largest > 1e-3, "and a refit does not hide it"


@pytest.mark.parametrize("word", WORDS)
def test_pictures_have_units_and_differ_from_those_without_the_word(word):
    pictures = Word(word).pictures
    assert len(pictures) >= 2 and max(picture.change for picture in pictures) > 0.01
    for picture in pictures:
        root = ElementTree.fromstring(picture.svg)
        labels = [text.text for text in root if text.get("class") == "label"]
        assert len(labels) >= 2 and all(labels)
        assert not re.search(r"\bnan\b", picture.svg)
    if word in blocks:
        assert all(
            ", " in label for picture in pictures for label in re.findall('class="label"[^>]*>([^<]*)', picture.svg)
        )


@pytest.mark.parametrize("item", [item for word in EFFECTS for item in blocks.forms(word)[1:]])
def test_every_form_has_its_own_pictures_beside_those_of_the_first(item, html):
    word = word_of(item)
    section = re.search(rf'<article id="{anchor(word)}".*?</article>', html, re.S)[0]
    first, mine = (re.search(rf"<code>{name}</code></dt>.*?</dd>", section, re.S)[0] for name in (word, item))
    assert f'<dt id="{anchor(item)}"' in section
    drawings = [re.findall(r'<path class="with".*?/>', entry) for entry in (first, mine)]
    assert min(map(len, drawings)) >= 2 and drawings[0] != drawings[1]
    assert all(row.name.partition(".")[2].rstrip("_0123456789") in mine for row in shown(item).values)


@pytest.mark.parametrize("word", EFFECTS)
def test_look_alikes_are_linked_both_ways(word):
    others = look_alikes(word)
    assert set(blocks[word].look_alikes) <= {other.word for other in others}
    for other in others:
        assert word in [back.word for back in look_alikes(other.word)]
        assert 0 <= other.least <= other.most <= 1 + 1e-9


def test_every_effect_is_found_from_what_is_seen():
    rows = table()
    assert {word for _, effects in rows for word, _ in effects} == set(EFFECTS)
    for _, effects in rows:
        strengths = [strength for _, strength in effects]
        assert strengths == sorted(strengths, reverse=True) and np.all(np.array(strengths) >= SHOWN)
        assert 0 < len(effects) < len(EFFECTS) * 0.6


def test_every_link_has_a_target_and_nothing_is_loaded(html):
    page = Page(html)
    assert len(page.ids) == len(set(page.ids))
    assert {link for link in page.links if link.startswith("#")} <= {f"#{name}" for name in page.ids}
    assert not page.sources and not [link for link in page.links if not link.startswith("#")]
    assert len(html.encode()) < LARGEST_FILE
