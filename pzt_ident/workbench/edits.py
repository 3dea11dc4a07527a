"""Steps of a session whose job differs in a setting: a parameter, the optimizers, the place where the fit starts."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from pzt_ident.data.notation import number
from pzt_ident.errors import InputError, nearest
from pzt_ident.files import write_json
from pzt_ident.job.edit import edited
from pzt_ident.workbench.session import Session
from pzt_ident.workbench.step_model import model_of


def set_parameter(session: Session, form: dict[str, Any]) -> None:
    """A step in which a parameter is fixed at `value`, has `bounds`, or is free within those declared."""
    name = str(form["parameter"])
    parameters = {parameter["name"]: parameter for parameter in model_of(session.step(), session.plugins).parameters}
    if name not in parameters:
        raise InputError(f"unknown parameter {name!r}", remedy=nearest(name, parameters))
    setting, change = setting_of(form, parameters[name])
    job = session.job()
    _derived(session, edited(job, job.effects, session.next_folder, parameters={name: setting}), f"{name} {change}")


def setting_of(form: dict[str, Any], parameter: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """What the job is to say of a parameter, and that in words."""
    if form.get("bounds") is not None:
        low, high = map(float, form["bounds"])
        return {"bounds": [low, high]}, f"in {number(low)} to {number(high)}"
    if form.get("value") is not None:
        value = float(form["value"])
        return {"value": value}, f"= {number(value)}"
    if form.get("free"):
        low, high = parameter["bounds"]
        return {"bounds": [low, high]}, "free"
    raise InputError("says nothing of the parameter", remedy="give `bounds`, `value` or `free`")


def search(session: Session, form: dict[str, Any]) -> None:
    """A step with other optimizers, which search anew; the fit of this one stands beside them."""
    job, chosen = session.job(), form["optimizers"]
    if not isinstance(chosen, list) or not chosen:
        raise InputError("no optimizer is chosen", remedy="choose one")
    sections = {key: form[key] for key in ("repeats", "seed") if form.get(key) is not None}
    text = edited(job, job.effects, session.next_folder, sections={"optimizers": chosen} | sections)
    _derived(session, text, f"search by {', '.join(str(optimizer['name']) for optimizer in chosen)}", search=True)


def polish(session: Session, values: dict[str, float]) -> None:
    """A step fitted by least squares from these values, by name in the user's units."""
    job, model = session.job(), model_of(session.step(), session.plugins)
    units = dict(zip(model.problem.model.names, model.problem.all_units, strict=True))
    for name in values:
        if name not in units:
            raise InputError(f"unknown parameter {name!r}", remedy=nearest(name, units))
    fitted = {parameter["name"]: parameter["value"] for parameter in model.parameters if parameter["value"] is not None}
    start = {name: {"value": value, "unit": units[name]} for name, value in (fitted | values).items()}
    folder = session.next_folder
    write_json(folder / "start.json", {"parameters": start})
    text = edited(job, job.effects, folder)
    session.make(text, session.at, "polished from here", **{"from": session.start_of(folder)})


def _derived(session: Session, text: str, change: str, **facts: Any) -> None:
    """A step that starts from the fit of the current one, if it has one."""
    run: Path = session.step() / "run"
    start = {"from": os.path.relpath(run, session.folder)} if (run / "result.json").exists() else {}
    session.make(text, session.at, change, **start, **facts)
