"""One axis x over a file that the test wrote: `read(path, ...)` gives its record, `problem(path, ...)` the error."""

from __future__ import annotations

from pathlib import Path

import pytest

from pzt_ident.data.readers import read_records
from pzt_ident.data.record import Axis, Channel, Record, Source
from pzt_ident.errors import InputError


def one_record(path: Path, drive="u [V]", response="x [um]", clock="t [s]", **source) -> Record:
    def channel(item):
        return Channel(name=item) if isinstance(item, str) else item

    axes = {"x": Axis(channel(drive), channel(response))}
    (record,) = read_records([Source(path.name, **source)], axes, channel(clock), path.parent)
    return record


@pytest.fixture(scope="session")
def read():
    return one_record


@pytest.fixture(scope="session")
def problem():
    """The InputError that reading raises; it names the file and says what to do."""

    def raised(path, *args, **kwargs) -> InputError:
        with pytest.raises(InputError) as error:
            one_record(path, *args, **kwargs)
        assert path.name in error.value.where
        assert error.value.remedy
        return error.value

    return raised
