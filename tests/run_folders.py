"""Run folders as `pzt-ident run` leaves them, made up: a plain NumPy hysteresis loop beside a slightly wrong model."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import h5netcdf
import numpy as np

WEIRD = "<script>alert('x')</script> 100%_µ & \"q\" $a_1$.csv"
PARAMETERS = {
    "bouc_wen.gain": (0.08195, "um/V", 0.0, 0.16, 0.00012, "determined", ""),
    "bouc_wen.alpha": (0.02114, "um/V", 0.0, 0.08, 0.00031, "determined", ""),
    "bouc_wen.beta": (0.02507, "1/V", 0.0, 0.2, 0.0014, "determined", ""),
    "bouc_wen.gamma": (0.0, "1/V", 0.0, 0.2, None, "on its lower bound", "The data would take a smaller value."),
    "lumped.mass": (0.31, "kg", 1e-3, 10.0, 45.0, "not determined", "These drives are too slow to move the mass."),
    "lumped.damping": (812.0, "N s/m", 1.0, 1e5, 9.1e4, "not determined", "Too slow for damping to show."),
    "lumped.stiffness": (1.2e7, "N/m", 1e4, 1e9, None, "fixed", "Fixed in the job."),
}


def bouc_wen(drive, gain, alpha, beta, gamma):
    response, h = np.empty_like(drive), 0.0
    for i, du in enumerate(np.diff(drive, prepend=drive[0]).tolist()):
        h += alpha * du - beta * abs(du) * h - gamma * du * abs(h)
        response[i] = gain * drive[i] - h
    return response


def drive_of(use: str, time):
    if use == "identify":
        phase = (0.5 * time) % 2.0
        return (100 - 6 * np.floor(0.25 * time)) * np.minimum(phase, 2.0 - phase)
    return 50 + sum(12 * np.sin(2 * np.pi * f * time + 1.7 * f**2) for f in (0.11, 0.23, 0.41, 0.67))


def write_signals(path: Path, records: list[dict[str, Any]], axes: tuple[str, ...], unit: str, rng) -> None:
    with h5netcdf.File(path, "w") as file:
        for record in records:
            group = file.create_group(record["name"])
            group.attrs.update(name=record["name"], use=record["use"], settle=record["settle"])
            group.dimensions = {"time": record["samples"]}
            time = np.arange(record["samples"]) / record["sample_rate"]
            channels = {"time": (time, "s")}
            for shift, axis in enumerate(axes):
                drive = drive_of(record["use"], time + 0.7 * shift)
                creep = 0.25 * np.log1p(time) * np.tanh(drive / 80)
                response = bouc_wen(drive, 0.0819, 0.021, 0.025, 0.004) + creep + 0.03 * rng.normal(size=time.size)
                model = bouc_wen(drive, 0.0855, 0.021, 0.025, 0.0) + 0.2
                for kind, values in {"response": response, "model": model, "residual": model - response}.items():
                    channels[f"{kind}_{axis}"] = (values, unit)
                channels[f"drive_{axis}"] = (drive, "V")
            for name, (values, of) in channels.items():
                group.create_variable(name, ("time",), data=values).attrs.update(units=of, long_name=name)


def histories(optimizers: tuple[str, ...], repeats: int, rng) -> list[str]:
    lines = ["optimizer,repeat,generation,evaluations,seconds,best"]
    for rank, optimizer in enumerate(optimizers):
        for repeat in range(repeats):
            excess, generations = 4.0, 60 - 20 * (repeat % 2)
            for generation in range(generations):
                excess *= 1 - (0.12 - 0.015 * rank) * rng.random()
                evaluations = 70 * (generation + 1)
                lines.append(
                    f"{optimizer},{repeat},{generation},{evaluations},{evaluations * 2e-5 * (1 + rank):.6f},"
                    f"{0.302 + excess:.9g}"
                )
    return lines


def run_of(optimizer: str, repeat: int, axes: tuple[str, ...], validate: bool, rng) -> dict[str, Any]:
    prefixes = [""] if len(axes) == 1 else [f"{axis}." for axis in axes]
    estimates = {}
    for prefix in prefixes:
        for name, (value, unit, lower, upper, error, verdict, note) in PARAMETERS.items():
            if verdict == "not determined":
                value = float(np.exp(rng.uniform(np.log(lower), np.log(upper))))
            elif verdict == "determined":
                value *= 1 + 0.02 * rng.normal()
            keys = ("value", "unit", "lower", "upper", "standard_error", "verdict", "note")
            estimates[prefix + name] = dict(zip(keys, (value, unit, lower, upper, error, verdict, note), strict=True))
    rmse = {"identify": 0.302 + 0.01 * repeat, "validate": 0.375 + 0.01 * repeat if validate else None}
    return {
        "run": f"{optimizer}-{repeat}",
        "optimizer": optimizer,
        "repeat": repeat,
        "rmse": rmse,
        "rmse_before_polish": {key: value and 1.07 * value for key, value in rmse.items()},
        "parameters": estimates,
        "evaluations": 4200,
        "polish_evaluations": 140,
        "evaluations_to_1_percent": None if repeat else 2310,
        "seconds": 0.284,
        "cpu_seconds": 0.271,
        "failed_simulations": 3 * repeat,
        "stopped_by": "evaluations",
    }


def league_of(optimizers: tuple[str, ...], repeats: int) -> list[dict[str, Any]]:
    return [
        {
            "optimizer": optimizer,
            "runs": repeats,
            "rmse_median": 0.3231 + 0.02 * rank,
            "rmse_lower_quartile": 0.3112 + 0.02 * rank,
            "rmse_upper_quartile": 0.3409 + 0.02 * rank,
            "rmse_best": 0.3102,
            "seconds_median": 0.284,
            "cpu_seconds_median": 0.284,
            "evaluations": 4200,
            "evaluations_to_1_percent_median": None if rank else 2310,
            "success": 1.0 - 0.2 * rank,
            "leader_ahead": repeats * (rank > 0),
            "pairs": repeats * (rank > 0),
            "sign_test": 2.0**-repeats if rank else 1.0,
            "polished_rmse_median": 0.3021,
        }
        for rank, optimizer in enumerate(optimizers)
    ]


def correlation_of(parameters: dict[str, Any], rng) -> dict[str, Any]:
    names = [name for name, entry in parameters.items() if entry["verdict"] != "fixed"]
    mixed = rng.normal(size=(len(names), 3 * len(names) // 2)) + 0.6
    matrix = np.corrcoef(mixed).tolist()
    matrix[-1] = [None] * len(names)
    for row in matrix:
        row[-1] = None
    return {"names": names, "matrix": matrix}


def make_run(
    folder: Path,
    *,
    axes: tuple[str, ...] = ("x",),
    samples: int = 800,
    names: tuple[str, ...] = ("minor_loops.csv", "multisine.csv"),
    uses: tuple[str, ...] = ("identify", "validate"),
    optimizers: tuple[str, ...] = ("pso", "rga", "csa"),
    repeats: int = 3,
    unit: str = "um",
    noise_floor: float | None = 0.049,
    failed: tuple[tuple[str, str], ...] = (),
    job: str = "name: x-axis\nmodel: [bouc_wen, lumped]  # <script>alert(1)</script>\n",
) -> Path:
    """Write a run folder and return it; records are `names` with `uses`."""
    rng = np.random.default_rng(7)
    folder.mkdir(parents=True, exist_ok=True)
    records = [
        {
            "name": name,
            "use": use,
            "file": f"data/{name}",
            "sha256": hashlib.sha256(name.encode()).hexdigest(),
            "samples": samples,
            "sample_rate": samples / 40,
            "settle": 1.0 if use == "identify" else 0.0,
            "axes": list(axes),
            "notes": ["decimated by 4"] if use == "validate" else [],
            "rmse": {axis: 0.30 + 0.075 * (use == "validate") + 0.01 * place for place, axis in enumerate(axes)},
        }
        for name, use in zip(names, uses, strict=True)
    ]
    runs = [run_of(name, repeat, axes, "validate" in uses, rng) for name in optimizers for repeat in range(repeats)]
    result = {
        "name": "x-axis",
        "unit": unit,
        "units": dict.fromkeys(axes, unit),
        "floor": noise_floor,
        "seed": 7,
        "noise_floor": dict.fromkeys(axes, noise_floor),
        "noise_floor_source": dict.fromkeys(axes, "rest segments"),
        "command": "pzt-ident run job.yaml",
        "records": records,
        "runs": runs,
        "best": runs[0] | {"correlation": correlation_of(runs[0]["parameters"], rng)},
        "league": league_of(optimizers, repeats),
        "failed_runs": [{"run": run, "reason": reason} for run, reason in failed],
        "created": "2025-03-14T09:26:53+00:00",
    }
    (folder / "result.json").write_text(json.dumps(result), encoding="utf-8")
    (folder / "history.csv").write_text("\n".join(histories(optimizers, repeats, rng)) + "\n", encoding="utf-8")
    write_signals(folder / "signals.nc", records, axes, unit, rng)
    environment = {"python": "3.12.1", "platform": "Linux", "cpu": "2 cores", "packages": {"numpy": "2.0.0"}}
    (folder / "environment.json").write_text(json.dumps(environment), encoding="utf-8")
    (folder / "job.yaml").write_text(job, encoding="utf-8")
    return folder
