"""What a job states about its records: read once, as the problem that everything else works on."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from pzt_ident.data.noise import error_scales
from pzt_ident.data.readers import read_records
from pzt_ident.data.record import Record
from pzt_ident.data.units import common_unit
from pzt_ident.job.schema import Job
from pzt_ident.search.problem import Problem


class Statement:
    """A job with its records and the problem of finding its parameters, each made once.

    Raises InputError where the data are wrong, or the model cannot take them.
    """

    def __init__(self, job: Job, records: Sequence[Record] | None = None) -> None:
        self.job = job
        self.records = list(records) if records is not None else read(job)
        self.problem  # noqa: B018  refused before anything is written

    @cached_property
    def problem(self) -> Problem:
        with self.job.placed():
            return Problem(self.job.chain, self.records, self.job.parameters, error_scales(self.records))

    @property
    def unit(self) -> str:
        return loss_unit(self.records)


def read(job: Job) -> list[Record]:
    """The records of a job. Raises InputError on whatever is wrong with its data."""
    return read_records(job.records, job.channels.axes, job.channels.time, job.folder)


def loss_unit(records: Sequence[Record]) -> str:
    """That of the loss."""
    return common_unit([*records[0].units.values()])
