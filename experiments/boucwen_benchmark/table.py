"""The true parameters of the benchmark and the published scores beside what the jobs found."""

from __future__ import annotations

from collections.abc import Mapping

from experiments.tables import Result, command, league, number, table

TRUE = {"mass": 2.0, "damping": 10.0, "stiffness": 5e4, "alpha": 5e4, "beta": 800.0, "gamma": -1100.0}
PUBLISHED = {  # RMSE on the test multisine, m
    "non-parametric FIR": 16.3e-5,
    "dynoNet": 4.52e-5,
    "polynomial state space, tailored": 1.87e-5,
    "polynomial state space, degrees 3-5-7": 1.21e-5,
}


def recovered(result: Result) -> str:
    rows = []
    for word, true in TRUE.items():
        entry = result["best"]["parameters"][f"bouc_wen_oscillator.{word}"]
        off = abs(entry["value"] / true - 1)
        rows.append(
            [
                f"{word} [{entry['unit']}]",
                number(true),
                number(entry["value"], 6),
                number(entry["standard_error"], 2),
                f"{off:.2%}",
            ]
        )
    return table(["parameter", "true", "identified", "standard error", "off by"], rows)


def scores(results: Mapping[str, Result]) -> str:
    truth = {record["name"]: record["rmse"]["x"] for record in results["truth"]["records"]}
    rows = [[name, number(value, 3), "–"] for name, value in PUBLISHED.items()]
    rows += [
        ["this oscillator, true parameters", number(truth["test multisine"], 3), number(truth["test sweep"], 3)],
        [
            "this oscillator, identified",
            number(results["multisine"]["best"]["rmse"]["validate"], 3),
            number(results["sweep"]["best"]["rmse"]["validate"], 3),
        ],
    ]
    return table(["model", "test multisine [m]", "test sweep [m]"], rows)


def text(results: Mapping[str, Result]) -> str:
    parts = ["**Scores**", scores(results), "**Recovery**", recovered(results["multisine"])]
    return "\n\n".join([*parts, "**All optimizers at equal evaluations**", league(results["multisine"])])


if __name__ == "__main__":
    command(text)
