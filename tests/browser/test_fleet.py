"""A lot in the workbench: begun by mouse, watched as it goes on, sorted, and a device opened like a run."""

import shutil

import pytest
from playwright.sync_api import expect

from browser.conftest import faults_of, workbenches
from experiments.fleet.lot import write_lot

DEVICES = 6
ALL_IN_BARS = """(devices) => {
  const bars = [...document.querySelectorAll("[aria-label='Devices by bouc_wen.gain'] [data-below]")];
  return bars.reduce((sum, { dataset }) => sum + Number(dataset.count), 0) === devices;
}"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("lot")
    write_lot(made, DEVICES, 3, broken=1 / DEVICES, samples=300, swarm=(12, 15))
    return made


@pytest.fixture(scope="module")
def lot(browsing, folder):
    """The page of the lot, begun from the job of one device."""
    job = folder / "one.yaml"
    text = (folder / "job.yaml").read_text(encoding="utf-8")
    job.write_text(text.replace("file: ", "file: lot/d00000/"), encoding="utf-8")
    with workbenches(folder) as start, browsing() as page:
        page.goto(start("one.yaml"))
        page.click("#tab-devices")
        expect(page.locator("#sheet-devices")).to_contain_text("loops.csv, tones.csv")
        page.click("#identify-lot")
        expect(page.locator("#table-devices tbody tr")).to_have_count(DEVICES - 1)
        expect(page.locator("#live progress")).to_be_hidden()
        page.wait_for_function(ALL_IN_BARS, arg=DEVICES - 1, timeout=120_000)  # drawn after the table
        yield page


def test_its_table_is_sorted_and_filtered(lot):
    heading = lot.locator("#table-devices th", has_text="bouc_wen.gain")
    heading.locator("button").click()
    gains = [float(cell.get_attribute("data-value")) for cell in lot.locator("#table-devices td:nth-child(3)").all()]
    assert gains == sorted(gains)
    expect(heading).to_have_attribute("aria-sort", "ascending")
    lot.fill("#filter", "d00000")
    expect(lot.locator("#table-devices tbody tr:visible")).to_have_count(1)
    lot.fill("#filter", "")


def test_what_is_said_of_it_is_beside_it_and_leads_to_the_atlas(lot):
    expect(lot.locator("#broken")).to_contain_text("the file is empty")
    expect(lot.locator("#spreads svg").first).to_be_visible()  # drawn after the table
    expect(lot.locator("#spreads a").first).to_have_attribute("href", "/atlas#word-bouc_wen")
    assert faults_of(lot) == []
    for width in (1280, 820, 390):
        lot.set_viewport_size({"width": width, "height": 800})
        assert lot.evaluate("document.documentElement.scrollWidth") <= width
    lot.set_viewport_size({"width": 1280, "height": 800})
    with lot.expect_download() as download:
        lot.click("[data-file='devices.csv']")
    assert len(download.value.path().read_text(encoding="utf-8").splitlines()) == DEVICES + 1


def test_a_bar_shows_its_devices_in_the_table_by_key(lot):
    panel = lot.locator("[aria-label='Devices by bouc_wen.gain']")
    bar, first = (panel.locator(f"[data-below]{which}").first for which in (":not([data-count='1'])", ""))
    expect(first).to_have_attribute("tabindex", "0")
    first.focus()
    while lot.evaluate("document.activeElement.dataset.count") == "1":
        lot.keyboard.press("ArrowRight")
    said = lot.locator("#pointed").text_content()
    assert said == bar.get_attribute("aria-label")
    lot.keyboard.press("Enter")
    rows = lot.locator("#table-devices tbody tr:visible")
    expect(rows).to_have_count(int(bar.get_attribute("data-count")))
    assert all(name in said for name in rows.locator("a").all_text_contents())
    expect(bar).to_have_attribute("aria-pressed", "true")
    assert faults_of(lot) == []
    expect(lot.locator("#chosen")).to_be_focused()
    lot.keyboard.press("Enter")
    expect(rows).to_have_count(DEVICES - 1)
    expect(bar).to_be_focused()


def test_a_bar_that_is_drawn_with_other_ends_stays_chosen(lot):
    """As where a device more moves the ends of all bars."""
    bar = lot.locator("[aria-label='Devices by bouc_wen.gain'] [data-below]:not([data-count='1'])").first
    bar.focus()
    lot.keyboard.press("Enter")
    expect(lot.locator("#chosen")).to_be_focused()
    lot.evaluate("""() => {
      for (const bar of document.querySelectorAll("[data-below]"))
        for (const end of ["low", "below"]) bar.dataset[end] *= 1 - 1e-6;
      document.dispatchEvent(new Event("redrawn"));
    }""")
    expect(bar).to_have_attribute("aria-pressed", "true")
    lot.keyboard.press("Enter")
    expect(bar).to_be_focused()


def test_a_fleet_that_is_not_done_is_followed_and_goes_on(lot, folder):
    name = lot.locator("#table-devices a[data-device]").last.text_content()
    bar = lot.locator(f"[data-below]:not([aria-label*='{name}'])").first
    said = bar.get_attribute("aria-label")
    bar.focus()
    shutil.rmtree(folder / "workbench" / "fleet" / "devices" / name)
    expect(lot.locator("#counts")).to_have_text(f"{DEVICES - 2} of {DEVICES} devices done, 1 broken")
    expect(lot.locator("#live progress")).to_be_visible()
    expect(lot.locator("#table-devices tbody tr")).to_have_count(DEVICES - 2)
    assert lot.evaluate("document.activeElement.getAttribute('aria-label')") == said  # drawn again since
    lot.click("#go-on")
    expect(lot.locator("#table-devices tbody tr")).to_have_count(DEVICES - 1)
    expect(lot.locator("#live progress")).to_be_hidden()
    expect(lot.locator("#error")).to_be_hidden()


def test_a_device_opens_like_a_run_and_leads_back(lot):
    bar = lot.locator("[data-count='1']").first
    name = bar.get_attribute("aria-label").rpartition(": ")[2]
    bar.click()
    expect(lot.locator("#name")).to_have_text(name)
    expect(lot.locator("#loop canvas.drawn")).to_be_visible()
    expect(lot.locator("#verdict")).to_contain_text("The model is fitted: it leaves an RMSE of")
    expect(lot.locator("#action")).to_have_text("Diagnose")
    expect(lot.locator(".parameter input[type=range]").first).to_be_enabled()
    lot.click("#lot")
    expect(lot.locator("#table-devices tbody tr")).to_have_count(DEVICES - 1)


def test_a_long_cell_leaves_room_for_the_reason_beside_it(lot):
    lot.set_viewport_size({"width": 1280, "height": 800})
    width = lot.evaluate("""() => {
      const cell = (kind, text) => `<td class="${kind}">${text}</td>`, long = "misses creep and ".repeat(5);
      const row = cell("word", "d00000") + cell("word what", long) + cell("word note", long);
      document.querySelector("#told").insertAdjacentHTML("afterbegin", `<table id="long"><tr>${row}</tr></table>`);
      const { offsetWidth } = document.querySelector("#long .note");
      document.querySelector("#long").remove();
      return offsetWidth;
    }""")
    assert width >= 220
