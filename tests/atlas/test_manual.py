"""The code of the manual runs, chapter by chapter, as a reader would run it."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from pzt_ident.atlas.manual import chapter, code_blocks, names, source
from pzt_ident.cli.commands import main

ROOT = str(Path(__file__).parents[2])


def run(*command):
    """In a process of its own, since a word that is registered stays so."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([ROOT, os.getcwd()])}
    ran = subprocess.run([sys.executable, *command], env=environment, capture_output=True, text=True, encoding="utf-8")
    assert ran.returncode == 0, (command, ran.stdout, ran.stderr)


def run_here(*command):
    ran = CliRunner().invoke(main, command)
    assert ran.exit_code == 0, (command, ran.output, ran.exception)


@pytest.mark.parametrize("name", names())
def test_code_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = code_blocks(source(name))
    registers = any(block.file.endswith(".py") for block in blocks)
    for block in blocks:
        if block.file:
            Path(block.file).write_text(block.text, encoding="utf-8")
        elif block.language == "sh":
            for line in block.text.splitlines():
                command, *arguments = shlex.split(line)
                assert command == "pzt-ident"
                run("-m", "pzt_ident", *arguments) if registers else run_here(*arguments)
        else:
            assert block.language == "python", "give a file its name, `# file: NAME`"
            run("-c", block.text) if registers else exec(block.text, {"__name__": "__main__"})


def test_a_chapter_is_a_part_of_the_page():
    made = chapter("# A title\n\nSee `creep` and `job.yaml`.\n\n## Keys\n\n{{ job_keys }}\n", "10_first.md")
    assert (made.anchor, made.title) == ("manual-first", "A title")
    assert made.html.startswith("<h3>A title</h3>") and "<h4>Keys</h4>" in made.html
    assert '<a href="#word-creep"><code>creep</code></a>' in made.html and "<code>job.yaml</code>" in made.html
    assert "<code>rule_out</code>" in made.html
