"""The keys of a job, from its schema."""

import re

from pzt_ident.atlas.job_keys import PLACES, documented, key_tables, sections_of
from pzt_ident.job.document import Document
from pzt_ident.job.normalise import SHORT_FORMS
from pzt_ident.job.schema import Job


def test_every_key_of_a_job_is_there_and_described():
    first, *others = key_tables()
    assert {row.key for row in first.rows} == set(Job.model_fields)
    assert [section.title for section in others] == list(PLACES.values())
    for section in (first, *others):
        assert section.doc.endswith((".", "`."))
        for row in section.rows:
            assert re.fullmatch(r"[A-Z].*\.", row.doc), (section.title, row.key)


def test_each_key_has_its_part_of_a_docstring():
    text = "One of two.\n\n    file: of `a: b`.\n    use: whether\n    it is fitted: or not. rows: some.\n    "
    assert documented(text, ["file", "use", "rows"]) == (
        "One of two.",
        {"file": "Of `a: b`.", "use": "Whether it is fitted: or not.", "rows": "Some."},
    )


def test_values_are_in_words():
    rows = {row.key: row for row in key_tables()[0].rows}
    assert rows["repeats"].value == "whole number" and rows["repeats"].default == "1"
    assert rows["model"].value == "list: text or mapping"
    assert rows["records"].default == "required"


def test_a_key_is_shown_with_what_it_may_hold():
    titles = [section.title for section in sections_of("parameters")]
    assert titles == ["The file", PLACES["Setting"]] and sections_of("nothing") == []
    held = {section.title: [row.key for row in section.rows] for section in sections_of("channels")}
    assert held["The file"] == ["channels"] and held[PLACES["Axis"]] == ["drive", "response"]
    assert "column" in held[PLACES["Channel"]] and PLACES["Limits"] not in held


def test_every_short_form_is_told_where_its_long_form_is():
    values = [row.value for section in key_tables() for row in section.rows]
    for pattern, _, written in SHORT_FORMS:
        word = pattern.removesuffix(".*").rpartition(".")[2]
        assert any(row.key == word and written in row.value for section in key_tables() for row in section.rows), word
    assert "[number or `20 ms`, number or `20 ms`]" in values and "list: mapping or a name" in values


def test_a_short_form_as_it_is_told_is_read():
    for pattern, expand, written in SHORT_FORMS:
        if written.startswith("`"):
            document = Document("channels: {axes: {x: {}}}", "job.yaml")
            assert expand(document, tuple(pattern.split(".")), written.strip("`")) is not None and not document.faults
