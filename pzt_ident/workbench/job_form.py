"""From what was confirmed on the page to the text of a job."""

from __future__ import annotations

import json
from typing import Any

from pzt_ident.data.units import factor
from pzt_ident.job.normalise import QUANTITY

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
    """The job of a form: name, records (file, use, which table or sheet, and channels in other files), time or
    sample_rate, axes (drive and response as columns) and model. What is wrong with its words is found when the job is
    read."""
    lines = [f"name: {_text(form['name'])}", "records:"]
    lines += [f"  - {{{line}}}" for record in form["records"] for line in _record(form, record)]
    lines.append("channels:")
    if form.get("time"):
        lines.append(f"  time: {_channel(form['time'])}")
    lines.append("  axes:")
    for axis, roles in form["axes"].items():
        said = ", ".join(f"{role}: {_channel(column)}" for role, column in roles.items())
        lines.append(f"    {_text(axis)}: {{{said}}}")
    words = ", ".join(map(_text, form["model"]))
    return OPENING + "\n".join(lines) + f"\n\nmodel: [{words}]\neffects: []\n" + SEARCH


def places(records: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Whatever in these records names a file."""
    return [place for record in records for place in (record, *record.get("channels", {}).values())]


def _record(form: dict[str, Any], record: dict[str, Any]) -> list[str]:
    """One record, or where its use is "split" two: its first two thirds to identify, and all of it to validate, of
    which the last third is scored, so that the model comes to it with the memory that the stage had."""
    rate = {"sample_rate": form["sample_rate"]} if form.get("sample_rate") else {}
    keys = ("file", "table", "sheet")
    facts = ", ".join(
        f"{key}: {_text(value)}" for key, value in ({k: record.get(k) for k in keys} | rate).items() if value
    )
    if channels := record.get("channels"):
        said = (
            f"{_text(role)}: {{file: {_text(c['file'])}, column: {int(c['number'])}}}" for role, c in channels.items()
        )
        facts += f", channels: {{{', '.join(said)}}}"
    if record["use"] != "split":
        return [f"{facts}, use: {_text(record['use'])}"]
    first = int(record["rows"]) * 2 // 3
    kept = f"settle: {first * _step(form, record):.9g} s"
    return [f"{facts}, use: identify, rows: [0, {first}]", f"{facts}, use: validate, {kept}"]


def _step(form: dict[str, Any], record: dict[str, Any]) -> float:
    """The sample time of a record, s."""
    if form.get("time"):
        return float(record["span"]) * factor(form["time"]["unit"]) / (int(record["rows"]) - 1)
    rate = QUANTITY.match(form["sample_rate"].strip())
    return 1 / (float(rate[1]) * factor(rate[2])) if rate else 1.0  # what is no rate is found when the job is read


def _channel(column: dict[str, Any]) -> str:
    """By its heading where it has one, else by its number; by its unit alone where the records say the rest."""
    if "number" not in column:
        return f"{{unit: {_text(column['unit'])}}}"
    place = f"name: {_text(column['header'])}" if column.get("header") else f"column: {int(column['number'])}"
    return f"{{{place}, unit: {_text(column['unit'])}}}"


def _text(value: Any) -> str:
    """As YAML, whatever is in it: JSON is."""
    return json.dumps(str(value), ensure_ascii=False)
