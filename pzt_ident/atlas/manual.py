"""The manual: chapters in Markdown, with tables that are made from the schema of the job and the readers."""

from __future__ import annotations

import re
from collections.abc import Callable
from html import escape
from importlib.resources import files
from itertools import count
from typing import NamedTuple

from pzt_ident.atlas.job_keys import key_tables
from pzt_ident.atlas.words import linked

FOLDER = files("pzt_ident.atlas") / "manual"


class Chapter(NamedTuple):
    """A chapter as HTML; its anchor is the name of its file without the number: `manual-job_file`."""

    anchor: str
    title: str
    html: str


class Code(NamedTuple):
    """A block of code: its language, and the file that it is, if it is one."""

    language: str
    file: str
    text: str


def names() -> list[str]:
    """The files of the chapters, in order."""
    return sorted(file.name for file in FOLDER.iterdir() if file.name.endswith(".md"))


def source(name: str) -> str:
    """The Markdown of a chapter."""
    return FOLDER.joinpath(name).read_text(encoding="utf-8")


def chapters() -> list[Chapter]:
    """In order."""
    return [chapter(source(name), name) for name in names()]


def chapter(text: str, name: str) -> Chapter:
    """A chapter of its Markdown; headings are one level lower on the page than in the file."""
    from markdown_it import MarkdownIt

    title = re.match(r"# (.+)\n", text)
    assert title, f"{name} has no title"
    html = MarkdownIt("commonmark").enable("table").render(text)
    html = re.sub(r"(</?h)(\d)", lambda match: f"{match[1]}{int(match[2]) + 2}", html)
    html = html.replace("<pre>", '<pre tabindex="0">')
    html = re.sub(r"<code>([^<]+)</code>", lambda match: linked(f"`{match[1]}`"), html)
    numbers = count(1)
    html = html.replace("</table>", "</table></div>")
    html = re.sub("<table>", lambda match: f"{_scrolling(f'{title[1]}, table {next(numbers)}')}<table>", html)
    html = re.sub(r"<p>\{\{ (\w+) \}\}</p>", lambda match: TABLES[match[1]](), html)
    return Chapter(f"manual-{anchor(name)}", title[1], html)


def anchor(name: str) -> str:
    return name.removesuffix(".md").partition("_")[2]


def code_blocks(text: str) -> list[Code]:
    """In order. A block whose first line is `# file: NAME` is that file."""
    blocks = re.findall(r"^```(\w+)\n(?:# file: (\S+)\n)?(.*?)^```$", text, re.S | re.M)
    return [Code(*block) for block in blocks]


def _scrolling(name: str) -> str:
    """The start of a region that scrolls on a narrow screen."""
    return f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(name)}">'


def _job_keys() -> str:
    parts = []
    for section in key_tables():
        rows = "".join(
            f'<tr><th scope="row"><code>{row.key}</code></th><td>{escape(row.value)}</td><td>{escape(row.default)}</td>'
            f"<td>{linked(escape(row.doc, quote=False))}</td></tr>"
            for row in section.rows
        )
        about = linked(escape(section.doc, quote=False))
        head = "".join(f'<th scope="col">{title}</th>' for title in ("key", "value", "default", "what it is"))
        parts.append(
            f"<h4>{section.title}</h4><p>{about}</p>"
            f"{_scrolling('Keys of ' + section.title)}<table>"
            f"<thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>"
        )
    return "".join(parts)


TABLES: dict[str, Callable[[], str]] = {"job_keys": _job_keys}
"""What may stand in a chapter as `{{ name }}`."""
