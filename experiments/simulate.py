"""One simulation by the public parts of the package, and how an experiment keeps its figure and table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks

Array = NDArray[np.float64]
REFERENCE = Path(__file__).parents[1] / "results" / "reference"


def record(drive: Array, dt: float) -> Record:
    """A drive without a measurement."""
    return Record("made up", "identify", dt, drive[None], np.zeros((1, drive.size)))


def simulator(
    chain: Sequence[Any], parameters: Mapping[str, float], drive: Array, dt: float
) -> tuple[Simulator, Array]:
    """Words (or blocks with settings) made ready for a drive, and the parameters in their order, SI units."""
    chosen = [blocks[item] if isinstance(item, str) else item for item in chain]
    model = Chain(chosen, ("x",), (0,))
    return Simulator(model, record(drive, dt)), np.array([[parameters[name] for name in model.names]])


def simulate(chain: Sequence[Any], parameters: Mapping[str, float], drive: Array, dt: float) -> Array:
    made, theta = simulator(chain, parameters, drive, dt)
    return made.simulate(theta)[0, 0]


def named(word: str, values: Mapping[str, float]) -> dict[str, float]:
    return {f"{word}.{name}": value for name, value in values.items()}


def keep(experiment: str, name: str, figure: Any, text: str) -> None:
    """The figure as SVG and PNG and the tables, into the reference results; the tables are printed too."""
    folder = REFERENCE / experiment
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / f"{name}.svg", metadata={"Date": None})
    figure.savefig(folder / f"{name}.png", dpi=150)
    (folder / f"{name}.md").write_text(text + "\n", encoding="utf-8")
    print(text)
