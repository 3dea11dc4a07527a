"""Sentences on the results of a run: the verdict at the head of the page and the findings below it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from pzt_ident.data.notation import count, listed, number, quantity, ranges, spelled
from pzt_ident.data.over_axes import USE_NAMES as USE_NAMES
from pzt_ident.data.over_axes import together, weighed
from pzt_ident.model.parameter import NOTHING_BEYOND
from pzt_ident.model.registry import blocks
from pzt_ident.run.results import Results

SENTENCE = re.compile(r"(?<=[^.\s][.?!])(?<!\beq\.)(?<!\bfig\.)(?<!\be\.g\.)(?<!\bi\.e\.) ", re.IGNORECASE)
NOISELESS = 1e-6  # of the span of a response: no sensor has less noise
FLOORS = re.compile(r"(?:([\d.]+) to )?([\d.]+) noise floors")


def verdict(results: Results) -> str:
    """The verdict of an improvement or a diagnosis, else the RMSE of the model beside the noise floor."""
    if improvement := results.improvement:
        proven = improvement["effects"] and improvement["verdict"] == "adequate"  # the reason names unproven effects
        forms = {step["added"]: step["form"] for step in improvement["steps"] if step.get("form")}
        names = [f"{word} ({forms[word]})" if word in forms else word for word in improvement["effects"]]
        added = f"Added: {listed(names)}. " if proven else ""
        return printed_reason(f"{added}{improvement['reason']}", results)
    if results.diagnosis:
        return printed_reason(results.diagnosis["reason"], results)
    return remaining_error(results)


def headline(text: str) -> tuple[str, list[str]]:
    """The first sentence of a verdict, after what was added, and the others."""
    first, *others = SENTENCE.split(text)
    if first.startswith("Added: ") and others:
        first, others = f"{first} {others[0]}", others[1:]
    return first, others


def printed_reason(text: str, results: Results) -> str:
    """The reason of a diagnosis with printed units. Where the response has no noise, multiples of the noise floor are
    replaced by errors in its unit."""
    if results.share_of_noise < NOISELESS and len(results.floors) == 1:
        (floor,) = results.floors.values()
        text = FLOORS.sub(lambda match: _in_unit(match, floor or 0.0, results.unit), text)
    return spelled(text)


def _in_unit(match: re.Match[str], floor: float, unit: str) -> str:
    first, last = (quantity(float(factor) * floor, unit, 3) if factor else "" for factor in match.groups())
    return f"{first} to {last}" if first else last


def remaining_error(results: Results) -> str:
    """RMSE of the last model on the validation records, else on the identification records, beside the noise floor."""
    rmse = results.rmse
    use = "identify" if rmse["validate"] is None else "validate"
    none = "none of those kept back can judge it" if is_unjudged(results) else "there is no validation record"
    records = {"validate": "on the validation records", "identify": f"on the identification records, and {none}"}[use]
    size = f"{quantity(rmse[use], results.unit, 3)}{together(results.units)}"
    return f"The RMSE is {size} {records}{over_noise(results, use)}."


def is_unjudged(results: Results) -> bool:
    """Whether there are records kept back, of which none can judge the model."""
    kept = any(record["use"] == "validate" for record in results.records)
    return kept and results.rmse["validate"] is None


def findings(results: Results) -> list[str]:
    """Sentences on what a reader must know beside the verdict: what to measure next, parameters that are not
    determined, remarks on records, failed simulations and runs."""
    lost = [f"Left out: {sentence}." for sentence in results.damaged]
    diagnosed = [*_advice(results)] if results.diagnosis else []
    diagnosed += weighed(results.units)
    run = [*_parameters(results), *_notes(results), *_failures(results)] if results.result else []
    return [spelled(sentence) for sentence in lost + diagnosed + run]


def next_step(results: Results) -> str:
    """What to do next, in one sentence."""
    if not results.diagnosis:
        return "Diagnose the model: it is not known yet whether an effect is missing."
    verdict = results.diagnosis["verdict"]
    best = next((item for item in results.diagnosis["candidates"] if item["decision"] == "missing"), None)
    if best and verdict == "inconclusive" and (proposal := results.next_experiment):
        return f"Measure again with the drive in {proposal['file']}: it tells {listed(proposal['splits'])} apart."
    if best:
        return f"Add {best.get('item', best['effect'])} to the model and identify it again."
    for word in results.diagnosis.get("faults", ()):
        return f"{blocks[word].remedy.removesuffix('.')}, and measure again: the misfit is that of a {word}."
    if verdict == "adequate" and is_unjudged(results):
        return "Measure a record to identify that is like the one kept back: nothing unseen has judged the model."
    if verdict == "adequate":
        return "Put the model to work: compute the drive for a reference, or export it for a controller."
    return "See below where the model fails, and which effects come near to an explanation."


def _advice(results: Results) -> Iterator[str]:
    """The remaining error, a remedy for the missing effect, and the experiment that distinguishes the candidates."""
    yield remaining_error(results)
    best = next((item for item in results.diagnosis["candidates"] if item["decision"] == "missing"), None)
    if best:
        yield f"{best.get('item', best['effect'])}: {best['physics']} On the test rig: {best['remedy']}"
    if proposal := results.next_experiment:
        yield f"To distinguish {listed(proposal['splits'])}, apply the drive in {proposal['file']}: {proposal['why']}."
    elif best and results.diagnosis["verdict"] == "inconclusive":
        yield f"No drive within the limits distinguishes the candidates. On the test rig: {best['separate_by']}"


def over_noise(results: Results, use: str) -> str:
    """How far the error is above the noise, as the rest of a sentence."""
    floors = results.floors
    if results.share_of_noise < NOISELESS:
        return "; the response contains almost no noise, as if it were simulated"
    known = {axis: floor for axis, floor in floors.items() if floor}
    if not known:
        return "" if 0 in floors.values() else "; the noise floor is not known"
    if len(floors) == 1:
        (floor,) = known.values()
        ratio = number(results.rmse[use] / floor, 2)  # type: ignore[operator]
        return f", {ratio}\u00a0times the noise floor of {quantity(floor, results.unit, 2)}"
    errors = [record["rmse"] for record in results.records if record["use"] == use]
    ratios = sorted(rmse[axis] / known[axis] for rmse in errors for axis in known if rmse.get(axis) is not None)
    if not ratios:
        return ""
    least, most = number(ratios[0], 2), number(ratios[-1], 2)
    if least == most:
        return f", {least}\u00a0times the noise floor on every axis in every record"
    return f"; depending on axis and record, {least} to {most} times the noise floor"


def _parameters(results: Results) -> list[str]:
    names_by_verdict: dict[str, list[str]] = {}
    at_an_end: dict[str, list[str]] = {}
    for name, entry in results.best["parameters"].items():
        chosen = at_an_end if entry["note"] == NOTHING_BEYOND else names_by_verdict
        chosen.setdefault(entry["verdict"], []).append(name)
    sentences = []
    if names := names_by_verdict.get("not determined"):
        sentences.append(f"The data do not determine {listed(ranges(names))}: other values fit as well.")
    sentences += _not_moved(results)
    for bound in ("lower", "upper"):
        for chosen, what in (
            (names_by_verdict, ": the best fit may lie outside"),
            (at_an_end, ", where the range ends"),
        ):
            if names := chosen.get(f"on its {bound} bound"):
                place = f"is on its {bound} bound" if len(names) == 1 else f"are on their {bound} bounds"
                sentences.append(f"{listed(names)} {place}{what}.")
    return sentences


def _not_moved(results: Results) -> Iterator[str]:
    """One sentence for each group of distributed parameters of which some are not excited by any record."""
    for name, entries in distributed_parameters(results).items():
        drives = [entry["at"] for entry in entries if entry["verdict"] == "not moved"]
        if drives:
            (low, unit), (high, _) = drives[0], drives[-1]
            several = len(drives) > 1
            place = f"the {len(drives)} values at {number(low)} to" if several else "the value at"
            pronoun = "them" if several else "it"
            yield f"No record excites {place} {quantity(high, unit)} of {name}: the data do not determine {pronoun}."


def distributed_parameters(results: Results) -> dict[str, list[Any]]:
    """The best run's parameters that belong to one drive value each, by their common name."""
    groups: dict[str, list[Any]] = {}
    for name, entry in results.best["parameters"].items():
        if entry.get("at"):
            groups.setdefault(name.rpartition("_")[0], []).append(entry)
    return groups


def _notes(results: Results) -> list[str]:
    return [f"Record {record['name']}: {note}." for record in results.result["records"] for note in record["notes"]]


def _failures(results: Results) -> list[str]:
    runs, failed = results.result["runs"], results.result["failed_runs"]
    sentences = []
    if lost := sum(run["failed_simulations"] for run in runs):
        total = sum(run["evaluations"] + run["polish_evaluations"] for run in runs)
        sentences.append(f"{count(lost)} of {count(total)} simulations failed and were scored as infinitely bad.")
    if failed:
        noun = "run" if len(failed) == 1 else "runs"
        sentences.append(f"{count(len(failed))} {noun} did not finish: {listed(entry['run'] for entry in failed)}.")
    return sentences
