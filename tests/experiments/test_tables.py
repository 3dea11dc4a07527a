"""The tables of an experiment come out of its committed results, and its README shows them."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NAMES = sorted(path.parent.name for path in ROOT.glob("experiments/*/table.py"))


@pytest.mark.parametrize("name", NAMES)
def test_the_readme_shows_what_the_command_prints(name):
    folder = ROOT / "results" / "reference" / name
    command = [sys.executable, "-m", f"experiments.{name}.table", str(folder)]
    printed = subprocess.run(command, cwd=ROOT, capture_output=True, encoding="utf-8", check=True).stdout.strip()
    assert printed == (folder / "table.md").read_text(encoding="utf-8").strip()
    assert printed in (ROOT / "experiments" / name / "README.md").read_text(encoding="utf-8")


def test_a_folder_without_results_is_said(tmp_path):
    command = [sys.executable, "-m", "experiments.case_1.table", str(tmp_path)]
    failed = subprocess.run(command, cwd=ROOT, capture_output=True, encoding="utf-8")
    assert failed.returncode == 1
    assert "each finished job" in failed.stderr


def test_there_are_tables_to_test():
    assert NAMES
