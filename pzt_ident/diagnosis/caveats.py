"""Sentences about a fit that stand beside the verdict on it."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

from pzt_ident.data.faults import fault_phrases
from pzt_ident.data.noise import noise_floor
from pzt_ident.data.notation import listed
from pzt_ident.data.start_step import start_step
from pzt_ident.data.units import factor
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.drive_noise import drive_noise_sentence
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.history import has_history
from pzt_ident.diagnosis.locate import locate
from pzt_ident.diagnosis.refining import refining_sentence
from pzt_ident.search.gains import far_off


def caveats(case: Case, fit: Fit, said: str = "") -> str:
    """The sentences about units, additions, effects on measured axes only, bounds, and records; none that was said."""
    units = "".join(f" {sentence}" for sentence in far_off(fit.problem))
    of_fit = (
        units,
        refining_sentence(fit),
        addition_sentences(fit),
        measured_only_sentence(case, fit),
        bounds_sentence(fit),
    )
    of_records = start_step_sentence(case, fit), drive_noise_sentence(case, fit), fault_sentences(case)
    sentences = *of_fit, *of_records, case.caveat
    return "".join(sentence for sentence in sentences if sentence not in said)


class Amount(NamedTuple):
    """The most that an effect with amounts of each record adds to an axis in one: root mean square, in a unit."""

    effect: str
    axis: str
    record: str
    rms: float
    unit: str


def amounts(fit: Fit) -> list[Amount]:
    """That of each effect that adds to the response in amounts of each record, on each measured axis."""
    problem, model = fit.problem, fit.problem.model
    theta = problem.parameters(fit.point)
    added = {simulator.record.name: simulator.added(theta) for simulator in problem.every_simulator}
    found = []
    for effect, (i, axis) in product(next(iter(added.values())), enumerate(model.measured)):
        record = max(added, key=lambda name: added[name][effect][i])
        unit = str(problem.records[0].response_units[axis])
        found.append(Amount(effect, model.axes[axis], record, float(added[record][effect][i]) / factor(unit), unit))
    return found


def addition_sentences(fit: Fit) -> str:
    """A sentence about each of these."""
    several = len(fit.problem.model.measured) > 1
    return "".join(
        f" The {item.effect}{f' of {item.axis}' * several} is largest in record {item.record}: {item.rms:.2g}"
        f" {item.unit} rms."
        for item in amounts(fit)
    )


def measured_only_sentence(case: Case, fit: Fit) -> str:
    """A sentence about effects that fit better where axes without a response do not have them."""
    nulls = case.unmeasured_nulls(fit.effects) if fit.measured_only else {}
    if not nulls:
        return ""
    axes = " and ".join(dict.fromkeys(name.partition(".")[0] for name in nulls))
    values = ", ".join(f"`{name}: {{value: {null:g}}}`" for name, null in nulls.items())
    return f" The model fits better without these effects on {axes}, where no response is measured: {values}."


def bounds_sentence(fit: Fit) -> str:
    """A sentence about the parameters that ended on a bound which is not their null."""
    problem, names = fit.problem, fit.on_bounds
    if not names:
        return ""
    columns = [problem.names.index(name) for name in names]
    bounds = [(problem.lower if fit.point[i] < 0.5 else problem.upper)[i] for i in columns]
    values = [f"{bound:.4g} {problem.units[i]}".removesuffix(" 1") for i, bound in zip(columns, bounds, strict=True)]
    if len(names) == 1:
        reasons = "these data do not determine it, its bounds are too narrow, or it stands in for something else"
        return f" {names[0]} ended on its bound of {values[0]}: {reasons}."
    reasons = "these data do not determine them, their bounds are too narrow, or they stand in for something else"
    return f" {listed(names)} ended on their bounds of {listed(values)}: {reasons}."


def start_step_sentence(case: Case, fit: Fit) -> str:
    """A sentence on the records that begin as after a step of the drive, of which neither the job nor the model says
    what was before."""
    stepped = [record.name for record in case.records if start_step(record)]
    if not stepped or has_history(fit):
        return ""
    begin = "begins" if len(stepped) == 1 else "begin"
    advice = "if the stage rested at another drive until then, `rest_at` in the job lets the model follow the step"
    return f" {listed(stepped)} {begin} as after a step: {advice}."


def fault_sentences(case: Case) -> str:
    """What looks wrong with the readings of each record."""
    return "".join(f" In record {record.name} {phrase}." for record in case.records for phrase in fault_phrases(record))


def broken_conditions(fit: Fit) -> str:
    """A sentence about each record over which a block breaks a condition of its own equation."""
    theta = fit.problem.parameters(fit.point)
    simulators = fit.problem.every_simulator
    return "".join(
        f" Record {simulator.record.name}: {condition}."
        for simulator in simulators
        for condition in simulator.violations(theta)
    )


def misfit_sentences(case: Case, fit: Fit) -> str:
    """Where most of the misfit is, a sentence for each axis that has one."""
    records, residuals = zip(*fit.problem.errors(fit.point), strict=True)
    floors = [noise_floor(list(case.records), axis) for axis in records[0].measured]
    misfits = [misfit for misfit in locate(records, residuals, floors) if misfit.misfit]
    prefixes = [f"{misfit.axis}: " if len(records[0].measured) > 1 else "" for misfit in misfits]
    return " ".join(f"{prefix}{misfit.sentences[0]}" for prefix, misfit in zip(prefixes, misfits, strict=True))
