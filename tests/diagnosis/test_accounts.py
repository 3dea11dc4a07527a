"""Wider bounds are the account of a misfit where they lead to the noise, or as far with fewer effects."""

from dataclasses import replace

import numpy as np
import pytest

import stage
from made_fits import CASE, fit
from pzt_ident.diagnosis import accounts
from pzt_ident.diagnosis.accounts import explains_fitted, is_cheaper, outdoes
from pzt_ident.diagnosis.climb import Staircase
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.step import Step
from pzt_ident.diagnosis.verdict import diagnose


@pytest.fixture(scope="module")
def account():
    """A case, its first fit, and the diagnosis of that."""
    case = stage.case()
    first = first_fit(case, 0)
    return case, first, diagnose(case, first)


@pytest.mark.parametrize(
    ("apart", "effects", "within", "cheaper"),
    [
        (-1.0, ["distributed_memory"], True, True),
        (0.1, ["distributed_memory"], True, True),
        (1.0, ["distributed_memory"], True, False),
        (-1.0, [], True, False),
        (-1.0, ["distributed_memory"], False, False),
    ],
)
def test_wider_bounds_without_an_effect_are_the_cheaper_account_of_what_no_effect_explains(
    monkeypatch, account, apart, effects, within, cheaper
):
    """Above the noise both: a jump at a position, in a job that bounds the gain beside the truth. apart: noise floors,
    root mean square, by which wider bounds leave more."""
    case, first, diagnosis = account
    given = replace(first, identify=10 * case.floor, validate=10 * case.floor, effects=tuple(effects))
    left = case.floor * (100 + np.sign(apart) * apart**2) ** 0.5
    wide = Staircase([Step(replace(first, identify=left, validate=left))], diagnosis)
    monkeypatch.setattr(accounts, "keeps_within", lambda *arguments: within)
    assert is_cheaper(wide, Staircase([Step(given)], wide.last), case) == cheaper


@pytest.mark.parametrize("arrived", [True, False])
def test_wider_bounds_that_lead_to_the_noise_outdo_those_that_do_not_even_if_one_is_reached(
    monkeypatch, account, arrived
):
    """A gain by the prompt response, which the stops of a memory lower beyond the bounds of a data sheet."""
    case, first, diagnosis = account
    verdict = replace(diagnosis, verdict="adequate" if arrived else "unexplained")
    wide = Staircase([Step(replace(first, effects=("distributed_memory",)))], verdict)
    given = Staircase([Step(first)], replace(diagnosis, verdict="unexplained"))
    for word in ("accounts", "keeps_within"):
        monkeypatch.setattr(accounts, word, lambda *arguments: False)
    assert outdoes(wide, given, case, first) == arrived


@pytest.mark.parametrize(
    ("identify", "validate", "explains"), [(1.0, 1.0, True), (1.0, 3.0, True), (1.0, 12.0, False), (2.0, 1.0, False)]
)
def test_wider_bounds_account_for_what_the_fitted_records_tell_where_nearly_all_of_the_others_goes_too(
    identify, validate, explains
):
    assert explains_fitted(CASE, fit(30.0, 30.0), fit(identify, validate)) == explains
