"""From what was confirmed on the page to the text of a job."""

from __future__ import annotations

import json
from typing import Any

OPENING = """\
# Made in the workbench. In a terminal, from the folder that the workbench was started in:
#   pzt-ident run JOB          identifies the model
#   pzt-ident diagnose JOB     says what it misses
#   pzt-ident improve JOB      adds it, step by step

"""
SEARCH = """\

# Equal numbers of evaluations; the local polish at the end of a run is the same for all.
optimizers:
  - {name: pso, population: 70, generations: 150}
  - {name: differential_evolution}
seed: 7
"""


def job_text(form: dict[str, Any]) -> str:
    """The job of a form: name, records (file, use, and which table or sheet), time or sample_rate, axes (drive and
    response as columns) and model. What is wrong with its words is found when the job is read."""
    lines = [f"name: {_text(form['name'])}", "records:"]
    rate = {"sample_rate": form["sample_rate"]} if form.get("sample_rate") else {}
    for record in form["records"]:
        facts = {key: record[key] for key in ("file", "use", "table", "sheet") if record.get(key)} | rate
        lines.append(f"  - {{{', '.join(f'{key}: {_text(value)}' for key, value in facts.items())}}}")
    lines.append("channels:")
    if form.get("time"):
        lines.append(f"  time: {_channel(form['time'])}")
    lines.append("  axes:")
    for axis, roles in form["axes"].items():
        said = ", ".join(f"{role}: {_channel(column)}" for role, column in roles.items())
        lines.append(f"    {_text(axis)}: {{{said}}}")
    words = ", ".join(map(_text, form["model"]))
    return OPENING + "\n".join(lines) + f"\n\nmodel: [{words}]\neffects: []\n" + SEARCH


def _channel(column: dict[str, Any]) -> str:
    """By its heading where it has one, else by its number."""
    place = f"name: {_text(column['header'])}" if column.get("header") else f"column: {int(column['number'])}"
    return f"{{{place}, unit: {_text(column['unit'])}}}"


def _text(value: Any) -> str:
    """As YAML, whatever is in it: JSON is."""
    return json.dumps(str(value), ensure_ascii=False)
