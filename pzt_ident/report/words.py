"""What the numbers say, in sentences."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from pzt_ident.data.notation import count, listed, number, quantity, ranges, spelled
from pzt_ident.data.over_axes import together, weighed
from pzt_ident.run.results import Results

BETTER = 0.95  # of the run's RMSE: less than that is worth a word
NOISELESS = 1e-6  # of the span of a response: no sensor has less noise
FLOORS = re.compile(r"(?:([\d.]+) to )?([\d.]+) noise floors")


def verdict(results: Results) -> str:
    """What is missing or was added, or else what the model leaves, on which records, beside the noise."""
    if found := results.improvement:
        proven = found["effects"] and found["verdict"] == "adequate"  # what is not, the reason names
        added = f"Added: {listed(found['effects'])}. " if proven else ""
        return reason(f"{added}{found['reason']}", results)
    if results.diagnosis:
        return reason(results.diagnosis["reason"], results)
    return left(results)


def reason(said: str, results: Results) -> str:
    """What a diagnosis says, as it is read: of a response without noise in its unit, not in noise floors."""
    if results.share_of_noise < NOISELESS and len(results.floors) == 1:
        (floor,) = results.floors.values()
        said = FLOORS.sub(lambda found: _in_unit(found, floor or 0.0, results.unit), said)
    return spelled(said + _better(results))


def _better(results: Results) -> str:
    """That the diagnosis, which fits the model again from several starts, came to less than the run."""
    if not (results.result and results.diagnosis):
        return ""
    found, run = results.diagnosis["rmse"]["identify"], results.best["rmse"]["identify"]
    if found > BETTER * run:
        return ""
    here, there = (quantity(value, results.unit, 3) for value in (found, run))
    both = together(results.units)
    return f" Fitted again from other starts it leaves {here}{both}, not the run's {there}: search longer."


def _in_unit(found: re.Match[str], floor: float, unit: str) -> str:
    first, last = (quantity(float(part) * floor, unit, 3) if part else "" for part in found.groups())
    return f"{first} to {last}" if first else last


def left(results: Results) -> str:
    """What the last model leaves, on which records, and how that compares with the noise."""
    rmse = results.rmse
    use = "identify" if rmse["validate"] is None else "validate"
    where = {
        "validate": "on records the fit never saw",
        "identify": "on the records it was fitted to, and no record was kept back to judge it on",
    }[use]
    size = f"{quantity(rmse[use], results.unit, 3)} RMS{together(results.units)}"
    return f"The model leaves {size} {where}{_over_noise(results, use)}."


def findings(results: Results) -> list[str]:
    """Sentences on what a reader must know beside the verdict: parameters not found, what is special about a record,
    simulations and runs failed."""
    diagnosed = [*_advice(results)] if results.diagnosis else []
    diagnosed += weighed(results.units)
    run = [*_parameters(results), *_notes(results), *_failures(results)] if results.result else []
    return [spelled(sentence) for sentence in diagnosed + run]


def _advice(results: Results) -> Iterator[str]:
    """What is left, and what to do on the rig about what is missing or to tell what could be."""
    yield left(results)
    best = next((item for item in results.diagnosis["candidates"] if item["decision"] == "missing"), None)
    if best:
        yield f"{best['effect']}: {best['physics']} On the rig: {best['remedy']}"
    if proposal := results.next_experiment:
        yield f"To tell {' from '.join(proposal['splits'])}, run the drive in {proposal['file']}: {proposal['why']}."
    elif best and results.diagnosis["verdict"] == "inconclusive":
        yield f"No drive within the limits tells them apart. On the rig: {best['separate_by']}"


def _over_noise(results: Results, use: str) -> str:
    known = results.floors
    if results.share_of_noise < NOISELESS:
        return "; the response holds hardly any noise to compare it with, as if it were simulated"
    floor = {axis: value for axis, value in known.items() if value}
    if not floor:
        return "" if 0 in known.values() else "; the noise floor is not known"
    if len(known) == 1:
        (value,) = floor.values()
        ratio = number(results.rmse[use] / value, 2)  # type: ignore[operator]
        return f", {ratio}\u00a0times the noise floor of {quantity(value, results.unit, 2)}"
    records = [record["rmse"] for record in results.records if record["use"] == use]
    ratios = sorted(rmse[axis] / floor[axis] for rmse in records for axis in floor if rmse.get(axis) is not None)
    if not ratios:
        return ""
    return (
        f"; axis by axis and record by record, {number(ratios[0], 2)} to {number(ratios[-1], 2)} times the noise floor"
    )


def _parameters(results: Results) -> list[str]:
    found: dict[str, list[str]] = {}
    for name, entry in results.best["parameters"].items():
        found.setdefault(entry["verdict"], []).append(name)
    said = []
    if names := found.get("not determined"):
        said.append(f"These data do not determine {listed(ranges(names))}: other values would fit as well.")
    said += _unmoved(results)
    for bound in ("lower", "upper"):
        if names := found.get(f"on its {bound} bound"):
            place = f"sits on its {bound} bound" if len(names) == 1 else f"sit on their {bound} bounds"
            said.append(f"{listed(names)} {place}: what fits best may lie beyond.")
    return said


def _unmoved(results: Results) -> Iterator[str]:
    """Of what stands for a drive each, that which no record moves."""
    for name, entries in standing(results).items():
        still = [entry["at"] for entry in entries if entry["verdict"] == "not moved"]
        if still:
            (low, unit), (high, _) = still[0], still[-1]
            these = f"the {len(still)} of {number(low)} to" if len(still) > 1 else "the one of"
            yield f"No record moves {these} {quantity(high, unit)} of {name}: these data say nothing of them."


def standing(results: Results) -> dict[str, list[Any]]:
    """The best run's parameters that stand for a drive each, by the name that they share."""
    found: dict[str, list[Any]] = {}
    for name, entry in results.best["parameters"].items():
        if entry.get("at"):
            found.setdefault(name.rpartition("_")[0], []).append(entry)
    return found


def _notes(results: Results) -> list[str]:
    return [f"Record {record['name']}: {note}." for record in results.result["records"] for note in record["notes"]]


def _failures(results: Results) -> list[str]:
    runs, failed = results.result["runs"], results.result["failed_runs"]
    said = []
    if lost := sum(run["failed_simulations"] for run in runs):
        spent = sum(run["evaluations"] + run["polish_evaluations"] for run in runs)
        said.append(f"{count(lost)} of {count(spent)} simulations failed and were scored as infinitely bad.")
    if failed:
        noun = "run" if len(failed) == 1 else "runs"
        said.append(f"{count(len(failed))} {noun} did not finish: {listed(entry['run'] for entry in failed)}.")
    return said
