"""What the report says of a lot in words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from pzt_ident.data.notation import listed, number, percent, spelled, unit
from pzt_ident.lot.outcome import Lot
from pzt_ident.lot.statistics import Difference
from pzt_ident.lot.table import Row
from pzt_ident.run.collect import MOST_OF_THE_NOISE

MOST_GROUPS = 4  # of which a sentence names each median


def lead(lot: Lot) -> str:
    """The lot in a sentence."""
    done, total = len(lot.done), len(lot.rows)
    adequate = [row for row in lot.done if row["verdict"] == "adequate"]
    more = sum(bool(row["effects"]) for row in adequate)
    if not done:
        return f"None of {total} devices {'is done yet' if unfinished(lot) else 'could be identified'}."
    fit = [f"is adequate for {len(adequate) - more or 'none'} of {total} devices"]
    fit += [f"with effects added for {more} more"] * bool(more)
    fit += [f"fits {len(lot.ill_fitted)} worse than usual"] * bool(lot.ill_fitted)
    text = f"The model {listed(fit)}."
    if lot.odd:
        text += f" {len(lot.odd)} more {'is' if len(lot.odd) == 1 else 'are'} out of line."
    if lot.broken:
        text += f" {len(lot.broken)} could not be identified."
    return text


def unfinished(lot: Lot) -> list[str]:
    waiting = len(lot.rows) - len(lot.done) - len(lot.broken)
    return [f"{waiting} devices are not done: pzt-ident resume goes on with them."] if waiting else []


def findings(lot: Lot) -> Iterator[str]:
    """What a reader must know beside that."""
    above = lot.verdicts.get("above the noise", 0)
    if above and not lot.statement["improve"]:
        yield f"{above} are above the noise: the same command with --improve says why."
    coarse = [row["device"] for row in lot.done if (row.get("step_change") or 0.0) > MOST_OF_THE_NOISE]
    if coarse and not lot.statement["improve"]:
        yield (
            f"The step of the simulation costs {len(coarse)} of {len(lot.done)} devices more than a fifth of the noise:"
            " give the records of the job more `steps`."
        )
    for effect, names in lot.effects.items():
        yield f"{effect} is missing in {len(names)} of {len(lot.done)} devices ({percent(len(names) / len(lot.done))})."
    for trend in _distinct(lot.trends):
        quantity = next(quantity for quantity in lot.quantities if quantity.name == trend.quantity)
        sign = "grows" if trend.slope > 0 else "falls"
        column = re.search(r"\[(.+)\]", trend.column)
        per = unit(column[1]) if column else "unit"
        change = (
            f", by {number(abs(trend.slope / quantity.median) * 100, 2)}\u00a0% per {per}" if quantity.median else ""
        )
        yield f"{trend.quantity} {sign} with the {trend.column.partition(' [')[0]}{change}."
    for difference in lot.group_differences:
        if difference.clear:
            quantity = next(quantity for quantity in lot.quantities if quantity.name == difference.quantity)
            yield f"{quantity.name} differs by {difference.column}: {groups_of(difference, unit(quantity.unit))}."
    for names in lot.same_data:
        yield f"{listed(names)} have the same data: is one of them a copy?"
    undetermined = [
        quantity.name
        for quantity in lot.quantities
        if not quantity.one_sided and quantity.usable.sum() < np.isfinite(quantity.values).sum() / 2
    ]
    if undetermined:
        yield f"The data of most devices do not determine {listed(undetermined)}."


def groups_of(difference: Difference, shown: str) -> str:
    """The medians of the groups; of many groups that which stands out."""
    medians = [f"{word} {number(value)}" for word, value in difference.medians.items()]
    if len(medians) <= MOST_GROUPS:
        return f"{', '.join(medians)} {shown}".rstrip()
    furthest, usual = difference.medians[difference.furthest], difference.usual
    where = "above" if furthest > usual else "below"
    far = f"{percent(abs(furthest / usual - 1))} {where}" if usual else where
    return f"{difference.furthest} has {f'{number(furthest)} {shown}'.rstrip()}, {far} the median of all"


def _distinct(trends: Iterable[Any]) -> list[Any]:
    """The clear trends, of each quantity the clearest."""
    first: dict[str, Any] = {}
    for trend in trends:
        if trend.clear:
            first.setdefault(trend.quantity, trend)
    return list(first.values())


def far(lot: Lot) -> list[tuple[str, str, str]]:
    """Devices out of line: first those whose parameters are, then those that the model does not fit; what and why."""
    why: dict[str, list[str]] = {}
    for finding in lot.findings:
        why.setdefault(finding.device, []).append(spelled(finding.sentence))
    rows = {row["device"]: row for row in lot.done}
    noisy = {name for name in lot.odd if all(finding.of_fit for finding in lot.findings if finding.device == name)}
    kinds = [(name, "noise" if name in noisy else _odd(rows[name])) for name in lot.odd]
    kinds += [(name, _misfit(rows[name])) for name in lot.ill_fitted]
    return [(name, kind, "; ".join(why[name])) for name, kind in kinds]


def _odd(row: Row) -> str:
    """What is known of a device that the model fits with unusual parameters."""
    return f"parameters, misses {listed(row['effects'])}" if row["effects"] else "parameters"


def _misfit(row: Row) -> str:
    """What is known of a device that the model does not fit."""
    if row["effects"]:
        return f"misses {listed(row['effects'])}"
    return f"may miss {listed(row['suspects'])}" if row["suspects"] else "fits worse"
