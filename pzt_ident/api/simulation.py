"""A model with its parameters, of an exported JSON or an improvement."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.api.arguments import Signals
from pzt_ident.api.controlled import Controlled
from pzt_ident.api.fitted import Parameter, Parameters, columns
from pzt_ident.api.printed import table_text
from pzt_ident.api.record import Record
from pzt_ident.api.statement import drive_record
from pzt_ident.control.identified import Identified
from pzt_ident.data.notation import unit, with_error
from pzt_ident.data.record import Record as Signal
from pzt_ident.engine.simulator import simulate
from pzt_ident.run.identified import read_identified


class Simulation(Controlled):
    """What an identification found, without its records: parameters by name, and the response to any drive."""

    def __init__(self, identified: Identified) -> None:
        self._identified = identified

    @property
    def identified(self) -> Identified:
        return self._identified

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

    def __repr__(self) -> str:
        rows = [[p.name, with_error(p.value, p.stderr), unit(p.unit)] for p in self.parameters.values()]
        return f"{self.name}\n\n{table_text(['parameter', 'value', 'unit'], rows)}"


def load_simulation(path: Path, plugins: bool = False) -> Simulation:
    """Raises InputError for what is no exported JSON and no improvement."""
    return Simulation(read_identified(path, plugins))


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
