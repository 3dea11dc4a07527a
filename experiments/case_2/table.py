"""Tables 7 and 8 of Lin & Lin (2012), Mechatronics 22, 614, beside what the jobs of Case II found."""

from __future__ import annotations

from collections.abc import Mapping

from experiments.tables import Result, command, league, number, table

STIFFNESS = {"x": 7.00e7, "y": 7.70e7}  # Table 7, N/m
PAPER = {  # Table 7, the optimum by PSO; the stage has these values, with k12 negative
    "x.cross_coupling.ratio": 3.23e6,
    "y.cross_coupling.ratio": 4.15e6,
    "x.bouc_wen.alpha": 0.519979,
    "y.bouc_wen.alpha": 0.863758,
    "x.bouc_wen.beta": 0.012794,
    "y.bouc_wen.beta": 0.295187,
    "x.bouc_wen.gamma": 0.052803,
    "y.bouc_wen.gamma": 0.0,
}
SCORES = {"standalone model": (0.154339, 0.379272), "coupled model": (0.087902, 0.118803)}  # Table 8, um
WORDS = {"x.cross_coupling.ratio": "k12 [N/m]", "y.cross_coupling.ratio": "k21 [N/m]"}


def identified(negative: Result, positive: Result) -> str:
    """Table 7: the stiffnesses of the coupling from the identified ratios."""
    rows = []
    for name, paper in PAPER.items():
        size = STIFFNESS[name[0]] if name in WORDS else 1.0
        entries = [result["best"]["parameters"][name] for result in (negative, positive)]
        values = [f"{number(size * e['value'])} ± {number(size * (e['standard_error'] or 0), 2)}" for e in entries]
        rows.append([WORDS.get(name, f"{name} [{entries[0]['unit']}]"), number(paper), *values, entries[0]["verdict"]])
    return table(["parameter", "paper", "stage with k12 < 0", "stage with k12 > 0", "verdict"], rows)


def scores(results: Mapping[str, Result]) -> str:
    """Table 8: RMSE of X and Y with both axes driven."""
    alone = [results[f"standalone_{axis}"]["records"][1]["rmse"][axis] for axis in "xy"]
    rows = [
        ["standalone model", *SCORES["standalone model"], *map(number, alone)],
        ["uncoupled model, identified anew", "–", "–", *map(number, together(results["uncoupled"]))],
        ["coupled model", *SCORES["coupled model"], *map(number, together(results["coupled"]))],
    ]
    return table(["model", "X paper [um]", "Y paper [um]", "X here [um]", "Y here [um]"], rows)


def together(result: Result) -> list[float]:
    return [result["records"][0]["rmse"][axis] for axis in "xy"]


def text(results: Mapping[str, Result]) -> str:
    return "\n\n".join(
        [
            "**Table 7: identified values**",
            identified(results["coupled"], results["coupled_positive"]),
            "**Table 8: RMSE while both axes move**",
            scores(results),
            "**The coupled model: all optimizers at equal evaluations**",
            league(results["coupled"]),
        ]
    )


if __name__ == "__main__":
    command(text)
