"""What happens in a run as it does: kept in `events.jsonl`, told to a listener, and put into words."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from threading import Lock
from typing import Any

from pzt_ident.data.notation import listed, percent, quantity
from pzt_ident.data.over_axes import together
from pzt_ident.data.units import common_unit
from pzt_ident.files import plain
from pzt_ident.run.alone import occupied, taken

Event = dict[str, Any]
Listen = Callable[[Event], None]
AS_GIVEN = "as given"  # the name of the step that a path begins with


def nobody(event: Event) -> None:
    """The listener that takes no notice."""


@contextmanager
def event_log(folder: Path, listen: Listen) -> Iterator[Listen]:
    """A listener that keeps each event as a line of `events.jsonl` and tells it on; any thread may call it. No other
    process has the log meanwhile; raises InputError where one does."""
    one_at_a_time = Lock()
    with (folder / "events.jsonl").open("a", encoding="utf-8") as log:
        if not taken(log):
            raise occupied(folder)

        def tell(event: Event) -> None:
            with one_at_a_time:
                try:
                    listen(event)  # first, so that whoever sees the log finds the listener told
                finally:
                    log.write(json.dumps(plain(event)) + "\n")
                    log.flush()

        yield tell


def sentence(event: Mapping[str, Any], units: Mapping[str, str]) -> str:
    """What a diagnosis is at, from one of its events; units: that of each axis."""
    unit, error = common_unit([*units.values()]), f"RMSE{together(units)}"
    if event["event"] == "fitted":
        return f"fitted from {event['done']} of {event['of']} starts"
    if event["event"] == "scored":
        part = f"{event['effect']} would explain {percent(event['explained'])}"
        return f"{event['done']} of {event['of']} effects scored; {part}"
    if event["event"] == "refitted":
        chosen = f"with {listed(event['effects'])}" if event["effects"] else "without an effect"
        return f"refitted {chosen}: {error} {quantity(event['identify'], unit)}"
    again = event.get("path", 1) > 1 and step_name(event) == AS_GIVEN
    return f"{step_name(event)}{' again' * again}: {error} {quantity(event['rmse']['identify'], unit)}"


def verdict_line(verdict: str, reason: str) -> str:
    """The reason of a verdict, with the verdict ahead of it unless its first sentence says it."""
    said = verdict in re.findall(r"\w+", reason.partition(".")[0].lower())
    return reason if said else f"{verdict}: {reason}"


def step_name(step: Mapping[str, Any]) -> str:
    """`as given`, `+ effect`, `- effect`, or both where one takes the place of another; what the step itself says."""
    form = f" ({step['form']})" if step.get("form") else ""
    added = f"+ {step['added']}{form}" if step["added"] else ""
    removed = f"- {step['removed']}" if step["removed"] else ""
    return step.get("change") or " ".join(filter(None, (added, removed))) or AS_GIVEN


def explains(step: Mapping[str, Any]) -> bool:
    """Whether a step adds or takes out something, and less is left after it."""
    return bool((step["added"] or step["removed"]) and step["explained"] >= 0)
