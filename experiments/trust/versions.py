"""Pythons and the oldest versions of all dependencies that are allowed: installed from wheels alone, and at work."""

from __future__ import annotations

import json
import os
import subprocess
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path

from experiments.trust.good import write_good

ROOT = Path(__file__).parents[2]


def oldest(pyproject: Path = ROOT / "pyproject.toml") -> Iterator[str]:
    """A line `name==version` for each `name>=version` of the package and its extras, less the tools of its tests."""
    project = tomllib.loads(pyproject.read_text(encoding="utf-8"))["project"]
    extras = {name: lines for name, lines in project["optional-dependencies"].items() if name != "test"}
    for line in sorted({*project["dependencies"], *(line for lines in extras.values() for line in lines)}):
        name, _, version = line.partition(">=")
        yield f"{name}=={version}"


def installed(python: str, home: Path, constraints: Sequence[str] = ()) -> Path:
    """A virtual environment in `home` with the package, its extras and pytest; its Python. Raises CalledProcessError
    where there is no wheel of something, or its versions do not go together."""
    subprocess.run([python, "-m", "venv", home], check=True)
    mine = home / "bin" / "python"
    wheels = home / "constraints.txt"
    wheels.write_text("".join(f"{line}\n" for line in constraints))
    line = [mine, "-m", "pip", "install", "-q", "--only-binary", ":all:", "-c", wheels]
    subprocess.run([*line, f"{ROOT}[cluster,parquet]", "pytest", "hypothesis"], check=True)
    return mine


def installed_alone() -> dict[str, str]:
    """The environment without the folder of this checkout."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}


def at_work(python: Path, home: Path) -> dict[str, float]:
    """The parameters that the installed package identifies; it also draws, compares, exports, diagnoses and runs a
    lot. Raises CalledProcessError where a command fails."""
    job = write_good(home / "rig", 1).resolve()
    steps = (
        ["run", job, "--out", "run", "--workers", "1"],
        ["compare", "run"],
        ["export", "run", "--to", "c", "--out", "c"],
        ["improve", job, "--out", "improved", "--budget", "5s"],
        ["fleet", job, job.parent, "--out", "lot", "--workers", "1"],
        ["fleet", "report", "lot"],
    )
    for words in steps:
        line = [str(python), "-m", "pzt_ident", *map(str, words)]
        subprocess.run(line, cwd=home, env=installed_alone(), check=True, capture_output=True)
    best = json.loads((home / "run" / "result.json").read_text())["best"]
    return {name: parameter["value"] for name, parameter in best["parameters"].items()}
