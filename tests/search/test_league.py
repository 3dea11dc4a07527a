"""Optimizers side by side, repeat by repeat."""

import pytest
from scipy.stats import binomtest

from pzt_ident.search.league import by_repeat, paired


@pytest.mark.parametrize("ahead", range(6))
def test_the_sign_test_is_the_binomial_one(ahead):
    leader = dict.fromkeys(range(6), 1.0)
    other = {repeat: 2.0 if repeat < ahead else 0.5 if repeat < 5 else 1.0 for repeat in range(6)}
    found = paired(leader, other)
    assert (found["leader_ahead"], found["pairs"]) == (ahead, 5)
    assert found["sign_test"] == pytest.approx(binomtest(ahead, 5).pvalue)


def test_only_repeats_that_both_have_are_paired():
    runs = [
        {"optimizer": name, "repeat": repeat, "rmse_before_polish": {"identify": value}}
        for name, repeat, value in (("pso", 0, 1.0), ("pso", 1, 2.0), ("rga", 1, 3.0), ("rga", 2, 0.1))
    ]
    found = paired(by_repeat(runs, "pso"), by_repeat(runs, "rga"))
    assert (found["leader_ahead"], found["pairs"]) == (1, 1)


def test_the_leader_against_itself_says_nothing():
    own = {0: 1.0, 1: 2.0}
    assert paired(own, own) == {"leader_ahead": 0, "pairs": 0, "sign_test": 1.0}
