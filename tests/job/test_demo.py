"""The story that ships: what is hidden is found, and the error falls to the noise."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from cut_texts import cut_texts
from pzt_ident.cli.commands import main
from pzt_ident.errors import InputError
from pzt_ident.job.demo import hidden, show_in_browser, write_demo
from pzt_ident.report.figures import drawn, plates
from pzt_ident.report.style import COLUMN, PAGE
from pzt_ident.run.results import read_folder


def test_the_demo_finds_what_is_hidden(tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr("pzt_ident.job.demo.show_in_browser", opened.append)
    answer = CliRunner().invoke(main, ["demo", "--out", str(tmp_path / "demo")])
    assert answer.exit_code == 0, answer.output
    improvement = json.loads((tmp_path / "demo" / "improved" / "improvement.json").read_text(encoding="utf-8"))
    assert set(improvement["effects"]) == {item["effect"] for item in hidden()}
    assert improvement["verdict"] == "adequate"
    first, last = improvement["steps"][0]["rmse"], improvement["steps"][-1]["rmse"]
    assert last["validate"] < 1.25 * improvement["floor"] < 0.2 * first["validate"]
    assert opened == [tmp_path / "demo" / "improved" / "report.html"]
    assert opened[0].stat().st_size < 300 * 1024
    assert "hidden effects: " in answer.stdout
    for plate in plates(read_folder(opened[0].parent)):
        assert not cut_texts(drawn(plate, COLUMN)) + cut_texts(drawn(plate, PAGE)), plate.name


def test_the_truth_is_not_beside_the_job(tmp_path):
    job = write_demo(tmp_path / "demo")
    assert {path.name for path in job.parent.iterdir()} == {"job.yaml", "identify.csv", "validate.csv"}
    assert not any(item["effect"] in job.read_text(encoding="utf-8") for item in hidden())
    with pytest.raises(InputError, match="exists already"):
        write_demo(tmp_path / "demo")


def test_without_a_window_no_browser_is_opened(monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setattr("webbrowser.open", lambda address: pytest.fail(address))
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert not show_in_browser(Path("report.html"))
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr("webbrowser.open", lambda address: address.startswith("file://"))
    assert show_in_browser(Path("report.html"))
