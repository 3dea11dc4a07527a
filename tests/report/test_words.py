"""The words of a report: each that it names is explained on its page, and linked to that."""

import re
from types import SimpleNamespace

import pytest

from pzt_ident.report.page import write_report
from pzt_ident.report.words import coded, linked, named, place_of, without_links
from run_folders import make_run


def table(**columns):
    return SimpleNamespace(text={name.replace("_", " "): cells for name, cells in columns.items()})


def test_blocks_and_effects_are_named_in_sentences_and_tables():
    tables = {
        "candidates": table(effect=["creep.voltage"], indistinguishable_from=["drift, asymmetry"], physics=["delay"]),
        "parameters": table(parameter=["x.lumped.mass"]),
    }
    words = named(["Add friction to the model.", "No effect explains it."], tables)
    assert [item.word for item in words] == ["asymmetry", "creep", "drift", "friction", "lumped"]


@pytest.mark.parametrize(
    ("text", "html"),
    [
        ("Add creep.voltage.", 'Add <a href="#word-creep">creep.voltage</a>.'),
        ("x.lumped.mass", '<a href="#word-lumped">x.lumped.mass</a>'),
        ("creeping <b>, drift", "creeping &lt;b&gt;, drift"),
        ("\u00b5m of creep & more", '\u00b5m of <a href="#word-creep">creep</a> &amp; more'),
    ],
)
def test_a_word_is_a_link_and_all_else_is_text(text, html):
    words = named(["creep and lumped"], {})
    assert linked(text, words) == html


def test_what_stands_between_backticks_is_code():
    assert linked("give `<rows>`, or `a` and `creep`", named(["creep"], {})) == (
        'give <code>&lt;rows&gt;</code>, or <code>a</code> and <code><a href="#word-creep">creep</a></code>'
    )
    assert coded("leave it out with `rows`; <b>") == "leave it out with <code>rows</code>; &lt;b&gt;"


def test_links_to_other_sections_of_the_atlas_are_left_out():
    assert (
        without_links('a <a href="#word-pso"><code>pso</code></a> <math>x</math>')
        == "a <code>pso</code> <math>x</math>"
    )


def test_where_an_atlas_lies_beside_each_word_leads_to_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = make_run(tmp_path / "a b" / "run", samples=60)
    assert "atlas.html" not in write_report(run, static=False).read_text(encoding="utf-8")
    (tmp_path / "atlas.html").touch()
    links = re.findall(r'href="(.*?)#(word-\w+)">In the atlas', write_report(run, static=False).read_text("utf-8"))
    assert links == [("../../atlas.html", "word-bouc_wen"), ("../../atlas.html", "word-lumped")]


def test_the_first_word_of_a_step_is_its_place_on_the_page():
    words = named(["creep and lumped"], {})
    steps = ["+ creep (voltage) - lumped", "x.lumped.mass = 3", "as given"]
    assert [place_of(step, words) for step in steps] == ["#word-creep", "#word-lumped", ""]


def test_each_word_has_its_equation_and_remedy_on_the_page(tmp_path):
    page = write_report(make_run(tmp_path / "run", samples=60), static=False).read_text(encoding="utf-8")
    sections = dict(re.findall(r'<article id="word-(\w+)">(.*?)</article>', page, re.S))
    assert set(sections) == {"bouc_wen", "lumped"} == set(re.findall(r'<a href="#word-(\w+)">\1\.', page))
    assert all("<math>" in section for section in sections.values())
