"""The notebook runs from its first cell to its last, to what its text says."""

import json
from pathlib import Path

import matplotlib
import pytest

from pzt_ident.job.demo import hidden

NOTEBOOK = Path(__file__).parents[2] / "experiments" / "notebook" / "hidden_effect.ipynb"


@pytest.fixture(scope="module")
def cells():
    return json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]


def code(cells):
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


def test_every_cell_runs_and_the_error_falls_to_the_noise(cells, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    matplotlib.use("agg")
    names = {"__name__": "notebook"}
    for source in code(cells):
        exec(compile(source, NOTEBOOK.name, "exec"), names)
    assert names["diagnosis"].missing == ["quadratic_gain"]
    assert set(names["steps"].effects) == {item["effect"] for item in hidden()}
    assert names["best"].rmse["validate"] < 1.1 * names["best"].noise_floor["x"]
    assert names["best"].rmse["validate"] < 0.05 * names["fit"].rmse["validate"]
    assert str(names["again"]) == str(names["best"])
    assert not list(tmp_path.iterdir())


def test_it_is_stored_as_it_was_run_and_small(cells):
    assert NOTEBOOK.stat().st_size < 400_000
    ran = [cell["execution_count"] for cell in cells if cell["cell_type"] == "code"]
    assert ran == [*range(1, len(ran) + 1)]
    errors = [out for cell in cells for out in cell.get("outputs", []) if out["output_type"] == "error"]
    assert not errors
    assert max(len(source.splitlines()) for source in code(cells)) <= 12
