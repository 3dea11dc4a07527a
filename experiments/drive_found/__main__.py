"""python -m experiments.drive_found FOLDER ...: is the drive that was played found from the displacement it caused?

Each FOLDER is what `pzt-ident improve` wrote.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import click
import h5netcdf
import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from experiments.tables import number, table
from pzt_ident.run.identified import read_identified

Array = NDArray[np.float64]
BAND = 50.0  # Hz, of the low-pass ahead of the inverse: to hysteresis, noise is a reversal at every other sample
HEADER = ("record", "model", "samples", "range [V]", "drive error, RMS", "of the range", "largest")


@click.command()
@click.argument("folders", nargs=-1, required=True, type=click.Path(path_type=Path))
def main(folders: tuple[Path, ...]) -> None:
    rows = [row for folder in folders for name in records(folder) for row in compared(folder, name)]
    click.echo(table(HEADER, rows))


def records(folder: Path) -> list[str]:
    with h5netcdf.File(folder / "signals.nc") as file:
        return list(file.groups)


def compared(folder: Path, record: str) -> list[list[str]]:
    """A row for the model as given, and one for the improved one."""
    rows = []
    for as_given, model in ((True, "as given"), (False, "improved")):
        time, drive, displacement, settle = signals(folder, record, as_given)
        scored = time >= settle
        error = (inverted(folder, time, displacement, as_given) - drive)[scored]
        size = np.ptp(drive)
        rms = np.sqrt(np.mean(error**2))
        largest = np.abs(error).max()
        cells = number(size), f"{number(rms, 3)} V", f"{rms / size:.2%}", f"{number(largest, 3)} V"
        rows.append([record, model, str(scored.sum()), *cells])
    return rows


def signals(folder: Path, record: str, as_given: bool) -> tuple[Array, Array, Array, float]:
    """Time, measured drive, and the displacement behind a low-pass, without the offset that the model leaves to the
    record; the time, s, at the start that the fit does not score."""
    with h5netcdf.File(folder / ("signals_as_given.nc" if as_given else "signals.nc")) as file:
        columns = [np.asarray(file[record][name][:]) for name in ("time", "drive_x", "response_x", "model_x")]
        settle = float(file[record].attrs["settle"])
    time, drive, response, model = columns
    stage = read_identified(folder, as_given=as_given).stage((time[-1] - time[0]) / (time.size - 1))
    simulated = 1e6 * stage.respond(drive[None])[0]
    rate = (time.size - 1) / (time[-1] - time[0])
    smooth = sosfiltfilt(butter(4, BAND, fs=rate, output="sos"), response) if rate > 4 * BAND else response
    return time - time[0], drive, smooth - np.mean(model - simulated), settle


def inverted(folder: Path, time: Array, displacement: Array, as_given: bool) -> Array:
    """The drive that the command finds for a displacement."""
    program = Path(sys.executable).with_name("pzt-ident")
    with TemporaryDirectory() as scratch:
        reference, out = Path(scratch) / "reference.csv", Path(scratch) / "drive.csv"
        np.savetxt(reference, np.transpose([time, displacement]), "%.12g", ",", header="time [s],x [um]", comments="")
        line = [program, "drive", folder, "--reference", reference, "-o", out, *(["--as-given"] if as_given else [])]
        subprocess.run(line, check=True, capture_output=True)
        return np.loadtxt(out, delimiter=",", skiprows=1)[:, 1]


if __name__ == "__main__":
    main()
