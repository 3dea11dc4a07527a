"""What is to be said of a fit beside the verdict on it."""

from __future__ import annotations

from itertools import product

from pzt_ident.data.noise import noise_floor
from pzt_ident.data.notation import listed
from pzt_ident.data.units import factor
from pzt_ident.diagnosis.locate import locate
from pzt_ident.diagnosis.refit import Case, Fit


def caveats(case: Case, fit: Fit) -> str:
    """All but what is told of the records."""
    return sized(fit) + silenced(case, fit) + bounded(fit)


def sized(fit: Fit) -> str:
    """A sentence about each effect that adds to the response in amounts of each record: the most it adds to one."""
    problem, model = fit.problem, fit.problem.model
    theta = problem.parameters(fit.point)
    added = {simulator.record.name: simulator.added(theta) for simulator in problem.every_simulator}
    said = ""
    for effect, (i, axis) in product((block.name for block in model.additions), enumerate(model.measured)):
        record, most = max(((name, own[effect][i]) for name, own in added.items()), key=lambda pair: pair[1])
        unit = str(problem.records[0].response_units[axis])
        where = f" of {model.axes[axis]}" if len(model.measured) > 1 else ""
        said += f" The {effect}{where} is {most / factor(unit):.2g} {unit} rms in record {record}, the most of all."
    return said


def silenced(case: Case, fit: Fit) -> str:
    """A sentence about effects that fit better where axes without a response do not have them."""
    names = case.silent(fit.effects) if fit.alone else {}
    if not names:
        return ""
    axes = " and ".join(dict.fromkeys(name.partition(".")[0] for name in names))
    said = f" What comes from {axes}, which has no response, fits better without these effects there"
    return f"{said}: {', '.join(f'`{name}: {{value: {null:g}}}`' for name, null in names.items())}."


def bounded(fit: Fit) -> str:
    """A sentence about the parameters that ended on a bound which is not their null."""
    problem, names = fit.problem, fit.on_bounds
    places = [problem.names.index(name) for name in names]
    ends = [(problem.lower if fit.point[i] < 0.5 else problem.upper)[i] for i in places]
    values = [f"{end:.4g} {problem.units[i]}".removesuffix(" 1") for i, end in zip(places, ends, strict=True)]
    if not names:
        return ""
    if len(names) == 1:
        why = "these data do not determine it, its bounds are too narrow, or it stands in for something else"
        return f" {names[0]} ended on its bound of {values[0]}: {why}."
    why = "these data do not determine them, their bounds are too narrow, or they stand in for something else"
    return f" {listed(names)} ended on their bounds of {listed(values)}: {why}."


def broken(fit: Fit) -> str:
    """A sentence about each record over which a block breaks a condition of its own equation."""
    theta = fit.problem.parameters(fit.point)
    simulators = fit.problem.every_simulator
    return "".join(
        f" Record {simulator.record.name}: {condition}."
        for simulator in simulators
        for condition in simulator.broken(theta)
    )


def rest(case: Case, fit: Fit) -> str:
    """What that which a fit leaves depends on most, a sentence for each axis."""
    records, residuals = zip(*fit.problem.errors(fit.point), strict=True)
    noise = [noise_floor(list(case.records), axis) for axis in records[0].measured]
    misfits = [misfit for misfit in locate(records, residuals, noise) if misfit.misfit]
    names = [f"{misfit.axis}: " if len(records[0].measured) > 1 else "" for misfit in misfits]
    return " ".join(f"{name}{misfit.sentences[0]}" for name, misfit in zip(names, misfits, strict=True))
