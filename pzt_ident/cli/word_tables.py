"""What a block, effect or optimizer declares, as text for the terminal."""

from __future__ import annotations

from textwrap import fill
from typing import Any

import click

from pzt_ident.atlas.href import href
from pzt_ident.cli.table import grouped_by_range, table
from pzt_ident.data.notation import either, listed
from pzt_ident.model.block import Place
from pzt_ident.model.registry import blocks, word_of

Facts = dict[str, Any]

WIDTH = 115
SAYINGS = {"Leaves much the same trace as": "look_alikes", "To tell": "separate_by", "To do": "remedy"}
UNITS = """\
Bounds in units of drive or response are declared in the largest peak-to-peak value of a record to identify:
over 100 V, 0 to 60 1/drive is 0 to 0.6 1/V. A job has the units of its files; `pzt-ident check JOB` prints
its bounds in these. A gain, and what an operator puts out, has either sign where the response does not rise
with the drive."""


def show_word(facts: Facts) -> None:
    click.echo(f"{facts['name']} ({facts['kind']})\n\n{facts['doc']}\n")
    if source := facts.get("source"):
        click.echo(f"{source}\n")
    if not facts.get("convergent", True):
        click.echo("It approaches an optimum, but does not converge to it.\n")
    if len(forms := facts.get("forms", ())) > 1:
        table(("form, in a job", "what it is"), [(row["item"], row["doc"]) for row in forms])
    if places := _places(facts):
        click.echo(f"{places}\n")
    if "settings" in facts:
        table(
            ("setting", "default", "from - to", "unit", "what it is"),
            [
                (row["name"], row["default"], _allowed(row), row["unit"], row["doc"] + _with_form(row))
                for row in facts["settings"]
            ],
        )
    if written := facts.get("in_a_job"):
        click.echo(f"In a job: {written}\n")
    if "parameters" in facts:
        _show_parameters(facts)
    for title, key in SAYINGS.items():
        if text := facts.get(key):
            click.echo(f"\n{title}: {text if isinstance(text, str) else ', '.join(text)}")
    click.echo(f"\nPictures and more: `pzt-ident atlas` writes {href(facts['name'])}")


def _places(facts: Facts) -> str:
    """Where a block acts in the chain, in each of its forms; empty of what belongs to the parameters of others."""
    forms = facts.get("forms") or [{"item": facts["name"], "place": facts.get("place")}]
    acts = []
    for place in [place.name.lower() for place in Place]:
        items = [f"`{form['item']}`" for form in forms if form["place"] == place]
        if items:
            acts.append(f"{listed(items)} {'acts' if len(items) == 1 else 'act'} at {place}")
    if not acts:
        return ""
    chain = listed([place.name.lower() for place in Place])
    order = "At one place blocks act in the order of the job, couplings behind the others."
    return fill(f"{'; '.join(acts)}. The chain goes from the drive through {chain} to the reading. {order}", WIDTH)


def _show_parameters(facts: Facts) -> None:
    """The table of parameters, by their names in a job, behind what their units mean there."""
    word, rows = word_of(facts["name"]), [*grouped_by_range(facts["parameters"])]
    if any("drive" in row["unit"] or "response" in row["unit"] for row in rows):
        click.echo(f"{UNITS}\n")
    names = [row["name"] if "." in row["name"] else f"{word}.{row['name']}" for row in rows]
    table(
        ("parameter, in a job", "unit", "bounds", "null", "what it is"),
        [
            (name, row["unit"], "{:g} to {:g}".format(*row["bounds"]), _number(row["null"]), _meaning(row))
            for name, row in zip(names, rows, strict=True)
        ],
    )
    own = [name.partition(" ")[0] for name, row in zip(names, rows, strict=True) if not row["per_record"]]
    if own:
        click.echo(f"Of one of several axes: `x.{own[0]}`.")


def _allowed(row: Facts) -> str:
    return " or ".join(row["words"]) if "words" in row else "{:g} to {:g}".format(*row["bounds"])


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:g}"


def _meaning(row: Facts) -> str:
    """What a parameter is, and when it is searched for."""
    fixed = "" if row["value"] is None else f" Fixed at {row['value']:g} unless the job gives bounds or another value."
    effect = f" With {either(map(_needed, row['effects']))} only." if row["effects"] else ""
    per_record = " Each record has its own." if row["per_record"] else ""
    per_record += " Of every axis but the first." if row["per_later_axis"] else ""
    apart = f" Wide bounds of `{row['adds_to']}` or of the rest of its block hide it: fix what is known."
    positive = " Above 0." if row["scale"] == "log" else ""
    return row["doc"] + positive + fixed + effect + per_record + _with_form(row) + (apart if row["adds_to"] else "")


def _with_form(row: Facts) -> str:
    return f" With `{row['form']}` only." if row.get("form") else ""


def _needed(effect: str) -> str:
    """An effect as a job names it: one in all its forms, or in the first, which the word alone means, or in another."""
    forms = blocks.forms(effect) if word_of(effect) in blocks else [effect]
    if len(forms) == 1 or effect in forms[1:]:
        return f"`{effect}`"
    return f"`{forms[0]}`, in any of its forms," if effect == forms[0] else f"`{forms[0]}` in its first form"
