"""Tables 3 to 6 of Lin & Lin (2012), Mechatronics 22, 614, beside what the two jobs of Case I found."""

from __future__ import annotations

from collections.abc import Mapping

from experiments.tables import NAMES, Result, command, league, number, runs_of, table

ORDER = (
    *(f"lumped.{word}" for word in ("mass", "damping", "stiffness")),
    *(f"bouc_wen.{word}" for word in ("gain", "alpha", "beta", "gamma")),
)
PAPER = {  # Tables 3 and 4 in kg, N s/m, N/m, um/V, 1, 1/V, 1/V; the stage has the values of PSO
    "x": {
        "rga": (0.1612, 0, 7.5211e7, 8.1813e-2, 0.6388, 0.0125, 0.0693),
        "pso": (0.1566, 0, 7.0028e7, 8.1947e-2, 0.5590, 0.0148, 0.0552),
        "csa": (0.0655, 0, 7.0001e7, 8.1929e-2, 0.5628, 0.0156, 0.0552),
    },
    "y": {
        "rga": (0.0673, 0, 7.0723e7, 1.1065e-1, 0.5231, 0.1108, 0),
        "pso": (0.0631, 0, 7.6963e7, 1.1064e-1, 0.5243, 0.1111, 0),
        "csa": (0.0651, 0, 7.2732e7, 1.1062e-1, 0.5313, 0.1089, 0.0039),
    },
}
SCORES = {  # Tables 5 and 6: RMSE in um, time in s
    "x": {"rga": (0.092309, 3969), "pso": (0.091625, 1993), "csa": (0.092331, 30384)},
    "y": {"rga": (0.147957, 3793), "pso": (0.147950, 2179), "csa": (0.147972, 30630)},
}


def identified(result: Result, axis: str) -> str:
    """Table 3 or 4: the best of the runs of each optimizer, and the spread of all runs."""
    paper, best = PAPER[axis], {name: runs_of(result, name)[0]["parameters"] for name in PAPER[axis]}
    rows = []
    for i, word in enumerate(ORDER):
        entry = result["best"]["parameters"][word]
        values = [run["parameters"][word]["value"] for run in result["runs"]]
        rows.append(
            [
                f"{word} [{entry['unit']}]",
                f"{number(entry['lower'])} to {number(entry['upper'])}",
                *(number(paper[name][i]) for name in paper),
                *(number(best[name][word]["value"]) for name in paper),
                f"{number(min(values), 3)} to {number(max(values), 3)}",
                entry["verdict"],
            ]
        )
    ours = [f"{name.upper()} here" for name in paper]
    return table(
        ["parameter", "bounds", "RGA paper", "PSO paper = stage", "CSA paper", *ours, "all runs", "verdict"], rows
    )


def ratios(result: Result, axis: str) -> str:
    """Table 5 or 6 as ratios to PSO, which outlive the computer and the noise of the stage."""
    rmse = {row["optimizer"]: row["rmse_median"] for row in result["league"]}
    cost = {row["optimizer"]: row["cpu_seconds_median"] / row["evaluations"] for row in result["league"]}
    rows = []
    for name, (score, seconds) in SCORES[axis].items():
        base_score, base_seconds = SCORES[axis]["pso"]
        rows.append(
            [
                NAMES[name],
                f"{score:.6f}",
                number(score / base_score, 5),
                number(rmse[name] / rmse["pso"]),
                seconds,
                number(seconds / base_seconds, 3),
                number(cost[name] / cost["pso"], 2),
                number(1e6 * cost[name], 2),
            ]
        )
    header = ["optimizer", "RMSE paper [um]", "over PSO, paper", "over PSO, here", "time paper [s]", "over PSO, paper"]
    return table([*header, "CPU an evaluation over PSO, here", "us an evaluation, here"], rows)


def text(results: Mapping[str, Result]) -> str:
    parts = []
    for number_of, axis in enumerate("xy"):
        result = results[axis]
        parts += [
            f"**Table {3 + number_of}, axis {axis.upper()}: identified values**\n\n{identified(result, axis)}",
            f"**Table {5 + number_of}, axis {axis.upper()}: against the paper**\n\n{ratios(result, axis)}",
            f"**Axis {axis.upper()}: all optimizers at equal evaluations**\n\n{league(result)}",
        ]
    return "\n\n".join(parts)


if __name__ == "__main__":
    command(text)
