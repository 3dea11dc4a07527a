"""The report from the disk, without a network: what is marked in one view is seen in all."""

import re

import numpy as np
import pytest
from playwright.sync_api import expect

from pzt_ident.report.page import write_report
from pzt_ident.run.results import read_results
from run_folders import make_run


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = make_run(tmp_path_factory.mktemp("report"), samples=20_000, uses=("identify",), names=("loops.csv",))
    assert write_report(made).stat().st_size < 300 * 1024
    return made


@pytest.fixture(scope="module")
def loaded(browsing, folder):
    with browsing() as page:
        page.goto((folder / "report.html").as_uri())
        yield page


@pytest.fixture
def opened(loaded):
    """The report as it opens: nothing marked."""
    loaded.click("text=Clear")
    expect(loaded.locator(".readout")).to_contain_text("Whole record")
    return loaded


def rmse_shown(page):
    return float(re.search(r"RMSE ([\d.]+) µm", page.text_content(".readout"))[1])


def rmse_of(folder, start=0.0, end=np.inf):
    (trace,) = read_results(folder).traces
    chosen = trace.scored & (trace.time >= start) & (trace.time <= end)
    return np.sqrt(np.mean(trace.residual[chosen] ** 2))


def test_it_opens_without_a_network_or_an_error(opened, folder):
    assert rmse_shown(opened) == pytest.approx(rmse_of(folder), rel=0.006)
    assert opened.locator(".u-wrap > canvas").count() == 2 and opened.locator(".plane canvas.drawn").count() == 2


def test_in_the_dark_the_paper_is(opened):
    paper = "getComputedStyle(document.body).backgroundColor"
    assert opened.evaluate(paper) == "rgb(255, 255, 255)"
    opened.emulate_media(color_scheme="dark")
    assert opened.evaluate(paper) == "rgb(20, 20, 20)"
    opened.emulate_media(color_scheme="light")


def test_a_stretch_by_its_times(opened, folder):
    fields = opened.locator(".bar input")
    fields.nth(0).fill("5")
    fields.nth(1).fill("12")
    fields.nth(1).press("Enter")
    expect(opened.locator(".readout")).to_contain_text(re.compile(r"Marked from (5|5\.0\d*) s to (12|11\.9\d*) s"))
    assert rmse_shown(opened) == pytest.approx(rmse_of(folder, 5, 12), rel=0.02)


def test_a_drag_in_time_marks_the_planes_too(opened):
    before = opened.evaluate("document.querySelectorAll('.plane .marked')[1].toDataURL()")
    box = opened.locator(".curves .u-over").first.bounding_box()
    opened.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 40)
    opened.mouse.down()
    opened.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 60, steps=5)
    opened.mouse.up()
    expect(opened.locator(".readout")).to_contain_text("Marked from")
    ends = [float(opened.locator(".bar input").nth(i).input_value()) for i in (0, 1)]
    assert ends == pytest.approx([12, 20], abs=0.5)
    assert opened.evaluate("document.querySelectorAll('.plane .marked')[1].toDataURL()") != before


def test_a_box_in_the_loop_marks_segments_of_time(opened):
    opened.locator(".plane .pointed").first.scroll_into_view_if_needed()
    box = opened.locator(".plane .pointed").first.bounding_box()
    opened.mouse.move(box["x"] + 0.8 * box["width"], box["y"] + 0.05 * box["height"])
    opened.mouse.down()
    opened.mouse.move(box["x"] + 0.95 * box["width"], box["y"] + 0.4 * box["height"], steps=4)
    opened.mouse.up()
    expect(opened.locator(".readout")).to_contain_text(re.compile(r"Marked \d+ segments"))


def test_the_keyboard_reaches_the_mark(opened):
    opened.locator(".curves").focus()
    opened.keyboard.press("ArrowRight")
    expect(opened.locator(".readout")).to_contain_text("Marked from 0 s to 3.99")
    opened.keyboard.press("Shift+ArrowRight")
    opened.keyboard.press("Enter")
    opened.keyboard.press("Escape")
    expect(opened.locator(".readout")).to_contain_text("Whole record")


def test_it_prints(opened, tmp_path):
    opened.emulate_media(media="print")
    opened.evaluate("dispatchEvent(new Event('beforeprint'))")
    width = "[...document.querySelectorAll('.explorer canvas')].map((one) => one.getBoundingClientRect().right)"
    assert max(opened.evaluate(width)) < 180 / 25.4 * 96
    assert not opened.locator(".plane .marked").first.is_visible()  # it would cut out what is below
    opened.evaluate("dispatchEvent(new Event('afterprint'))")
    opened.emulate_media(media="screen")
    opened.pdf(path=tmp_path / "report.pdf", format="A4")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")
