"""What a drive does not do, or should not be trusted in: sentences."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from pzt_ident.control.identified import Identified
from pzt_ident.control.inverse import Feedforward, Inverse
from pzt_ident.data.notation import listed, percent, quantity, spelled
from pzt_ident.data.stretches import stretches
from pzt_ident.data.units import factor
from pzt_ident.model.block import Place

Array = NDArray[np.float64]

SHOWN = 3  # stretches of time that a sentence names
FASTER = 1.5  # over the identification, from which on a reference is called fast
FURTHER = 1.02  # over the identification, from which on a drive is called large
REACHED = 1e-6  # of the reference's range
RESTLESS = 0.1  # of its samples: a reference that turns back more often is called noisy


class Notes:
    """Sentences on a drive for a reference, in the user's units."""

    def __init__(self, inverse: Inverse, feedforward: Feedforward, identified: Identified) -> None:
        self.inverse, self.feedforward, self.identified = inverse, feedforward, identified
        self.model, self.dt = inverse.stage.model, inverse.stage.dt

    def sentences(self) -> tuple[str, ...]:
        topics = self.left_out, self.static, self.noisy, self.limited, self.unreached, self.wrong_way, self.new
        return tuple(sentence for topic in topics for sentence in topic())

    def left_out(self) -> Iterator[str]:
        """Blocks that the drive does not make up for."""
        blocks = self.inverse.stage.left_out
        readings = [b.name for b in blocks if not b.amounts() and b.place != Place.SLEW]
        disturbances = [block.name for block in blocks if block.amounts() and not block.lead]
        if readings:
            yield f"{listed(readings)} acts on the reading, not on the stage, and is not fed forward"
        if disturbances:
            yield f"{listed(disturbances)} of another record cannot be foreseen and is not fed forward"
        if any(block.place == Place.SLEW for block in blocks):
            yield "slew_limit is a limit: give it as one, with --slew"
        if still := [self.model.axes[a] for a in np.flatnonzero(~self.feedforward.drive.any(axis=1))]:
            yield f"the drive of {listed(still)} is zero throughout"

    def static(self) -> Iterator[str]:
        if self.inverse.mechanics.rings:
            yield "the mechanics ring without an end, so that only their static gain is fed forward"

    def noisy(self) -> Iterator[str]:
        """Where a reference turns as often as a measured signal does."""
        for axis, name, _ in self._axes("response_units"):
            moves = np.diff(self.feedforward.reference[axis])
            turns = float(np.mean(moves[1:] * moves[:-1] < 0)) if moves.size > 1 else 0.0
            if turns > RESTLESS:
                yield (
                    f"{name}: the reference turns back at {percent(turns)} of its samples, as noise does; each is a "
                    "loop of its own to hysteresis: smooth it first"
                )

    def limited(self) -> Iterator[str]:
        """Where the amplifier does not follow."""
        for axis, name, unit in self._axes("drive_units"):
            where, asked = self.feedforward.limited[axis], self.feedforward.asked[axis] / factor(unit)
            if where.any():
                short = np.abs(asked - self.feedforward.drive[axis] / factor(unit)).max()
                most = asked[where][np.argmax(np.abs(asked[where]))]
                yield spelled(
                    f"{name}: beyond the limits of the amplifier {self._times(where)}; the reference asks for up to "
                    f"{quantity(most, unit)}, the drive falls short by up to {quantity(short, unit)}"
                )

    def unreached(self) -> Iterator[str]:
        """Where no drive leads to the reference."""
        for axis, name, unit in self._axes("response_units"):
            missed = np.abs(self.feedforward.missed[axis])
            where = missed > REACHED * np.ptp(self.feedforward.reference[axis])
            if where.any():
                most = quantity(missed.max() / factor(unit), unit)
                yield spelled(f"{name}: no drive reaches the reference {self._times(where)}, {most} are missing")

    def wrong_way(self) -> Iterator[str]:
        """Where the model has no unique inverse."""
        reasons = [block.wrong_way for block in self.model.blocks if block.wrong_way]
        for axis, name, _ in self._axes("response_units"):
            where = self.feedforward.wrong[axis]
            if where.any():
                why = f": {'; or '.join(reasons)}" if reasons else ""
                yield f"{name}: the model first moves away from the reference {self._times(where)}{why}"

    def new(self) -> Iterator[str]:
        """What the identification did not see: larger drives, faster references."""
        for axis, name, unit in self._axes("drive_units"):
            low, high = self.identified.range[axis]
            margin = (FURTHER - 1) * (high - low)
            drive = self.feedforward.drive[axis]
            if drive.min() < low - margin or drive.max() > high + margin:
                seen, asked = (
                    f"{quantity(a / factor(unit), unit)} to {quantity(b / factor(unit), unit)}"
                    for a, b in ((low, high), (drive.min(), drive.max()))
                )
                yield spelled(f"{name}: the drive goes from {asked}, the model was identified from {seen}")
            fastest = self.identified.frequencies[axis]
            asked_for = frequency(self.feedforward.reference[axis], self.dt)
            if asked_for > FASTER * fastest:
                yield (
                    f"{name}: the reference moves at {quantity(asked_for, 'Hz', 3)} (root mean square), the model was "
                    f"identified up to {quantity(fastest, 'Hz', 3)}: rate dependence and dynamics beyond are not known"
                )

    def _axes(self, units: str) -> Iterator[tuple[int, str, str]]:
        for axis in self.model.measured:
            yield axis, self.model.axes[axis], str(getattr(self.identified, units)[axis])

    def _times(self, where: NDArray[np.bool_]) -> str:
        """Stretches of time: from 0.2 s to 0.3 s."""
        parts = [(start * self.dt, (stop - 1) * self.dt) for start, stop in stretches(where)]
        named = [f"from {quantity(begin, 's', 4)} to {quantity(end, 's', 4)}" for begin, end in parts[:SHOWN]]
        more = [f"{len(parts) - SHOWN} more times"] if len(parts) > SHOWN else []
        return listed([*named, *more])


def frequency(signal: Array, dt: float) -> float:
    """Root-mean-square frequency of a signal, Hz: that of a sine, for a triangle 1.1 times its own."""
    spread = np.std(signal)
    return float(np.sqrt(np.mean(np.diff(signal) ** 2)) / (2 * np.pi * dt * spread)) if spread > 0 else 0.0
