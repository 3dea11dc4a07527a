"""The commands on the words and keys that a job may use: `list`, `show`, `atlas`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pzt_ident.cli.options import EXISTING, answer, output_options, plugins_option

if TYPE_CHECKING:
    from pzt_ident.atlas.job_keys import Section

KINDS = ("blocks", "effects", "optimizers")


@click.command("list")
@click.argument("kind", type=click.Choice((*KINDS, "keys")), required=False)
@plugins_option
@output_options
def list_(kind: str | None, as_json: bool, quiet: bool) -> None:
    """List the words that a job may use, of one kind or all, or its keys."""
    if kind == "keys":
        list_keys(as_json, quiet)
        return
    from pzt_ident.cli.table import table
    from pzt_ident.model.description import words

    docs = {each: words(each) for each in ([kind] if kind else KINDS)}

    def show_lists() -> None:
        for each, some in docs.items():
            table((each, "what it is"), list(some.items()))

    answer(docs[kind] if kind else docs, show_lists, as_json, quiet)


def list_keys(as_json: bool, quiet: bool) -> None:
    from pzt_ident.atlas.job_keys import key_tables

    tell_keys(key_tables(), as_json, quiet)


def tell_keys(sections: list[Section], as_json: bool, quiet: bool) -> None:
    from pzt_ident.cli.table import table

    def show_sections() -> None:
        for section in sections:
            click.echo(f"{section.title}. {section.doc}\n")
            table(("key", "value", "default", "what it is"), section.rows)

    keys = {section.title: {row.key: row._asdict() for row in section.rows} for section in sections}
    answer(keys, show_sections, as_json, quiet)


@click.command()
@click.argument("name")
@plugins_option
@output_options
def show(name: str, as_json: bool, quiet: bool) -> None:
    """Show what a block, effect or optimizer declares, or what a key of a job is."""
    from pzt_ident.atlas.job_keys import sections_of
    from pzt_ident.cli.word_tables import show_word
    from pzt_ident.model.description import description_of, is_word

    sections = [] if is_word(name) else sections_of(name)
    if sections:
        tell_keys(sections, as_json, quiet)
        return
    description = description_of(name)
    answer(description, lambda: show_word(description), as_json, quiet)


@click.command()
@click.option("-o", "--out", type=EXISTING, default=Path("atlas.html"), show_default=True, help="The page to write.")
@plugins_option
@output_options
def atlas(out: Path, as_json: bool, quiet: bool) -> None:
    """Write the atlas of effects and the manual, one page that needs no network.

    Every word that a job may use has a section: equation, sources, parameters, pictures of what it does, what looks
    like it, the drive that tells them apart, and the remedy.
    """
    from pzt_ident.atlas.page import drawn, write_atlas
    from pzt_ident.cli.table import tracked

    for _ in tracked(drawn(), "words", as_json or quiet):
        pass
    path = write_atlas(out)
    answer({"atlas": str(path)}, lambda: click.echo(f"atlas: {path}"), as_json, quiet)
