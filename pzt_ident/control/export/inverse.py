"""The inverse of an identified model as C: previews of its dynamics around a root a sample of its material."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.control.identified import Identified
from pzt_ident.control.inverse import RANGE, Inverse
from pzt_ident.control.preview import Preview
from pzt_ident.control.stage import MATERIAL
from pzt_ident.control.statics import is_linear
from pzt_ident.engine import realtime, root
from pzt_ident.errors import InputError

Array = NDArray[np.float64]
LONGEST = 300  # samples of preview
TRIALS = 120  # of an input in a sample
ROOTS = (("begin", 6), ("propose", 2))


class Exportable:
    """What the C of an inverse holds. `refused`: why there is none, empty otherwise."""

    def __init__(self, identified: Identified, wanted: bool) -> None:
        self.identified, self.refused = identified, "" if wanted else "it was not asked for"
        if not wanted:
            return
        stage, size = identified.stage(), float(np.abs(identified.range).max())
        try:
            self.inverse = Inverse(stage, size)
        except InputError as error:
            self.refused = f"{error.where} {error.message}"
            return
        if any(block.kind == "relays" for block in stage.model.blocks):
            self.refused = "relays are too slow to be solved for their input in real time"
            return
        if not all(is_linear(stage, axis, self.reach(axis)) for axis in stage.model.measured):
            self.refused = "the mechanics are not linear"
            return
        self.mechanics, self.actuation = self.inverse.mechanics, self.inverse.actuation
        if self.latency > LONGEST:
            self.refused = f"the previews of its dynamics take {self.latency} samples"

    def reach(self, axis: int) -> float:
        """The largest displacement of the test vector, SI units."""
        response = self.identified.test_vector[1][self.identified.outputs.index(axis)]
        return float(np.abs(response).max()) * self.identified.scale(axis)[1] or 1.0

    @property
    def latency(self) -> int:
        return self.mechanics.ahead + self.actuation.ahead

    @property
    def reference(self) -> Array:
        """The response of the test vector on all axes, SI units."""
        response = self.identified.test_vector[1]
        reference = np.zeros((len(self.identified.range), response.shape[1]))
        for row, axis in zip(response, self.identified.outputs, strict=True):
            reference[axis] = row * self.identified.scale(axis)[1]
        return reference

    def drive(self) -> Array:
        """The drive for that reference, in the user's units."""
        asked = self.inverse.once(self.reference, self.reference).asked
        return np.array([row / self.identified.scale(axis)[0] for axis, row in enumerate(asked)])

    def facts(self, number: Any) -> dict[str, Any]:
        """For the templates. number: a number as text."""
        slopes = self.inverse.slopes
        diagonal = np.diag(slopes)
        force = np.abs(self.mechanics(self.reference)).max(axis=1)
        axes = range(len(slopes))
        return {
            "latency": self.latency,
            "previews": [
                self.filter(self.mechanics, "reference", "force", number),
                self.filter(self.actuation, "input", "drive", number),
            ],
            "free": [int(axis in self.identified.outputs) for axis in axes],
            "slopes": [number(value) for value in diagonal],
            "mixing": [[number(value) for value in row] for row in diagonal[:, None] * np.linalg.inv(slopes)],
            "most": number(RANGE * self.inverse.size),
            "exact": [number(realtime.EXACT * value) for value in force],
            "sweeps": realtime.SWEEPS if len(self.identified.outputs) > 1 else 1,
            "size": root.SIZE,
            "trials": TRIALS,
        }

    def filter(self, preview: Preview, enters: str, leaves: str, number: Any) -> dict[str, Any]:
        rows = [[", ".join(map(number, taps)) for taps in row] for row in preview.taps]
        return {
            "enters": enters,
            "leaves": leaves,
            "length": preview.taps.shape[2],
            "ahead": preview.ahead,
            "rows": [] if preview.is_identity else rows,
        }

    def operations(self) -> list[Any]:
        """The steps of the material."""
        return self.identified.stage().operations(MATERIAL, self.inverse.without)
