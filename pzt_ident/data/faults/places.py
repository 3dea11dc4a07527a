"""Samples of a record as times and as rows of its file."""

from __future__ import annotations

from collections.abc import Sequence

from pzt_ident.data.notation import listed
from pzt_ident.data.record import Record

MOST = 3  # that are told


def row_of(record: Record, place: int) -> int:
    """The row of the file in which a sample is, counted from 0 as by `rows`."""
    first, last = record.rows
    return first + place * (last - first) // record.samples


def place_of(record: Record, place: int) -> str:
    """The time of a sample, and its row where the record has a file."""
    row = f" (row {row_of(record, place)})" if record.rows[1] else ""
    return f"{record.time[place]:.6g} s{row}"


def places_of(record: Record, places: Sequence[int]) -> str:
    """The first few of some samples."""
    more = f" and {len(places) - MOST} more" if len(places) > MOST else ""
    return f"at {listed([place_of(record, place) for place in places[:MOST]])}{more}"


def span_of(record: Record, gaps: Sequence[tuple[int, int]]) -> str:
    """The first few of some stretches, by their first and last samples."""
    spans = [f"{place_of(record, first)} to {place_of(record, last)}" for first, last in gaps[:MOST]]
    more = f" and {len(gaps) - MOST} more" if len(gaps) > MOST else ""
    return f"from {listed(spans)}{more}"
