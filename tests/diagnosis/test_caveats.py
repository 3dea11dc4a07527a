"""What stands beside a verdict on the records themselves."""

from dataclasses import replace

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis.bounds import Widened
from pzt_ident.diagnosis.caveats import addition_sentences, amounts, caveats, start_step_sentence
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.starts import first_fit


def fit_of(case):
    problem = case.problem(())
    return fit_at((), problem, np.full(problem.dimensions, 0.5))


def stepped(which):
    """The case of which some records begin as after a step."""
    case = stage.case()
    after = 1e-4 * np.exp(-np.arange(case.records[0].samples) / 3)
    made = [
        replace(record, response=record.response - after[: record.samples]) if number in which else record
        for number, record in enumerate(case.records)
    ]
    return case.with_records(made)


@pytest.mark.parametrize(("which", "begins"), [((), ""), ((0,), " begins "), ((0, 1), " begin ")])
def test_records_that_begin_with_a_step_are_told(which, begins):
    case = stepped(which)
    sentence = start_step_sentence(case, fit_of(case))
    assert begins in sentence and bool(sentence) == bool(which) == ("`rest_at`" in sentence)
    assert all((record.name in sentence) == (number in which) for number, record in enumerate(case.records))


@pytest.mark.parametrize(("bounds", "asked"), [((0.05, 0.2), False), ((50, 200), True), ((5e-5, 2e-4), True)])
def test_a_gain_that_no_such_data_have_is_asked_about_beside_the_verdict(bounds, asked):
    case = stage.case().with_specs({"bouc_wen.gain": Widened(bounds)})
    assert ("are the units right?" in caveats(case, fit_of(case))) == asked


def test_what_the_job_or_the_model_says_is_not_asked_for():
    case = stepped((0, 1))
    known = case.with_records([replace(each, rest_at=(0.0,)) for each in case.records])
    assert start_step_sentence(known, fit_of(known)) == ""
    moving = case.with_words(("history", *case.words))
    assert start_step_sentence(moving, fit_of(moving)) == ""


def test_the_most_that_an_effect_adds_to_a_record_is_told_with_the_record():
    """A hum of 40 nm, of 56 nm in the last record."""
    case = stage.case()
    waves = [np.sin(2 * np.pi * 7.3 * record.time) for record in case.records]
    sizes = [1.0] * (len(waves) - 1) + [1.4]
    made = [
        replace(record, response=record.response + 40e-9 * np.sqrt(2) * size * wave)
        for record, size, wave in zip(case.records, sizes, waves, strict=True)
    ]
    hummed = case.with_records(made)
    fit = refit(hummed, first_fit(hummed, 0), ("periodic_disturbance",), {"periodic_disturbance.frequency": 7.3})
    (amount,) = amounts(fit)
    assert (amount.effect, amount.axis, amount.record, amount.unit) == (
        "periodic_disturbance",
        "x",
        made[-1].name,
        "um",
    )
    assert amount.rms == pytest.approx(0.056, rel=0.05)
    assert f"largest in record {made[-1].name}: 0.056 um rms" in addition_sentences(fit)


def test_what_was_said_is_not_said_again():
    case = stepped((0,))
    sentence = start_step_sentence(case, fit_of(case))
    assert sentence in caveats(case, fit_of(case)) and sentence not in caveats(
        case, fit_of(case), said=f"So.{sentence}"
    )
