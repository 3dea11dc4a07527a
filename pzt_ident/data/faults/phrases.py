"""The faults of a record in words."""

from __future__ import annotations

from pzt_ident.data.faults.clipping import clipping_phrase
from pzt_ident.data.faults.jumps import dropout_phrase, hold_phrase, join_phrase
from pzt_ident.data.faults.spikes import spike_phrase
from pzt_ident.data.record import Record

FAULTS = spike_phrase, hold_phrase, dropout_phrase, join_phrase, clipping_phrase


def fault_phrases(record: Record) -> list[str]:
    """What looks wrong with the readings of a record and what to do about it, a phrase for each kind of fault."""
    return [phrase for fault in FAULTS if (phrase := fault(record))]
