"""The sentences of the command line in the words of the library: arguments in the place of a job's keys and files."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from urllib.parse import unquote

from pzt_ident.errors import InputError

ARGUMENTS = (
    (r"\bdata/([^/]+)\.csv: time$", r"\1: t"),
    (r"\bdata/([^/]+)\.csv: (\w+)\.drive", r"\1: u: axis \2"),
    (r"\bdata/([^/]+)\.csv: (\w+)\.response", r"\1: y: axis \2"),
    (r"\bdata/([^/]+)\.csv", r"\1"),
    (r"^channels\.axes$", "train: y"),
    (r"^channels\.axes\.(.*)$", r"u: axis \1"),
    (r"move it to `effects: \[(\w+)\]`", r"give effects=['\1']"),
    (r"a `response`", "a response"),
    (r"`bounds` or a `value`", "bounds, or fix it"),
    (r"\brecords\[\d+\]\.", ""),
    (r"\bparameters\.(\S+)\.bounds(?:\[\d\])?(?=:|$)", r"bounds: \1"),
    (r"\bparameters\.(\S+)\.value(?=:|$)", r"fixed: \1"),
    (r"\bparameters\.(\S+?)(?=:|$)", r"bounds, fixed: \1"),
    (r"\boptimizers\[0\]", "optimizer"),
    (r"\beffects\[\d+\]", "effects"),
    (r"\bstop\.evaluations\b", "evaluations"),
    (r"\bthe job has (\d+) faults", r"\1 faults"),
    (r"leave `time` out and give `sample_rate`", "give the sample rate as t"),
    (r"take what is before it with `rows: \[0, (\d+)\]`", r"take what is before it, t[:\1]"),
    (r"give the record a `sample_rate: 1 kHz`, or the job a `time` channel", "give time='t [s]' or sample_rate=1000"),
    (r"or in the job: `unit: (\w+)` of this channel", r"or give {'column': 2, 'unit': '\1'}"),
    (r" with `rows`", ""),
    (r"fix it with `value`", "fix it with `fixed`"),
    (r"widen `rows` or `time`, or decimate less", "give more samples"),
    (r"list it under `model` or `effects`", "put it into the Model"),
    (r"give another --out, or resume it", "give another folder"),
    (r"give another folder with --out", "give another folder"),
)


@contextmanager
def as_arguments() -> Iterator[None]:
    """InputErrors of the block, reworded."""
    try:
        yield
    except InputError as error:
        message, where, remedy = map(_reworded, (error.message, error.where, error.remedy))
        raise InputError(message, where=where, remedy=remedy) from None


def _reworded(text: str) -> str:
    for job, argument in ARGUMENTS:
        text = re.sub(job, argument, text, flags=re.MULTILINE)
    return unquote(text) if "%" in text else text
