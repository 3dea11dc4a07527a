"""Optimizers side by side, repeat by repeat."""

import numpy as np
import pytest
from scipy.stats import binomtest

from pzt_ident.search.league import paired_comparison, rank, rmse_by_repeat, summary_of


@pytest.mark.parametrize("ahead", range(6))
def test_the_sign_test_is_the_binomial_one(ahead):
    leader = dict.fromkeys(range(6), 1.0)
    other = {repeat: 2.0 if repeat < ahead else 0.5 if repeat < 5 else 1.0 for repeat in range(6)}
    found = paired_comparison(leader, other)
    assert (found["leader_ahead"], found["pairs"]) == (ahead, 5)
    assert found["sign_test"] == pytest.approx(binomtest(ahead, 5).pvalue)


def test_only_repeats_that_both_have_are_paired():
    runs = [
        {"optimizer": name, "repeat": repeat, "rmse_before_polish": {"identify": value}}
        for name, repeat, value in (("pso", 0, 1.0), ("pso", 1, 2.0), ("rga", 1, 3.0), ("rga", 2, 0.1))
    ]
    found = paired_comparison(rmse_by_repeat(runs, "pso"), rmse_by_repeat(runs, "rga"))
    assert (found["leader_ahead"], found["pairs"]) == (1, 1)


def test_the_leader_against_itself_says_nothing():
    row = {0: 1.0, 1: 2.0}
    assert paired_comparison(row, row) == {"leader_ahead": 0, "pairs": 0, "sign_test": 1.0}


def run(optimizer, repeat, row, polished=None, **more):
    polished = row if polished is None else polished
    costs = {"seconds": 1.0, "cpu_seconds": 1.0, "evaluations": 100}
    return {
        "run": f"{optimizer}-{repeat}",
        "optimizer": optimizer,
        "repeat": repeat,
        "rmse_before_polish": {"identify": row, "validate": 99.0},
        "rmse": {"identify": polished, "validate": 0.01},
        **costs,
        **more,
    }


def history(*steps):
    """Evaluations and best RMSE so far; the seconds mean nothing here."""
    return np.array([(evaluations, 0.5, loss) for evaluations, loss in steps])


def test_quartiles_of_five_are_the_second_and_the_fourth():
    """Of what the optimizers found themselves; the polish has a column of its own."""
    found = summary_of(
        "pso",
        [run("pso", i, row, 1.0 + i / 10, evaluations_to_1_percent=None) for i, row in enumerate([5.0, 1, 9, 3, 2])],
    )
    assert (found["runs"], found["rmse_best"]) == (5, 1)
    assert [found[f"rmse_{word}"] for word in ("lower_quartile", "median", "upper_quartile")] == [2, 3, 5]
    assert found["polished_rmse_median"] == pytest.approx(1.2)


def test_quartiles_between_runs_are_interpolated():
    found = summary_of(
        "pso", [run("pso", i, row, evaluations_to_1_percent=None) for i, row in enumerate([4.0, 1, 3, 2])]
    )
    assert [found[f"rmse_{word}"] for word in ("lower_quartile", "median", "upper_quartile")] == [1.75, 2.5, 3.25]


def test_costs_are_medians_and_evaluations_the_most_of_any_run():
    costs = [(1.0, 8.0, 100), (2.0, 4.0, 300), (9.0, 2.0, 200)]
    names = ("seconds", "cpu_seconds", "evaluations")
    runs = [
        run("pso", i, 1.0, evaluations_to_1_percent=None, **dict(zip(names, c, strict=True)))
        for i, c in enumerate(costs)
    ]
    found = summary_of("pso", runs)
    assert (found["seconds_median"], found["cpu_seconds_median"], found["evaluations"]) == (2, 4, 300)


@pytest.mark.parametrize(
    ("reached", "median", "success"),
    [
        ((None, None, None, None), None, 0),
        ((70, None, None, None), None, 0.25),
        ((70, 10, None, None), None, 0.5),
        ((70, 10, None), 40, 2 / 3),
        ((70, 10, 30, None), 30, 0.75),
        ((0, 10, 30, 90), 20, 1),
    ],
)
def test_evaluations_to_one_percent_are_a_median_where_more_than_half_got_there(reached, median, success):
    found = summary_of("pso", [run("pso", i, 1.0, evaluations_to_1_percent=value) for i, value in enumerate(reached)])
    assert (found["evaluations_to_1_percent_median"], found["success"]) == (median, success)


def test_one_percent_is_of_the_best_that_any_run_found_polished_or_not():
    runs = [run("rga", 0, 2.0, 1.0), run("rga", 1, 1.5, 1.4), run("pso", 0, 1.011), run("pso", 1, 1.009)]
    histories = {
        "rga-0": history((10, 3.0), (20, 2.0)),
        "rga-1": history((10, 1.5)),
        "pso-0": history((10, 1.5), (30, 1.011)),
        "pso-1": history((10, 1.02), (20, 1.0101), (30, 1.0099), (40, 1.009)),
    }
    first, second = rank(runs, histories)
    assert [row["evaluations_to_1_percent"] for row in runs] == [None, None, None, 30]
    assert (first["optimizer"], first["success"], first["evaluations_to_1_percent_median"]) == ("pso", 0.5, None)
    assert (second["optimizer"], second["success"]) == ("rga", 0)


def test_success_is_counted_before_the_polish_and_after_it():
    """Of four runs that agree once polished, one was there before."""
    runs = [run("pso", 0, 1.5, 1.0), run("pso", 1, 1.004, 1.0), run("rga", 0, 2.0, 1.001), run("rga", 1, 3.0, 2.5)]
    first, second = rank(runs, {row["run"]: history((10, row["rmse_before_polish"]["identify"])) for row in runs})
    assert [row["optimizer"] for row in (first, second)] == ["pso", "rga"]
    assert (first["success"], first["polished_success"]) == (0.5, 1.0)
    assert (second["success"], second["polished_success"]) == (0.0, 0.5)


def test_a_fit_from_elsewhere_is_no_optimizer():
    """It counts as the best that is known, and is in no comparison."""
    runs = [run("pso", 0, 1.5, 1.2), run("start", 0, 1.0)]
    (row,) = rank(runs, {"pso-0": history((10, 1.5))})
    assert (row["optimizer"], row["success"], row["polished_success"]) == ("pso", 0.0, 0.0)
    assert rank([run("start", 0, 1.0)], {}) == []


def test_the_best_may_be_unpolished():
    runs = [run("pso", 0, 1.0, 1.5), run("rga", 0, 1.2)]
    rank(runs, {"pso-0": history((10, 1.0)), "rga-0": history((10, 1.2))})
    assert [row["evaluations_to_1_percent"] for row in runs] == [10, None]


def test_the_leader_has_the_least_median_of_its_own_results_and_is_what_all_are_compared_with():
    """rga has the best single run and the best after the polish, pso leads by its median and two of three repeats."""
    row = {"rga": (1.0, 7.0, 8.0), "pso": (2.0, 3.0, 4.0)}
    runs = [
        run(name, i, value, 0.5 if name == "rga" else None)
        for name, each in row.items()
        for i, value in enumerate(each)
    ]
    rows = rank(runs, {each["run"]: history((1, 9.0)) for each in runs})
    assert [each["optimizer"] for each in rows] == ["pso", "rga"]
    assert [(each["leader_ahead"], each["pairs"]) for each in rows] == [(0, 0), (2, 3)]
    assert rows[1]["sign_test"] == 1.0
