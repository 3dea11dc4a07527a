"""The code of the manual runs, chapter by chapter, as a reader would run it."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from pzt_ident.atlas.manual import chapter, code_blocks, names, source

ROOT = str(Path(__file__).parents[2])


def run(command, folder):
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([ROOT, str(folder)])}
    ran = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, encoding="utf-8")
    assert ran.returncode == 0, (command, ran.stdout, ran.stderr)


@pytest.mark.parametrize("name", names())
def test_code_runs(name, tmp_path):
    for block in code_blocks(source(name)):
        if block.file:
            (tmp_path / block.file).write_text(block.text, encoding="utf-8")
        elif block.language == "sh":
            for line in block.text.splitlines():
                command, *arguments = shlex.split(line)
                assert command == "pzt-ident"
                run([sys.executable, "-m", "pzt_ident", *arguments], tmp_path)
        else:
            assert block.language == "python", "give a file its name, `# file: NAME`"
            run([sys.executable, "-c", block.text], tmp_path)


def test_a_chapter_is_a_part_of_the_page():
    made = chapter("# A title\n\nSee `creep` and `job.yaml`.\n\n## Keys\n\n{{ job_keys }}\n", "10_first.md")
    assert (made.anchor, made.title) == ("manual-first", "A title")
    assert made.html.startswith("<h3>A title</h3>") and "<h4>Keys</h4>" in made.html
    assert '<a href="#word-creep"><code>creep</code></a>' in made.html and "<code>job.yaml</code>" in made.html
    assert "<code>rule_out</code>" in made.html
