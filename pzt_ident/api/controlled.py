"""What an identified model is put to: drives, controllers, and files for other programs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from pzt_ident.api.arguments import Signals, path_of, rate_or_stamps, writable
from pzt_ident.api.record import Record
from pzt_ident.control.identified import Identified
from pzt_ident.errors import InputError

if TYPE_CHECKING:
    from pzt_ident.api.drive import Drive
    from pzt_ident.api.tracking import Comparison
    from pzt_ident.api.tuning import Tuning


class Controlled(ABC):
    """A model with identified parameters that can be put to work."""

    @property
    @abstractmethod
    def identified(self) -> Identified:
        """What control and export start from."""

    def drive(self, t: ArrayLike | str | Record, reference: Signals | None = None, **options: Any) -> Drive:
        """The drive under which the stage follows a reference; see `pzt_ident.api.drive.drive`."""
        from pzt_ident.api.drive import drive

        return drive(self.identified, t, reference, **options)

    def control(self, t: ArrayLike | str | Record, reference: Signals | None = None, **options: Any) -> Comparison:
        """How well the stage follows a reference, in several ways; see `pzt_ident.api.tracking.control`."""
        from pzt_ident.api.tracking import control

        return control(self.identified, t, reference, **options)

    def tune(self, rate: float | str = 1000.0, delay: int = 1, **options: Any) -> Tuning:
        """PI gains for a controller of a sample rate and computing delay; see `pzt_ident.api.tuning.tune`."""
        from pzt_ident.api.tuning import tune

        return tune(self.identified, rate, delay, **options)

    def export(self, folder: str | Path, to: str = "c", precision: str = "double", rate: Any = None) -> list[Path]:
        """Write the model for another program: `c`, `fmu`, `matlab`, `csv` or `json`; returns the files.

        precision: `double` or `float`, of the C. rate: of its samples, Hz or text such as `10kHz`; by default that
        of the fastest record. Raises InputError for another format, or a block that cannot be written in it.
        """
        return written(self.identified, folder, to, precision, rate)


def written(identified: Identified, folder: str | Path, to: str, precision: str, rate: Any) -> list[Path]:
    """Export at a sample rate, by default that of the identification."""
    from pzt_ident.control.export import export

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
