"""The keys of a job, from its schema."""

import re

from pzt_ident.atlas.job_keys import PLACES, key_tables
from pzt_ident.job.schema import Job


def test_every_key_of_a_job_is_there_and_described():
    first, *others = key_tables()
    assert {row.key for row in first.rows} == set(Job.model_fields)
    assert all(row.doc.endswith(".") for row in first.rows)
    assert [section.title for section in others] == list(PLACES.values())
    for section in others:
        for row in section.rows:
            assert re.search(rf"\b{row.key}\b", section.doc), (section.title, row.key)


def test_values_are_in_words():
    rows = {row.key: row for row in key_tables()[0].rows}
    assert rows["repeats"].value == "whole number" and rows["repeats"].default == "1"
    assert rows["model"].value == "list: text or mapping"
    assert rows["records"].default == "required"
