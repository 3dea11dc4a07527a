"""A model with its parameters, read from the JSON of an export."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.api.arguments import Signals, path_of, rate_or_stamps, writable
from pzt_ident.api.fitted import Parameter, Parameters, columns
from pzt_ident.api.printed import table_text
from pzt_ident.api.record import Record
from pzt_ident.api.statement import drive_record
from pzt_ident.control.export import export
from pzt_ident.control.identified import Identified
from pzt_ident.data.notation import unit, with_error
from pzt_ident.data.record import Record as Signal
from pzt_ident.engine.simulator import simulate
from pzt_ident.errors import InputError
from pzt_ident.run.identified import of_json


class Simulation:
    """What an identification found, without its records: parameters by name, and the response to any drive."""

    def __init__(self, identified: Identified) -> None:
        self.identified = identified

    @property
    def name(self) -> str:
        return self.identified.name

    @property
    def parameters(self) -> Parameters:
        """By name, in the units of the data."""
        one = self.identified
        items = zip(one.chain.names, one.units, one.errors, strict=True)
        return Parameters(
            {
                name: Parameter(name, one.value(i), error, of, None, "exported")
                for i, (name, of, error) in enumerate(items)
            }
        )

    def simulate(self, t: ArrayLike | str | Record, u: Signals | None = None) -> NDArray[np.float64]:
        """As `Fit.simulate`."""
        record = drive_record(t, u, blank_record(self.identified))
        responses = simulate(self.identified.chain, record, self.identified.theta[None])[0]
        return columns(responses, [*record.units.values()])

    def export(self, folder: str | Path, to: str = "c", precision: str = "double", rate: Any = None) -> list[Path]:
        """As `Fit.export`."""
        return written(self.identified, folder, to, precision, rate)

    def __repr__(self) -> str:
        rows = [[p.name, with_error(p.value, p.stderr), unit(p.unit)] for p in self.parameters.values()]
        return f"{self.name}\n\n{table_text(['parameter', 'value', 'unit'], rows)}"


def load_json(path: str | Path) -> Simulation:
    """Raises InputError for a file that is no exported JSON."""
    return Simulation(of_json(path_of(path, "load")))


def export_fit(fit: Any, folder: str | Path, to: str, precision: str, rate: Any) -> list[Path]:
    return written(fit.identified, folder, to, precision, rate)


def written(identified: Identified, folder: str | Path, to: str, precision: str, rate: Any) -> list[Path]:
    """Export at a sample rate, by default that of the identification."""
    folder = path_of(folder, "export")
    chosen = identified if rate is None else replace(identified, dt=sample_time(rate))
    with writable(folder):
        return export(chosen, folder, to, precision)


def sample_time(rate: str | float) -> float:
    """s, of a rate such as `10kHz`. Raises InputError for what is no rate."""
    hertz = rate_or_stamps(rate, "rate")[0]
    if hertz is None:
        raise InputError(f"{rate!r} is no sample rate", where="rate", remedy="give text such as '10kHz'")
    return 1 / hertz


def blank_record(identified: Identified) -> Signal:
    """A record with the axes and units of a model, and nothing measured."""
    drive = np.zeros((len(identified.drive_units), 1))
    return Signal(
        identified.name,
        "validate",
        identified.dt,
        drive,
        np.full(drive.shape, np.nan),
        axes=identified.chain.axes,
        drive_units=identified.drive_units,
        response_units=identified.response_units,
    )
