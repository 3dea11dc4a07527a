"""Several results on one page."""

import json
import re
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from pzt_ident.cli.commands import main
from pzt_ident.report.side_by_side import labels, ranking, write_side_by_side
from pzt_ident.run.results import read_folder
from run_folders import make_run


@pytest.mark.parametrize(
    ("folders", "names"),
    [(["a/x", "a/y"], ["x", "y"]), (["a/x", "b/x"], ["a/x", "b/x"]), (["a", "a"], ["1: a", "2: a"])],
)
def test_folders_go_by_as_little_of_their_path_as_tells_them_apart(folders, names):
    assert labels([Path(folder) for folder in folders]) == names


@pytest.fixture
def pair(tmp_path):
    first = make_run(tmp_path / "plain", samples=80)
    second = make_run(tmp_path / "other", samples=80, optimizers=("pso", "rga"))
    shutil.copy(first / "signals.nc", second / "signals.nc")
    return first, second


def test_models_of_the_same_samples_are_in_one_figure(pair, tmp_path):
    page = write_side_by_side(pair, tmp_path / "both.html").read_text(encoding="utf-8")
    content = json.loads(re.search(r'id="content">(.*?)</script>', page, re.S)[1])
    assert [[model["name"] for model in record["models"]] for record in content["records"]] == [["plain", "other"]] * 2
    assert "plain and other have the lowest RMSE on the validation records" in page
    assert {path.name for path in (tmp_path / "both").iterdir()} == {
        f"{table}.{form}" for table in ("results", "parameters") for form in ("csv", "tex")
    }


def test_every_word_is_explained_on_the_page(pair, tmp_path):
    page = write_side_by_side(pair, tmp_path / "both.html").read_text(encoding="utf-8")
    assert set(re.findall(r'<article id="word-(\w+)">', page)) == {"bouc_wen", "lumped"}
    assert set(re.findall(r'<a href="#word-(\w+)">\1\.', page)) == {"bouc_wen", "lumped"}


def test_other_units_are_not_ranked(pair, tmp_path):
    result = json.loads((pair[1] / "result.json").read_text())
    (pair[1] / "result.json").write_text(json.dumps(result | {"unit": "nm"}))
    assert "cannot be ranked" in write_side_by_side(pair, tmp_path / "both.html").read_text(encoding="utf-8")


def test_the_command_writes_it(pair, tmp_path, monkeypatch):
    monkeypatch.setattr("pzt_ident.report.figures.write_all_figures", lambda folders, listen: None)
    answer = CliRunner().invoke(main, ["report", *map(str, pair), "-o", str(tmp_path / "both.html")])
    assert answer.exit_code == 0, answer.output
    assert answer.stdout.splitlines() == [
        *(str(folder / "report.html") for folder in pair),
        str(tmp_path / "both.html"),
    ]


def test_results_that_are_printed_alike_have_no_winner(tmp_path):
    results = {name: read_folder(make_run(tmp_path / name, samples=80)) for name in ("a", "b")}
    use = "validate" if results["a"].rmse["validate"] is not None else "identify"
    results["b"].rmse[use] *= 1 + 1e-9
    assert ranking(results).startswith("a and b have the lowest RMSE on the validation records, ")


@pytest.mark.parametrize(("other", "tied"), [(0.00492, True), (0.00600, False)])
def test_a_winner_is_ahead_by_more_than_the_noise_leaves_open(tmp_path, other, tied):
    """0.00004 um at a noise of 0.00488 um is no victory."""
    results = {name: read_folder(make_run(tmp_path / name, samples=80)) for name in ("a", "b")}
    for result, error in zip(results.values(), (0.00488, other), strict=True):
        result.result["floor"] = 0.00488
        result.rmse["validate"] = error
    assert ("differ by less than the noise" in ranking(results)) == tied
