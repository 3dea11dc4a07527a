"""python -m experiments.missing_effect run | table"""

from __future__ import annotations

from pathlib import Path

import click

from experiments.missing_effect import tracking

FOLDER = click.Path(file_okay=False, path_type=Path)
OUT = Path("results/missing_effect")


@click.group()
def main() -> None:
    """What tracking costs when an effect is missing from the inverse, and what is won once it is there."""


@main.command()
@click.option("--seeds", default="7000:7005", show_default=True, help="First seed, and the one behind the last.")
@click.option("--effects", default=",".join(tracking.EFFECTS), show_default=True)
@click.option("--out", type=FOLDER, default=OUT, show_default=True)
@click.option("--on", default="", help="Where models are improved, as of `pzt-ident improve --on`.")
def run(seeds: str, effects: str, out: Path, on: str) -> None:
    """Draw a stage with one hidden effect a seed, improve the model, drive the stage, and write what it did."""
    first, last = map(int, seeds.split(":"))
    for effect in effects.split(","):
        for seed in range(first, last):
            tracking.solve(effect, seed, out, on)
            click.echo(f"{effect}-{seed}")


@main.command()
@click.option("--out", type=FOLDER, default=OUT, show_default=True)
def table(out: Path) -> None:
    """Print medians and ranges over the seeds, and draw tracking.svg and tracking.png."""
    from experiments.missing_effect import figure

    rows = tracking.rows(out)
    click.echo(tracking.table(rows))
    figure.draw(rows, out, out / "tracking.svg")


if __name__ == "__main__":
    main()
