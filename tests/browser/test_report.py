"""The report from the disk, without a network: what is marked in one view is seen in all."""

import re

import numpy as np
import pytest
from playwright.sync_api import expect

from browser.conftest import faults_of
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
    loaded.click("text=Show all")
    loaded.click("[data-mode=mark]")
    if loaded.locator("text=Clear mark").is_enabled():
        loaded.click("text=Clear mark")
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
    assert opened.locator(".plot canvas.drawn").count() == 3
    assert faults_of(opened) == []


def test_its_figures_can_be_read_on_a_phone(opened):
    opened.set_viewport_size({"width": 390, "height": 800})
    heights = [text.bounding_box()["height"] for text in opened.locator("figure svg text").all() if text.is_visible()]
    assert opened.evaluate("document.documentElement.scrollWidth") <= 390
    opened.set_viewport_size({"width": 1280, "height": 800})
    assert heights and min(heights) > 8


def test_the_edges_of_the_noise_band_are_over_the_residual(opened):
    """Rows of the plot that have the colour of the noise floor from end to end."""
    rows = opened.evaluate(
        """() => {
          const canvas = document.querySelector(".lower canvas.moving"), left = Math.round(0.2 * canvas.width);
          const floor = getComputedStyle(document.documentElement).getPropertyValue("--floor").trim();
          const wanted = [1, 3, 5].map((start) => parseInt(floor.slice(start, start + 2), 16)).concat(255);
          const { data, width, height } = canvas.getContext("2d").getImageData(left, 0, 3 * left, canvas.height);
          const columns = [...Array(width).keys()], rows = [...Array(height).keys()];
          const green = (x, y) => wanted.every((part, k) => data[4 * (y * width + x) + k] === part);
          return rows.filter((y) => columns.every((x) => green(x, y)));
        }"""
    )
    assert len(rows) == 4 and rows[1] - rows[0] == rows[3] - rows[2] == 1 and rows[2] - rows[1] > 2
    expect(opened.locator(".lower .legend")).to_contain_text("noise floor (RMS)")
    expect(opened.locator("#model")).to_contain_text("about a third of it lies outside the band")


def test_in_the_dark_the_paper_is(opened):
    paper = "getComputedStyle(document.body).backgroundColor"
    assert opened.evaluate(paper) == "rgb(255, 255, 255)"
    opened.emulate_media(color_scheme="dark")
    assert opened.evaluate(paper) == "rgb(20, 20, 20)"
    opened.emulate_media(color_scheme="light")


def test_a_drag_in_time_marks_the_loop_too(opened, folder):
    before = opened.evaluate("document.querySelector('.loop canvas.pointed').toDataURL()")
    box = opened.locator(".time .plot").first.bounding_box()
    opened.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 40)
    opened.mouse.down()
    opened.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 60, steps=5)
    opened.mouse.up()
    opened.mouse.move(1, 1)
    expect(opened.locator(".readout")).to_contain_text("Marked from")
    start, end = (
        float(word) for word in re.search(r"from ([\d.]+) s to ([\d.]+) s", opened.text_content(".readout")).groups()
    )
    assert (start, end) == pytest.approx((10.5, 19), abs=1)
    assert rmse_shown(opened) == pytest.approx(rmse_of(folder, start, end), rel=0.02)
    assert opened.evaluate("document.querySelector('.loop canvas.pointed').toDataURL()") != before


def test_a_box_in_the_loop_marks_segments_of_time(opened):
    box = opened.locator(".loop .plot").bounding_box()
    opened.mouse.move(box["x"] + 0.8 * box["width"], box["y"] + 0.1 * box["height"])
    opened.mouse.down()
    opened.mouse.move(box["x"] + 0.95 * box["width"], box["y"] + 0.4 * box["height"], steps=4)
    opened.mouse.up()
    opened.mouse.move(1, 1)
    expect(opened.locator(".readout")).to_contain_text(re.compile(r"Marked \d+ segments"))


def test_the_wheel_scrolls_the_page_unless_a_plot_has_the_focus(opened):
    span = "document.querySelector('.time .plot').dataset.span"
    plot = opened.locator(".time .plot").first
    whole = opened.evaluate(span)
    opened.locator("[data-mode=mark]").focus()
    plot.hover()
    opened.mouse.wheel(0, -300)
    assert opened.evaluate(span) == whole
    plot.focus()
    plot.hover()
    opened.mouse.wheel(0, -300)
    assert opened.evaluate(span) != whole


def test_spectrum_and_frequency_response_are_in_the_file(opened):
    for view, legend in (("spectrum", "residual"), ("bode", "measured")):
        opened.select_option("[aria-label='View over time or frequency']", view)
        expect(opened.locator(".time .legend").first).to_contain_text(legend)
    opened.select_option("[aria-label='View over time or frequency']", "time")


def test_the_keyboard_reaches_the_mark(opened):
    opened.locator(".time .plot").first.focus()
    for key in ("ArrowRight", "Shift+ArrowRight", "Shift+ArrowRight"):
        opened.keyboard.press(key)
    expect(opened.locator("text=Clear mark")).to_be_enabled()
    opened.keyboard.press("Enter")
    assert float(opened.evaluate("document.querySelector('.time .plot').dataset.span").split()[1]) < 5
    opened.keyboard.press("Escape")
    expect(opened.locator(".readout")).to_contain_text("Whole record")


def test_it_prints(opened, tmp_path):
    opened.emulate_media(media="print")
    opened.evaluate("dispatchEvent(new Event('beforeprint'))")
    edges = "[...document.querySelectorAll('#explorer canvas')].map(canvas => canvas.getBoundingClientRect().right)"
    assert max(opened.evaluate(edges)) < 180 / 25.4 * 96
    assert not opened.locator(".plot .pointed").first.is_visible()  # it would cut out what is below
    order = "[...document.querySelectorAll('main > section')].map(section => section.id)"
    assert opened.evaluate(order)[:3] == ["staircase", "model", "parameters"]  # the first page
    opened.evaluate("dispatchEvent(new Event('afterprint'))")
    opened.emulate_media(media="screen")
    opened.pdf(path=tmp_path / "report.pdf", format="A4")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")
