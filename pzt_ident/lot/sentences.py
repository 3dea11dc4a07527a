"""What the report says of a lot in words."""

from __future__ import annotations

from collections.abc import Iterator

from pzt_ident.data.notation import alike, counted, listed, number, percent, spelled, unit
from pzt_ident.lot.outcome import Lot
from pzt_ident.lot.statistics import Difference, Quantity, Trend
from pzt_ident.lot.table import Row, faults_in, missing_in, readings_in, some
from pzt_ident.run.collect import MOST_OF_THE_NOISE

MOST_GROUPS = 4  # of which a sentence names each median


def lead(lot: Lot) -> str:
    """The lot in a few sentences."""
    total, any_device = len(lot.rows), _share("any", len(lot.rows))
    if not lot.done:
        state = "is not identified yet" if unfinished(lot) else "could not be identified"
        return f"The model {state} for {any_device}."
    adequate = [row for row in lot.done if row["verdict"] == "adequate"]
    given, more = (sum(bool(row["effects"]) == added for row in adequate) for added in (False, True))
    ill, odd, broken = len(lot.ill_fitted), len(lot.odd), len(lot.broken)
    fit = f"is adequate for {_share(given, total)}" if given else f"is not adequate for {any_device}"
    others = counted(odd, "other device" if ill else "device")
    sentences = [
        f"The model {fit}.",
        f"With effects added, it is adequate for {f'{more} more' if given else _share(more, total)}." * bool(more),
        f"It fits {counted(ill, 'device')} worse than usual." * bool(ill),
        f"{others} {'is' if odd == 1 else 'are'} out of line." * bool(odd),
        f"{counted(broken, 'device')} could not be identified." * bool(broken),
    ]
    return " ".join(filter(None, sentences))


def _share(count: int | str, total: int) -> str:
    """So many of the devices, at least one, or `any` of them."""
    return "the only device" if total == 1 else f"{count} of {total} devices"


def unfinished(lot: Lot) -> list[str]:
    waiting = len(lot.rows) - len(lot.done) - len(lot.broken)
    verb, them = ("is", "it") if waiting == 1 else ("are", "them")
    return [f"{counted(waiting, 'device')} {verb} not done: pzt-ident resume goes on with {them}."] if waiting else []


def findings(lot: Lot) -> Iterator[str]:
    """What a reader must know beside that."""
    above = lot.verdicts.get("above the noise", 0)
    if above and not lot.statement["improve"]:
        verb = "is" if above == 1 else "are"
        yield f"{counted(above, 'device')} {verb} above the noise: the same command with --improve says why."
    coarse = [row["device"] for row in lot.done if (row.get("step_change") or 0.0) > MOST_OF_THE_NOISE]
    if coarse and not lot.statement["improve"]:
        problem = (
            f"The step of the simulation costs {_share(len(coarse), len(lot.done))} more than a fifth of the noise"
        )
        yield f"{problem}: give the records of the job more `steps`."
    for effect, names in lot.missing.items():
        yield f"{effect} is missing in {_share(len(names), len(lot.done))} ({percent(len(names) / len(lot.done))})."
    for fault, names in lot.faults.items():
        share = _share(len(names), len(lot.done))
        yield f"A fault of the set-up accounts for the misfit of {share} ({some(names)}): {fault}"
    for quantity in lot.quantities:
        if known := [
            _trend(trend, quantity) for trend in lot.trends if trend.clear and trend.quantity == quantity.name
        ]:
            yield f"{quantity.name} {listed(known)}."
    for difference in lot.group_differences:
        if difference.clear:
            quantity = next(quantity for quantity in lot.quantities if quantity.name == difference.quantity)
            yield f"{quantity.name} differs by {difference.column}: {groups_of(difference, unit(quantity.unit))}."
    yield from map(spelled, [*lot.of_readings(), *lot.of_units()])
    for names in lot.same_data:
        yield f"{listed(names)} have the same data: is one of them a copy?"
    undetermined = [
        f"{quantity.name} in {_undetermined(quantity, len(lot.done))}"
        for quantity in lot.quantities
        if not quantity.one_sided and quantity.usable.sum() < quantity.present.sum() / 2
    ]
    if undetermined:
        yield f"The data do not determine {listed(undetermined)}."


def _undetermined(quantity: Quantity, done: int) -> str:
    """In how many devices a quantity is not determined, of those that have it."""
    present, usable = int(quantity.present.sum()), int(quantity.usable.sum())
    return f"{_share(present - usable, present)}{' whose model has it' if present < done else ''}"


def _trend(trend: Trend, quantity: Quantity) -> str:
    sign = "grows" if trend.slope > 0 else "falls"
    column, _, of = trend.column.removesuffix("]").partition(" [")
    per = {"days": "day"}.get(of, unit(of)) or "unit"
    change = f" by {number(abs(trend.slope / quantity.median) * 100, 2)}\u00a0% per {per}" if quantity.median else ""
    return f"{sign} with {column}{change} (rank correlation {number(trend.correlation, 2)})"


def groups_of(difference: Difference, shown: str) -> str:
    """The medians of the groups; of many groups that which stands out."""
    numbers = alike([*difference.medians.values()])
    medians = [f"{word} {text}" for word, text in zip(difference.medians, numbers, strict=True)]
    if len(medians) <= MOST_GROUPS:
        return f"{', '.join(medians)} {shown}".rstrip()
    furthest, usual = difference.medians[difference.furthest], difference.usual
    where = "above" if furthest > usual else "below"
    far = f"{percent(abs(furthest / usual - 1))} {where}" if usual else where
    return f"{difference.furthest} has {f'{number(furthest)} {shown}'.rstrip()}, {far} the median of all"


def far(lot: Lot) -> list[tuple[str, str, str]]:
    """Devices out of line: first those whose parameters are, then those that the model does not fit; what and why."""
    why: dict[str, list[str]] = {}
    for finding in lot.findings:
        why.setdefault(finding.device, []).append(spelled(finding.sentence))
    rows = {row["device"]: row for row in lot.done}
    noisy = {name for name in lot.odd if all(finding.of_fit for finding in lot.findings if finding.device == name)}
    kinds = [(name, "noise" if name in noisy else _odd(rows[name])) for name in lot.odd]
    kinds += [(name, _misfit(rows[name])) for name in lot.ill_fitted]
    return [(name, kind, "; ".join([*why[name], *faults_in(rows[name]).values()])) for name, kind in kinds]


def _odd(row: Row) -> str:
    """What is known of a device that the model fits with unusual parameters."""
    return ", ".join(["parameters", *_cause(row)])


def _misfit(row: Row) -> str:
    """What is known of a device that the model does not fit."""
    suspects = f"may miss {listed(row['suspects'])}" if row["suspects"] else "fits worse"
    return ", ".join(_cause(row)) or suspects


def in_setup(row: Row) -> list[str]:
    """The faults of a device's set-up, in words."""
    return [f"{fault} in the set-up" for fault in faults_in(row)]


def _cause(row: Row) -> list[str]:
    """What the diagnosis of a device names."""
    missing = [f"misses {listed(missing_in(row))}"] if missing_in(row) else []
    return [*["readings look wrong"] * bool(readings_in(row)), *missing, *in_setup(row)]
