"""What the README shows is run."""

import re
import subprocess
import sys
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"


def block(name: str) -> str:
    """The code block behind the comment `<!-- name -->`."""
    found = re.search(rf"<!-- {name} -->\s*```\w*\n(.*?)```", README.read_text(encoding="utf-8"), re.S)
    assert found, f"no block {name!r} in README.md"
    return found[1]


def run(code: str, folder: Path) -> str:
    command = [sys.executable, "-c", code]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, encoding="utf-8", check=True).stdout


def test_the_library_example_finds_what_is_hidden(tmp_path, monkeypatch, capsys):
    """In this process, which has the libraries loaded; the next one is in its own."""
    code = block("library")
    assert len(code.strip().splitlines()) <= 30
    monkeypatch.chdir(tmp_path)
    exec(code, {"__name__": "__main__"})
    shown = capsys.readouterr().out
    assert shown.startswith("bouc_wen -> lumped")
    for part in ("\nMissing: quadratic_gain", "+ creep", "\nThe model is adequate"):
        assert part in shown
    assert {path.name for path in tmp_path.iterdir()} == {"run", "report.html"}


def test_the_optimizer_example_finds_the_minimum(tmp_path):
    code = block("minimize")
    assert len(code.split("\n\n\n")[-1].strip().splitlines()) < 10
    assert run(code, tmp_path).startswith("[1. 1.]")
    assert not list(tmp_path.iterdir())


def test_paths_in_the_readme_exist():
    text = README.read_text(encoding="utf-8")
    for path in re.findall(r"\]\(([\w/.]+)\)", text) + re.findall(r"`((?:configs|experiments|results)/[\w/.]+)`", text):
        assert (README.parent / path).exists(), path


def test_each_decision_is_told_in_short_and_in_full():
    short, full = README.read_text(encoding="utf-8"), README.parent / "experiments/decisions.md"
    table = short[short.index("## Decisions") :]
    names = [
        [line.split(" | ")[0] for line in text.splitlines() if line[:2] == "| "] for text in (table, full.read_text())
    ]
    assert names[0] == names[1] and len(names[0]) > 100
