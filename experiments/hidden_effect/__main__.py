"""python -m experiments.hidden_effect draw | solve | score"""

from __future__ import annotations

from pathlib import Path

import click

from experiments.hidden_effect import cases

FOLDER = click.Path(file_okay=False, path_type=Path)
ON = click.option("--on", default="", help="Where the commands work, as of `pzt-ident improve --on`.")


@click.group()
def main() -> None:
    """Hide effects in a virtual stage, let pzt-ident find them, and count."""


@main.command()
@click.option("--seed", type=int, required=True, help="Seed of the first case; the next ones count on.")
@click.option("--cases", "count", type=click.IntRange(1), default=1, show_default=True)
@click.option("--kind", type=click.Choice(list(cases.KINDS)), required=True)
@click.option("--effect", type=click.Choice(list(cases.EFFECTS)), help="This one instead of one by chance.")
@click.option("--out", type=FOLDER, required=True)
def draw(seed: int, count: int, kind: str, effect: str | None, out: Path) -> None:
    """Write cases/NAME with records and job, and sealed/NAME.json with the truth."""
    for number in range(seed, seed + count):
        case, truth = cases.draw(kind, number, effect)
        cases.write(case, truth, out)
        click.echo(case.name)


@main.command()
@click.argument("folder", type=FOLDER)
@click.option("--workers", type=click.IntRange(1), default=2, show_default=True)
@click.option("--retry", is_flag=True, help="Try again what failed before.")
@ON
def solve(folder: Path, workers: int, retry: bool, on: str) -> None:
    """Run `pzt-ident improve` on each case of FOLDER that has no result yet, --workers of them at once."""
    from experiments.hidden_effect.solve import solve

    for case in solve(folder, workers, retry, on):
        click.echo(f"{case.name}: failed, see {folder / 'solved' / case.name}", err=True)


@main.command()
@click.argument("folder", type=FOLDER)
@click.option("--out", type=FOLDER, help="Default: FOLDER/score.")
@ON
def score(folder: Path, out: Path | None, on: str) -> None:
    """Hold the results in FOLDER against the truth: tables, confusion matrix and staircases."""
    from experiments.hidden_effect import figures, score

    out = out or folder / "score"
    scores, failed = score.score(folder, on)
    score.write(scores, failed, out)
    if scores:
        figures.draw(scores, out)
    click.echo((out / "score.json").read_text(encoding="utf-8"), nl=False)


if __name__ == "__main__":
    main()
