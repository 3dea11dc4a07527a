"""Dates in the columns of a lot, as people write them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

DAY_FIRST = re.compile(r"^([0-9]{1,2})\.([0-9]{1,2})\.([0-9]{4})\b")
YEAR_FIRST = re.compile(r"[0-9]{4}-[0-9]{2}")


def dates_of(values: Sequence[Any]) -> list[datetime | None] | None:
    """Dates such as 2026-03-02, 02.03.2026 or 2026-03-02T14:05+01:00, one without a time zone in UTC; None where a
    value is none, or all are missing."""
    try:
        dates = [None if value is None else _date(str(value)) for value in values]
    except ValueError:
        return None
    return dates if any(dates) else None


def is_date(text: str) -> bool:
    return dates_of([text]) is not None


def _date(text: str) -> datetime:
    """Raises ValueError where the text is no date."""
    text = DAY_FIRST.sub(lambda match: f"{match[3]}-{match[2]:0>2}-{match[1]:0>2}", text.strip())
    if not YEAR_FIRST.match(text):
        raise ValueError(text)
    date = datetime.fromisoformat(f"{text}-01" if YEAR_FIRST.fullmatch(text) else text)
    return date if date.tzinfo else date.replace(tzinfo=UTC)
