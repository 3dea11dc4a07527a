"""The text of a job from the form that the page sends."""

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
    """The job of a form with name, records (file, use, table or sheet, channels in other files), time or sample_rate,
    axes (drive and response as columns) and model. The words are checked when the job is read."""
    lines = [f"name: {_text(form['name'])}", "records:"]
    lines += [f"  - {{{line}}}" for record in form["records"] for line in _record(form, record)]
    lines.append("channels:")
    if form.get("time"):
        lines.append(f"  time: {_channel(form['time'])}")
    lines.append("  axes:")
    for axis, roles in form["axes"].items():
        channels = ", ".join(f"{role}: {_channel(column)}" for role, column in roles.items())
        lines.append(f"    {_text(axis)}: {{{channels}}}")
    model = ", ".join(map(_text, form["model"]))
    return OPENING + "\n".join(lines) + f"\n\nmodel: [{model}]\neffects: []\n" + SEARCH


def file_sources(records: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """All mappings of these records that name a file: the records and their channels."""
    return [source for record in records for source in (record, *record.get("channels", {}).values())]


def _record(form: dict[str, Any], record: dict[str, Any]) -> list[str]:
    """The lines of one record. A use of "split" gives two: the first two thirds for identification, and the whole
    record for validation with only its last third scored, so that the model has the history of the stage there. `crop`:
    the first sample that is taken, and the first that is not; `settle`: a time that is not scored."""
    rate = {"sample_rate": form["sample_rate"]} if form.get("sample_rate") else {}
    keys = ("file", "table", "sheet")
    facts = ", ".join(
        f"{key}: {_text(value)}" for key, value in ({k: record.get(k) for k in keys} | rate).items() if value
    )
    if channels := record.get("channels"):
        columns = (
            f"{_text(role)}: {{file: {_text(channel['file'])}, column: {int(channel['number'])}}}"
            for role, channel in channels.items()
        )
        facts += f", channels: {{{', '.join(columns)}}}"
    begin, end = map(int, record.get("crop") or (0, record.get("rows", 0)))
    rows = f", rows: [{begin}, {end}]" if record.get("crop") else ""
    settle = f", settle: {_text(record['settle'])}" if record.get("settle") else ""
    if record["use"] != "split":
        return [f"{facts}, use: {_text(record['use'])}{rows}{settle}"]
    first = (end - begin) * 2 // 3
    kept_back = f"settle: {first * _sample_time(form, record):.9g} s"
    fitted = f"rows: [{begin}, {begin + first}]"
    return [f"{facts}, use: identify, {fitted}{settle}", f"{facts}, use: validate{rows}, {kept_back}"]


def _sample_time(form: dict[str, Any], record: dict[str, Any]) -> float:
    """The sample time of a record, s."""
    if form.get("time"):
        return float(record["span"]) * factor(form["time"]["unit"]) / (int(record["rows"]) - 1)
    rate = QUANTITY.match(form["sample_rate"].strip())
    return 1 / (float(rate[1]) * factor(rate[2])) if rate else 1.0  # an invalid rate is reported when the job is read


def _channel(column: dict[str, Any]) -> str:
    """A column by its heading if it has one, else by its number; by its unit alone where records name it."""
    if "number" not in column:
        return f"{{unit: {_text(column['unit'])}}}"
    place = f"name: {_text(column['header'])}" if column.get("header") else f"column: {int(column['number'])}"
    return f"{{{place}, unit: {_text(column['unit'])}}}"


def _text(value: Any) -> str:
    """Any value as a YAML string; a JSON string is one."""
    return json.dumps(str(value), ensure_ascii=False)
