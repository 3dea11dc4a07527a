"""python -m experiments.trust jobs | files | kills | surroundings | numerics | constraints | versions"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import click

OUT = click.option("--out", type=click.Path(path_type=Path), default=Path("results/trust"), show_default=True)
SEED = click.option("--seed", type=int, required=True)


def cases(default: int) -> Any:
    return click.option("--cases", type=int, default=default, show_default=True)


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


@main.command()
@SEED
@cases(500)
@OUT
def jobs(seed: int, cases: int, out: Path) -> None:
    """Malformed jobs."""
    from experiments.trust.malformed import job_cases

    count("jobs", in_scratch(job_cases, cases, seed), out)


@main.command()
@SEED
@cases(500)
@OUT
def files(seed: int, cases: int, out: Path) -> None:
    """Malformed data files."""
    from experiments.trust.malformed import file_cases

    count("files", in_scratch(file_cases, cases, seed), out)


@main.command()
@SEED
@cases(60)
@OUT
def cuts(seed: int, cases: int, out: Path) -> None:
    """Power cuts, so many a command, at writes spread over it."""
    from experiments.trust.kills import cuts

    count("cuts", in_scratch(cuts, cases, seed), out)


@main.command()
@SEED
@cases(40)
@OUT
def kills(seed: int, cases: int, out: Path) -> None:
    """Processes that are killed by chance."""
    from experiments.trust.kills import chances

    count("kills", in_scratch(chances, cases, seed), out)


@main.command()
@SEED
@cases(60)
@OUT
def surroundings(seed: int, cases: int, out: Path) -> None:
    """Full disks, no HOME, a clock that goes back."""
    from experiments.trust.surroundings import cases as draw

    count("surroundings", in_scratch(draw, cases, seed), out)


@main.command()
@SEED
@cases(96)
@OUT
def numerics(seed: int, cases: int, out: Path) -> None:
    """The same measurement in other units, under other names, in another order and by every second sample."""
    from experiments.trust.numerics import cases as draw

    count("numerics", in_scratch(draw, cases, seed), out)


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
