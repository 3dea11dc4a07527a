"""python -m experiments.trust jobs | files | cuts | kills | surroundings | numerics | constraints | versions"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Iterator
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import click

CAMPAIGNS = (
    ("jobs", 500, "malformed:job_cases", "Malformed jobs."),
    ("files", 500, "malformed:file_cases", "Malformed data files."),
    ("cuts", 60, "kills:cuts", "Power cuts, so many a command, at writes spread over it."),
    ("kills", 40, "kills:chances", "Processes that are killed by chance."),
    ("surroundings", 55, "surroundings:cases", "Full disks, no HOME, a clock that goes back."),
    ("numerics", 96, "numerics:cases", "The same measurement in other units, names and orders, and thinned."),
)
"""Names, numbers of cases, what draws them and sentences."""


@click.group()
def main() -> None:
    """Break, kill and turn round what pzt-ident works on, and count what comes of it."""


def count(name: str, rows: Iterable[dict[str, Any]], out: Path) -> None:
    """Write the rows of a campaign and print how many came to what, with those that are wrong."""
    out.mkdir(parents=True, exist_ok=True)
    counts: dict[str, int] = {}
    with (out / f"{name}.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, ("case", "how", "came", "faults"), lineterminator="\n")
        table.writeheader()
        for row in rows:
            table.writerow(row)
            file.flush()
            for key in ("cases", row["came"], *["wrong"] * bool(row["faults"])):
                counts[key] = counts.get(key, 0) + 1
            if row["faults"]:
                click.echo(f"{row['case']}: {row['how']}: {row['came']}: {row['faults']}")
    click.echo(f"{name}: " + ", ".join(f"{number} {key}" for key, number in counts.items()))


def in_scratch(draw: Callable[[range, int, Path], Iterable[Any]], cases: int, seed: int) -> Iterator[dict[str, Any]]:
    with TemporaryDirectory(prefix="trust-", ignore_cleanup_errors=True) as scratch:
        Path(scratch).chmod(0o755)
        for case in draw(range(cases), seed, Path(scratch)):
            yield case.row()


def campaign(name: str, cases: int, drawn_by: str, sentence: str) -> None:
    """Add the command of a campaign."""

    @main.command(name, help=sentence)
    @click.option("--seed", type=int, required=True)
    @click.option("--cases", type=int, default=cases, show_default=True)
    @click.option("--out", type=click.Path(path_type=Path), default=Path("results/trust"), show_default=True)
    def command(seed: int, cases: int, out: Path) -> None:
        module, _, function = drawn_by.partition(":")
        draw = getattr(import_module(f"experiments.trust.{module}"), function)
        count(name, in_scratch(draw, cases, seed), out)


for entry in CAMPAIGNS:
    campaign(*entry)


@main.command()
def constraints() -> None:
    """Print the oldest versions of the dependencies that are allowed, as a constraints file of pip."""
    from experiments.trust.versions import oldest

    click.echo("\n".join(oldest()))


@main.command()
@click.argument("python")
@click.option("--oldest", is_flag=True, help="With the oldest versions instead of the newest.")
def versions(python: str, oldest: bool) -> None:
    """Install the package from wheels for PYTHON, let it work, and print what it identified."""
    from experiments.trust import versions

    with TemporaryDirectory(prefix="trust-") as scratch:
        mine = versions.installed(python, Path(scratch), list(versions.oldest()) if oldest else [])
        for name, value in versions.at_work(mine, Path(scratch)).items():
            click.echo(f"{name}: {value!r}")


if __name__ == "__main__":
    main()
