"""What stands beside a verdict on the records themselves."""

from dataclasses import replace

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis.caveats import start_step_sentence


def stepped(which):
    """The case of which some records begin as after a step."""
    case = stage.case()
    after = 1e-5 * np.exp(-np.arange(case.records[0].samples) / 5)
    made = [
        replace(record, response=record.response - after[: record.samples]) if number in which else record
        for number, record in enumerate(case.records)
    ]
    return case.with_records(made)


@pytest.mark.parametrize(("which", "begins"), [((), ""), ((0,), " begins "), ((0, 1), " begin ")])
def test_records_that_begin_with_a_step_are_told(which, begins):
    case = stepped(which)
    sentence = start_step_sentence(case)
    assert begins in sentence and bool(sentence) == bool(which) == ("`rest_at`" in sentence)
    assert all((record.name in sentence) == (number in which) for number, record in enumerate(case.records))


def test_a_record_of_which_the_job_says_it_is_not_told():
    case = stepped((0, 1))
    assert start_step_sentence(case.with_records([replace(each, rest_at=(0.0,)) for each in case.records])) == ""
