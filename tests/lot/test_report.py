"""The report on a lot: one file, what it says, and the pages that it leads to."""

import re
import shutil
from html import unescape
from pathlib import Path
from urllib.parse import unquote

import pytest

from cut_texts import cut_texts
from pzt_ident.errors import InputError
from pzt_ident.files import read_sealed, write_sealed
from pzt_ident.lot import report
from pzt_ident.lot.figures import NAMED, bars, plates
from pzt_ident.lot.outcome import read_lot
from pzt_ident.lot.report import write_fleet_report
from pzt_ident.model.registry import blocks
from pzt_ident.report.figures import drawn
from pzt_ident.report.style import COLUMN, PAGE
from pzt_ident.run.place import Local

EVIL = "<script>alert('x')</script>"


@pytest.fixture(scope="module")
def page(identified, tmp_path_factory):
    out = shutil.copytree(identified[0], tmp_path_factory.mktemp("report") / "out")
    return write_fleet_report(out, place=Local(2))


def test_it_is_one_file_without_a_network_and_leads_to_a_page_a_device(page):
    text = page.read_text(encoding="utf-8")
    assert not re.search(r'(src|href)="(https?:)?//', text)
    links = {unquote(link) for link in re.findall(r'<a href="([^"#]+)"', text)}
    assert links >= {"devices.csv", "devices.parquet", "job.yaml"}
    assert all((page.parent / link).is_file() for link in links)
    done = [row["device"] for row in read_lot(page.parent).done]
    assert {f"devices/{name}/report.html" for name in done} <= links
    for name in ("spreads", "columns"):
        if (page.parent / "figures" / f"{name}-180mm.svg").exists():
            assert f'id="{name}-caption"' in text


def test_it_names_what_is_broken_and_what_is_out_of_line(page):
    text, lot = page.read_text(encoding="utf-8"), read_lot(page.parent)
    for row in lot.broken:
        assert row["device"] in text
    assert "the file is empty" in text
    assert f"of {len(lot.rows)} devices" in text
    for finding in lot.findings:
        assert finding.device in text


@pytest.mark.parametrize("width", [COLUMN, PAGE])
def test_no_text_of_a_figure_is_cut(page, width):
    drawings = [drawn(plate, width) for plate in plates(read_lot(page.parent))]
    assert drawings and not [text for drawing in drawings for text in cut_texts(drawing)]


def test_each_determined_device_is_in_one_bar_of_each_quantity(page):
    lot = read_lot(page.parent)
    shown = [quantity for quantity in lot.quantities if quantity.usable.sum() > 1]
    parts = [part for part in bars(lot, shown).values() if part["role"] == "button"]
    for quantity in shown:
        ends = [(part, float(part["data-low"]), float(part["data-below"])) for part in parts]
        ends = [end for end in ends if end[0]["data-quantity"] == quantity.name]
        for row, value, known in zip(lot.done, quantity.values, quantity.usable, strict=True):
            mine = [part for part, low, below in ends if low <= value < below]
            assert len(mine) == 1 or not known
            if known and int(mine[0]["data-count"]) <= NAMED:
                assert row["device"] in re.split(", | and |: ", mine[0]["aria-label"])
        assert sum(int(part["data-count"]) for part, _, _ in ends) == quantity.usable.sum()
    assert page.read_text(encoding="utf-8").count("data-below=") == len(parts)


def test_every_word_is_explained_on_the_page(page):
    text = page.read_text(encoding="utf-8")
    explained = set(re.findall(r'<article id="word-(\w+)">', text))
    assert explained == set(re.findall(r'href="#word-(\w+)"', text))
    names = [name for item in read_lot(page.parent).quantities for name in item.name.split(".")]
    assert {name for name in names if name in blocks} <= explained != set()


def test_pages_are_drawn_once(page):
    times = {path: path.stat().st_mtime_ns for path in page.parent.glob("devices/*/report.html")}
    assert times
    write_fleet_report(page.parent, place=Local(1))
    assert {path: path.stat().st_mtime_ns for path in times} == times


def test_a_device_whose_page_cannot_be_drawn_is_named_with_the_reason_and_the_others_are_drawn(page, tmp_path):
    out, events = shutil.copytree(page.parent, tmp_path / "out"), []
    first, second, *_ = (row["device"] for row in read_lot(out).done)
    for name in (first, second):
        (out / "devices" / name / "report.html").unlink()
    (out / "devices" / first / "signals.nc").write_bytes(b"")
    text = write_fleet_report(out, place=Local(1), listen=events.append).read_text(encoding="utf-8")
    (said,) = [event["said"] for event in events if event["event"] == "undrawn"]
    assert said.startswith(f"{first} has no page: ") and "signals.nc: is damaged" in said and "\n" not in said
    assert f"<li>{first} has no page: " in text and f'href="devices/{first}/report.html"' not in text
    assert (out / "devices" / second / "report.html").exists()


def test_an_unfinished_fleet_has_a_report(identified, tmp_path):
    out = shutil.copytree(identified[0], tmp_path / "out")
    lot = read_lot(out)
    for row in lot.done[1:]:
        shutil.rmtree(out / "devices" / row["device"])
    text = write_fleet_report(out, place=Local(1)).read_text(encoding="utf-8")
    assert f"{len(lot.done) - 1} devices are not done" in text


def test_of_many_devices_the_table_has_those_that_stand_out_and_the_first_of_the_others(identified, monkeypatch):
    lot = read_lot(identified[0])
    monkeypatch.setattr(report, "MOST_LINES", 4)
    far = list(dict.fromkeys(finding.device for finding in lot.findings))
    shown = [line["device"] for line in report.device_lines(lot)]
    assert len(shown) == 4 and {*far[:4]} <= {*shown}


def test_columns_that_were_taken_as_words_are_named_with_the_reason(identified, tmp_path):
    out = shutil.copytree(identified[0], tmp_path / "out")
    listed = read_sealed(out / "devices.json")
    for place, device in enumerate(listed["devices"]):
        device["columns"] |= {"bench": "4 B" if place == 2 else str(place), "serial": place or None}
    write_sealed(out / "devices.json", listed)
    text = unescape(write_fleet_report(out, place=Local(1)).read_text(encoding="utf-8"))
    (said,) = re.findall("<p[^>]*>([^<]*): the column is taken as words", text)
    assert said == f"'4 B' ({listed['devices'][2]['device']}) under 'bench' is no number, as most others are"
    assert "<td>1</td>" in text and "<td>1.000</td>" not in text


def test_names_from_a_table_are_no_markup(identified, tmp_path):
    out = shutil.copytree(identified[0], tmp_path / "out")
    listed = read_sealed(out / "devices.json")
    for place, device in enumerate(listed["devices"]):
        device["columns"] |= {EVIL: EVIL + str(place % 2)}
    write_sealed(out / "devices.json", listed)
    text = write_fleet_report(out, place=Local(1)).read_text(encoding="utf-8")
    assert EVIL not in text
    assert "&lt;script&gt;" in text


@pytest.mark.parametrize("file", ["fleet.json", "devices.json"])
@pytest.mark.parametrize("content", ["", "{", "[]", "7", '{"patterns": 3}', "[1, 2]", '[{"device": 1}]'])
def test_a_damaged_fleet_is_told_in_a_sentence(identified, tmp_path, file, content):
    out = shutil.copytree(identified[0], tmp_path / "out")
    (out / file).write_text(content)
    try:
        write_fleet_report(out, place=Local(1))
    except InputError as error:
        assert str(out) in str(error)
        assert error.remedy


def test_there_is_no_report_on_something_else(tmp_path):
    with pytest.raises(InputError, match="holds no fleet"):
        write_fleet_report(Path(tmp_path))
