"""NI TDMS files: `group/channel`, the unit from `unit_string`, the sample time from `wf_increment`, which is
`group/channel/wf_increment` as well."""

from __future__ import annotations

import logging
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.readers.table import Column, Table
from pzt_ident.data.record import Source
from pzt_ident.errors import InputError

SUFFIXES = (".tdms",)
MAGIC = (b"TDSm",)


def read(path: Path, source: Source) -> Table:
    from nptdms import TdmsFile
    from nptdms.log import log_manager

    log_manager.set_level(logging.ERROR)

    content = TdmsFile.read_metadata(path)
    if content.file_status.incomplete_final_segment:
        message = "is cut short: its last segment has fewer values than it says"
        raise InputError(message, where=str(path), remedy="copy it again, or export what is whole")
    columns: list[Column] = []
    scalars: list[Column] = []
    for channel in (channel for group in content.groups() for channel in group.channels()):
        name = f"{channel.group_name}/{channel.name}"
        unit = str(channel.properties.get("unit_string", "")) or None
        step = channel.properties.get("wf_increment")
        load = partial(_values, path, channel.group_name, channel.name)
        columns.append(Column(name, load, unit, sample_time=step and float(step)))
        if step is not None:
            scalars.append(Column(f"{name}/wf_increment", partial(np.asarray, step), "s"))
    return Table(path, columns, scalars)


def _values(path: Path, group: str, channel: str) -> NDArray[Any]:
    from nptdms import TdmsFile

    with TdmsFile.open(path) as file:
        return np.asarray(file[group][channel][:])
