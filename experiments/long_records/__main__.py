"""python -m experiments.long_records growth | run | verdicts"""

from __future__ import annotations

from pathlib import Path

import click

HERE = Path(__file__).parents[2] / "results"


@click.group()
def main() -> None:
    """What long records cost, and whether fewer samples lead to the same verdict."""


@main.command()
@click.option("--out", type=click.Path(path_type=Path), default=HERE / "reference" / "long_records")
@click.option("--most", default=10_000_000, show_default=True, help="Samples of the longest record.")
def growth(out: Path, most: int) -> None:
    """Measure search, polish and errors against samples, records, axes and parameters; tables and pictures."""
    from experiments.long_records.growth import measure_all

    click.echo(measure_all(out, most))


@main.command()
@click.option("--out", type=click.Path(path_type=Path), default=HERE / "long_records" / "run")
@click.option("--samples", default=10_000_000, show_default=True)
@click.option("--form", type=click.Choice(["npy", "csv"]), default="npy", show_default=True)
def run(out: Path, samples: int, form: str) -> None:
    """Time and memory of `pzt-ident run` for one record, from the file to the report."""
    from experiments.long_records.whole import measured

    click.echo(measured(out / f"{samples}-{form}", samples, form))


@main.command()
@click.option("--out", type=click.Path(path_type=Path), default=HERE / "long_records")
@click.option("--seed", default=9000, show_default=True, help="Of the first case of each kind.")
@click.option("--workers", type=click.IntRange(1), default=2, show_default=True)
def verdicts(out: Path, seed: int, workers: int) -> None:
    """Improve the same cases with all samples and with fewer, and count which verdicts turn."""
    from experiments.long_records.verdicts import KINDS, compare, table

    found = []
    for one in compare(out, KINDS, seed, workers):
        found.append(one)
        click.echo(table(found[-1:]))
    click.echo(table(found))


if __name__ == "__main__":
    main()
