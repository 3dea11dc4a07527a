"""What five models of memory reach on reversal curves of a thin film."""

from __future__ import annotations

from collections.abc import Mapping

from experiments.tables import Result, command, number, parameters, table

JOBS = {
    "bouc_wen": "Bouc-Wen",
    "plays": "eight plays",
    "domain_wall": "domain walls",
    "homogenized_energy": "homogenized energy",
    "free_density": "free density",
}


def text(results: Mapping[str, Result]) -> str:
    rows, each = [], []
    for job, said in JOBS.items():
        best = results[job]["best"]
        errors = [number(best["rmse"][use], 3) for use in ("identify", "validate")]
        rows.append([said, len(best["parameters"]), *errors])
        each.append([said, *(number(record["rmse"]["p"], 2) for record in results[job]["records"])])
    unit = results["bouc_wen"]["unit"]
    names = [f"{record['name']} ({record['use']})" for record in results["bouc_wen"]["records"]]
    return "\n\n".join(
        [
            table(["model", "free parameters", f"identify [{unit}]", f"validate [{unit}]"], rows),
            table(
                [f"RMSE [{unit}] of the curve", *(row[0] for row in each)],
                zip(names, *(row[1:] for row in each), strict=True),
            ),
            f"**{JOBS['homogenized_energy']}**",
            parameters(results["homogenized_energy"]),
        ]
    )


if __name__ == "__main__":
    command(text)
