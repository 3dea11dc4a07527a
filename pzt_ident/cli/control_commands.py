"""The commands that put an identified model to work."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pzt_ident.cli.options import EXISTING, Command, answer, output_options, plugins_flag

if TYPE_CHECKING:
    from pzt_ident.api.drive import Drive


class Ends(click.ParamType):
    """Lowest and highest value: `-20:150`."""

    name = "low:high"

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[float, float]:
        low, _, high = str(value).partition(":")
        try:
            return float(low), float(high)
        except ValueError:
            self.fail(f"{value!r} is no range: write it as -20:150", param, ctx)


class Quantity(click.ParamType):
    """A number with a unit of a kind, in SI units: `50 mA`, `1.8uF`."""

    name = "quantity"

    def __init__(self, unit: str) -> None:
        self.unit = unit

    def convert(self, value: Any, param: Any, ctx: Any) -> float:
        from pzt_ident.api.arguments import quantity_of

        size = quantity_of(str(value), self.unit)
        if size is None or not size > 0:
            self.fail(f"{value!r} is no quantity above zero: write it in {self.unit}", param, ctx)
        return size


def reference_options(command: Command) -> Command:
    """RESULT, --reference and what the amplifier can do."""
    options: list[Any] = [
        click.option("--reference", type=EXISTING, required=True, help="File with the displacement to follow."),
        click.option("--rate", help="Sample rate of a reference without a column of time, such as 10kHz."),
        click.option("--limits", type=Ends(), help="Lowest and highest drive, such as -20:150; those of the job."),
        click.option("--slew", type=float, help="Largest change of the drive in a second; that of the job."),
        click.option("--current", type=Quantity("A"), help="Of the amplifier, such as 50mA; needs --capacitance."),
        click.option("--capacitance", type=Quantity("F"), help="Of the actuator, such as 1.8uF."),
        click.option("--noise-gain", type=click.FloatRange(min=1), default=10.0, show_default=True, help=GAIN),
        click.option("--as-given", is_flag=True, help="Of an improvement take the model that it started from."),
        click.option("--coupled", is_flag=True, help="Do not make up for what acts from axis to axis."),
    ]
    for option in reversed([click.argument("result", type=EXISTING), *options]):
        command = option(command)
    return plugins_flag(output_options(command))


LATE = "Computing delay: samples from a reading to the drive that answers it."
GAIN = "The most by which dynamics are made up for, over their static gain."


@click.command()
@reference_options
@click.option("--held", is_flag=True, help="For a converter that holds each sample: half a sample earlier.")
@click.option("-o", "--out", type=EXISTING, required=True, help="The drive, as CSV.")
def drive(result: Path, out: Path, as_json: bool, quiet: bool, **options: Any) -> None:
    """Write the drive under which the stage of a folder RESULT follows a reference."""
    solution = solved(result, **options)
    solution.save(out)
    answer(facts_of(solution) | {"file": str(out)}, lambda: click.echo(f"{solution}\nwrote {out}"), as_json, quiet)


@click.command()
@reference_options
@click.option("--record", type=EXISTING, help="File with the displacement that the stage took, to be put beside.")
@click.option("--delay", type=click.IntRange(min=0), default=1, show_default=True, help=LATE)
@click.option("--count", type=click.FloatRange(min=0), default=0.0, help="Of the sensor, in the unit of the data.")
@click.option("--kp", type=float, help="Proportional gain, drive per response; as `tune` finds it if not given.")
@click.option("--ki", type=float, help="Integral gain, drive per response and second.")
@click.option("--out", type=EXISTING, required=True, help="Folder for table, signals and figure.")
def control(
    result: Path,
    out: Path,
    plugins: bool,
    reference: Path,
    rate: str | None,
    as_given: bool,
    record: Path | None,
    as_json: bool,
    quiet: bool,
    **options: Any,
) -> None:
    """Compare how well the stage of a folder RESULT follows a reference: in open loop, by its inverse, and with PI."""
    from pzt_ident.api.reference import read_reference
    from pzt_ident.api.tracking import control
    from pzt_ident.run.identified import read_identified

    identified = read_identified(result, plugins, as_given)
    measured = read_reference(record, identified, rate) if record else None
    loop = {word: options.pop(word) for word in ("delay", "count", "kp", "ki")}
    wanted = read_reference(reference, identified, rate)
    comparison = control(identified, wanted, measured=measured, **loop, **amplifier(**options))
    comparison.save(out)
    answer(comparison.facts | {"folder": str(out)}, lambda: click.echo(f"{comparison}\nwrote {out}"), as_json, quiet)


@click.command()
@click.argument("result", type=EXISTING)
@click.option("--rate", required=True, help="Sample rate of the controller, such as 1kHz.")
@click.option("--delay", type=click.IntRange(min=0), default=1, show_default=True, help=LATE)
@click.option("--gain-margin", type=click.FloatRange(min=1), default=2.0, show_default=True, help="A factor.")
@click.option("--phase-margin", type=click.FloatRange(0, 90), default=60.0, show_default=True, help="Degrees.")
@click.option("--axis", help="One axis; every measured one if not given.")
@plugins_flag
@output_options
def tune(result: Path, rate: str, plugins: bool, as_json: bool, quiet: bool, **options: Any) -> None:
    """Find the PI gains for the stage of a folder RESULT that keep stated margins."""
    from pzt_ident.api.tuning import tune
    from pzt_ident.run.identified import read_identified

    tuning = tune(read_identified(result, plugins), rate, **options)
    answer(tuning.facts, lambda: click.echo(str(tuning)), as_json, quiet)


def solved(
    result: Path, plugins: bool, reference: Path, rate: str | None, as_given: bool = False, **options: Any
) -> Drive:
    from pzt_ident.api.drive import drive
    from pzt_ident.api.reference import read_reference
    from pzt_ident.run.identified import read_identified

    identified = read_identified(result, plugins, as_given)
    record = read_reference(reference, identified, rate)
    return drive(identified, record, **amplifier(**options))


def amplifier(
    current: float | None, capacitance: float | None, slew: float | None, coupled: bool, **options: Any
) -> dict[str, Any]:
    """The options of `api.drive`; a current through a capacitance limits the slew rate."""
    from pzt_ident.errors import InputError

    if (current is None) != (capacitance is None):
        missing, given = ("--capacitance", "--current") if current else ("--current", "--capacitance")
        raise InputError(f"{given} limits nothing alone", where=given, remedy=f"give {missing} too")
    rates = [rate for rate in (slew, current and current / (capacitance or 1)) if rate]
    return {**options, "decoupled": not coupled, "slew": min(rates, default=None)}


def facts_of(solution: Drive) -> dict[str, Any]:
    return {
        "units": dict(solution.units),
        "drive_units": dict(solution.drive_units),
        "rmse": solution.rmse,
        "peak": solution.peak,
        "drive": {axis: [float(u.min()), float(u.max())] for axis, u in solution.drive.items()},
        "notes": list(solution.notes),
    }


@click.command()
@click.argument("result", type=EXISTING)
@click.option("--to", "to", required=True, help="What to write: c, fmu, matlab, csv or json.")
@click.option("--out", type=EXISTING, required=True, help="Folder for the files.")
@click.option("--precision", default="double", help="Of the C: double, the default, or float.")
@click.option("--rate", help="Sample rate of the controller, such as 10kHz; that of the records if not given.")
@plugins_flag
@output_options
def export(
    result: Path, to: str, out: Path, precision: str, rate: str | None, plugins: bool, as_json: bool, quiet: bool
) -> None:
    """Write an identified model for other programs: RESULT is a folder of results, or an exported JSON."""
    from pzt_ident.api.controlled import written
    from pzt_ident.run.identified import read_identified

    files = [str(path) for path in written(read_identified(result, plugins), out, to, precision, rate)]
    answer({"files": files}, lambda: click.echo("\n".join(f"wrote {file}" for file in files)), as_json, quiet)
