"""The workbench as an instrument: one fitted demo, looked at, touched and asked for everything, by mouse and keys."""

import csv
import itertools
import json
import math
import re
from contextlib import contextmanager
from importlib.resources import files

import pytest
from playwright.sync_api import expect

from browser.conftest import faults_of, workbenches
from pzt_ident.model.registry import blocks

SAMPLE = files("pzt_ident.job").joinpath("examples", "demo")
JOB = """\
name: demo
records: [{file: identify.csv, use: identify}, {file: validate.csv, use: validate}]
channels:
  time: "time [s]"
  axes: {x: {drive: "u_x [V]", response: "x [um]"}}
model: [bouc_wen]
optimizers:
  - {name: pso, population: 20, generations: 30}
rule_out: [RULED_OUT]
"""
CANDIDATES = ("creep", "quadratic_gain", "saturation", "sensor_lag")
JOB = JOB.replace("RULED_OUT", ", ".join(word for word in blocks.effects() if word not in CANDIDATES))
SHEETS = ("parameters", "misfit", "candidates", "steps", "optimizers", "control", "devices", "commands")
INK = "place => document.querySelectorAll('.plot canvas.moving')[place].toDataURL()"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("instrument")
    for name in ("identify.csv", "validate.csv"):
        header, *rows = SAMPLE.joinpath(name).read_text(encoding="utf-8").splitlines()
        (made / name).write_text("\n".join([header, *rows[::4]]) + "\n", encoding="utf-8")
    (made / "job.yaml").write_text(JOB, encoding="utf-8")
    return made


@pytest.fixture(scope="module")
def fitted(browsing, folder):
    with workbenches(folder) as start, browsing() as page:
        page.goto(start("job.yaml"))
        page.click("#action")
        expect(page.locator("#action")).to_have_text("Add quadratic_gain")
        expect(page.locator("body.busy")).to_have_count(0)
        yield page


@pytest.fixture
def shown(fitted):
    """The page as it opens: nothing zoomed, marked or moved."""
    fitted.click("text=Show all")
    fitted.click("#tab-parameters")
    return fitted


def state_of(folder):
    return json.loads((folder / "workbench" / "state.json").read_text())


def span(page):
    """Where the time axis begins and ends."""
    return page.evaluate("document.querySelector('#time .plot').dataset.span.split(' ').map(Number)")


def middle(page, selector):
    box = page.locator(selector).first.bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.mark.parametrize("size", [(1280, 800), (1920, 1080), (1024, 768)])
def test_all_is_on_one_screen(shown, size):
    shown.set_viewport_size({"width": size[0], "height": size[1]})
    root = shown.evaluate("[document.documentElement.scrollWidth, document.documentElement.scrollHeight]")
    assert tuple(root) <= size and root[1] <= size[1]
    for part in ("#loop .plot", "#time .plot >> nth=1", ".stairs svg", "#panel", "#action", "#blocks", "#tab-commands"):
        box = shown.locator(part).first.bounding_box()
        assert box["height"] > 20 and box["y"] + box["height"] <= size[1] and box["x"] + box["width"] <= size[0]
    shown.set_viewport_size({"width": 1280, "height": 800})


LARGE = """selector => [...document.querySelectorAll(selector)].every((item) => {
  const box = item.getBoundingClientRect();
  return Math.min(box.width, box.height) >= 24;
})"""
"""Whether all have the size that a finger needs, px."""


@contextmanager
def state_with(page, change):
    """The page with a state that is changed on its way to it."""

    def changed(route):
        answer = route.fetch()
        state = answer.json()
        change(state)
        route.fulfill(json=state)

    page.route("**/api/state", changed)
    page.reload()
    try:
        yield
    finally:
        page.unroute_all(behavior="ignoreErrors")  # a question may be on its way
        page.reload()
        expect(page.locator("#loop canvas.drawn")).to_be_visible()


def test_a_command_that_is_being_started_can_be_stopped(shown):
    starting = {"running": True, "busy": True, "stage": "", "since": 0.0}
    with state_with(shown, lambda state: state.update(starting)):
        expect(shown.locator("#stop")).to_be_visible()
    expect(shown.locator("#stop")).to_be_hidden()


CUT = """() => [...document.querySelectorAll("header p, .readout, .legend, #sheets *, #blocks *")].filter((item) => {
  const { overflowX, overflowY } = getComputedStyle(item);
  const wide = overflowX !== "visible" && item.scrollWidth > item.clientWidth + 1;
  return wide || (overflowY !== "visible" && !item.matches("pre") && item.scrollHeight > item.clientHeight + 1);
}).map((item) => item.outerHTML)"""
PARTED = """() => {
  const walker = document.createTreeWalker(document.querySelector("#sheets"), NodeFilter.SHOW_TEXT), found = [];
  const place = (node, i) => {
    const range = document.createRange();
    range.setStart(node, i); range.setEnd(node, i + 1);
    return range.getBoundingClientRect().top;
  };
  while (walker.nextNode()) {
    const node = walker.currentNode, text = node.data;
    if (!node.parentElement.closest("pre, option, select"))
      for (let i = 1; i < text.length; i++)
        if (/\\w\\w/.test(text.slice(i - 1, i + 1)) && place(node, i) - place(node, i - 1) > 8) found.push(text);
  }
  return found;
}"""
NAMES = """() => [...document.querySelectorAll(".stairs text.name")].map((item) => {
  const { left, right } = item.getBoundingClientRect(), turned = item.getAttribute("transform") ?? "rotate(0)";
  const angle = (Math.abs(parseFloat(turned.slice(7))) * Math.PI) / 180;
  return { text: item.textContent, x: Number(item.getAttribute("x")), left, right, angle, size: 11 };
})"""
VALUES = "[...document.querySelectorAll('.stairs text.value')].map((item) => item.getBoundingClientRect().toJSON())"
TICKS = """[...document.querySelectorAll('.stairs text.end')].map((item) =>
  item.getBoundingClientRect().left - item.closest("svg").getBoundingClientRect().left)"""
CHANGES = ["+ distributed_memory.even_terms", "+ distributed_memory.odd_terms", "+ friction", "+ rate_dependence"]


@pytest.mark.parametrize("width", [1280, 1920])
@pytest.mark.parametrize("count", [3, 9])
def test_nothing_is_cut_parted_or_written_over_however_long_it_is(shown, width, count):
    def lengthen(state):
        state["headline"]["verdict"] = " ".join(["Effects of the catalogue would explain what is left of it."] * 4)
        (first,) = state["steps"]
        first |= {"identify": 4e-7, "validate": 5e-7}  # m
        for facts in filter(None, (state["result"], state["diagnosis"])):
            facts |= {"floor": 2e-8}
        more = [
            {"number": n, "change": CHANGES[n % 4], "identify": 0.9**n * first["identify"]} for n in range(2, count)
        ]
        state["steps"] += [first | item for item in more]
        for parameter in state["parameters"]:
            parameter |= {"name": "distributed_memory.weight_1", "value": -0.00096705}

    shown.set_viewport_size({"width": width, "height": 800})
    with state_with(shown, lengthen):
        expect(shown.locator(".stairs text.name")).to_have_count(count - 1)
        expect(shown.locator("#loop canvas.drawn")).to_be_visible()
        assert shown.evaluate(CUT) == [] and shown.evaluate(PARTED) == []
        names, values = shown.evaluate(NAMES), shown.evaluate(VALUES)
        assert min(shown.evaluate(TICKS)) >= 0  # of powers of ten too
    shown.set_viewport_size({"width": 1280, "height": 800})
    assert len({name["text"] for name in names}) == min(count - 1, 5)
    for one, other in itertools.pairwise(names):
        apart = (other["x"] - one["x"]) * math.sin(one["angle"]) >= one["size"]
        assert apart or one["right"] <= other["left"]
    for one, other in itertools.combinations(values, 2):
        beside = one["right"] <= other["left"] or other["right"] <= one["left"]
        assert beside or abs(one["top"] - other["top"]) > 9


@pytest.mark.parametrize("sheet", SHEETS)
def test_each_sheet_is_accessible(shown, sheet):
    shown.click(f"#tab-{sheet}")
    assert faults_of(shown) == []


def test_targets_are_large_enough_to_touch(shown):
    for target in shown.locator(":is(a, button, select, input, summary):visible").all():
        box = target.bounding_box()
        assert min(box["width"], box["height"]) >= 23.9, target.evaluate("item => item.outerHTML")


def test_the_tabs_go_by_the_arrow_keys(shown):
    shown.focus("#tab-parameters")
    shown.keyboard.press("ArrowRight")
    expect(shown.locator("#sheet-misfit")).to_be_visible()
    expect(shown.locator("#tab-misfit")).to_be_focused()
    shown.locator("#sheet-misfit button").first.click()
    expect(shown.locator(".readout")).to_contain_text("Marked from")
    shown.click("text=Clear mark")


def test_every_part_is_reached_by_the_tabulator(shown):
    wanted = ["#action", "#improve", "#undo", "#report", "#blocks a", "#more select", "#loop .plot", "#time .plot"]
    wanted += ["#tab-parameters", "#sheets input[type=range]", "#sheets a"]
    for _ in range(90):
        shown.keyboard.press("Tab")
        wanted = [part for part in wanted if not shown.evaluate("part => document.activeElement.matches(part)", part)]
    assert wanted == []


def test_wheel_drag_and_double_click_in_time(shown):
    whole = span(shown)
    shown.mouse.move(*middle(shown, "#time .plot"))
    shown.mouse.wheel(0, -400)
    zoomed = span(shown)
    assert whole[0] < zoomed[0] < zoomed[1] < whole[1]
    x, y = middle(shown, "#time .plot")
    shown.mouse.down()
    shown.mouse.move(x + 80, y, steps=3)
    shown.mouse.up()
    assert span(shown)[0] < zoomed[0]
    shown.mouse.dblclick(x, y)
    assert span(shown) == whole


def test_the_loop_zooms_by_wheel_and_keys(shown):
    before = shown.evaluate(INK, 0)
    shown.mouse.move(*middle(shown, "#loop .plot"))
    shown.mouse.wheel(0, -300)
    near = shown.evaluate(INK, 0)
    assert near != before
    shown.focus("#loop .plot")
    shown.keyboard.press("-")
    shown.keyboard.press("0")
    assert shown.evaluate(INK, 0) == before


def test_the_cursor_reads_all_plots(shown):
    shown.mouse.move(*middle(shown, "#time .plot"))
    expect(shown.locator("#loop .legend .value").first).to_contain_text("µm")
    expect(shown.locator(".readout")).to_contain_text(re.compile(r"s, drive [\d.]+ V"))
    shown.mouse.move(5, 5)
    shown.focus("#time .plot")
    shown.keyboard.press("ArrowRight")
    first = shown.text_content(".readout")
    shown.keyboard.press("ArrowRight")
    assert shown.text_content(".readout") != first
    shown.keyboard.press("Escape")


def test_colours_and_the_views_over_frequency(shown):
    shown.select_option("[aria-label='Colour of the loop']", "rate")
    expect(shown.locator("#loop .legend")).to_contain_text("V/s")
    shown.select_option("[aria-label='View over time or frequency']", "spectrum")
    expect(shown.locator("#time .legend").first).to_have_text("residual")
    shown.select_option("[aria-label='View over time or frequency']", "bode")
    expect(shown.locator("#time .legend").first).to_contain_text("measured")
    shown.select_option("[aria-label='View over time or frequency']", "time")
    shown.select_option("[aria-label='Colour of the loop']", "")


def test_a_slider_moves_the_model_and_reset_brings_it_back(shown):
    before, ink = shown.text_content("#sheet-parameters [role=status]"), shown.evaluate(INK, 1)
    shown.locator(".parameter input[type=range]").first.focus()
    shown.keyboard.press("PageUp")
    expect(shown.locator("#time .legend").first).to_contain_text("with these values")
    expect(shown.locator("#sheet-parameters [role=status]")).not_to_have_text(before)
    shown.get_by_text("Reset").press("Enter")
    expect(shown.locator(".parameter input[type=range]").first).to_be_focused()
    expect(shown.locator("#time .legend").first).not_to_contain_text("with these values")
    expect(shown.locator("#sheet-parameters [role=status]")).to_have_text(before)
    assert shown.evaluate(INK, 1) == ink


def test_a_proposed_effect_is_shown_before_it_is_added(shown, folder):
    shown.click("#tab-candidates")
    card = shown.locator(".card", has_text="quadratic_gain").first
    card.locator("summary").click()
    card.locator("input[type=range]").focus()
    shown.keyboard.press("PageUp")
    expect(card.locator("[role=status]")).to_contain_text("RMSE")
    expect(shown.locator("#time .legend").first).to_contain_text("with these values")
    card.locator("summary").click()
    expect(shown.locator("#time .legend").first).not_to_contain_text("with these values")
    assert len(state_of(folder)["steps"]) == 1


UNLINKED = """() => {
  const words = new Set(WORDS), found = [];
  for (const node of document.querySelectorAll("#verdict, #next, #blocks li, #sheets :is(p, li, td, dd, h3, strong)")) {
    const links = [...(node.closest(".card") ?? node).querySelectorAll("a[href*='#word-']")];
    const linked = links.map(({ hash }) => hash.slice(6).split(".")[0]);
    const missed = node.textContent.split(/[^\\w]+/).filter((word) => words.has(word) && !linked.includes(word));
    found.push(...missed.map((word) => `${word}: ${node.textContent}`));
  }
  return found;
}"""


def test_no_word_is_without_its_link_to_the_atlas(shown):
    shown.click("#tab-steps")
    assert shown.evaluate(UNLINKED.replace("WORDS", str(blocks.words()))) == []
    shown.click("#more summary")
    for link in shown.locator(".palette a").all():
        assert link.get_attribute("href").startswith("/atlas#word-")
    assert shown.locator(".palette a").count() == shown.locator(".palette button").count() > 8
    shown.keyboard.press("Escape")
    shown.select_option("[aria-label='Effect to add']", "friction")
    expect(shown.get_by_role("link", name="About friction")).to_have_attribute("href", "/atlas#word-friction")


def test_a_form_and_the_name_of_a_step_lead_to_their_sections(shown):
    def change(state):
        (first,) = state["steps"]
        names = ["+ friction.coulomb", "search by pso"]
        state["steps"] += [first | {"number": n, "change": name} for n, name in enumerate(names, 2)]
        state["headline"]["verdict"] = "Missing: friction (coulomb). Beside it friction (fitted) and creep (voltage)."

    with state_with(shown, change):
        links = shown.locator("#verdict a")
        expect(links).to_have_text(["friction (coulomb)", "friction", "creep (voltage)"])
        words = [link.get_attribute("href").removeprefix("/atlas#word-") for link in links.all()]
        assert words == ["friction.coulomb", "friction", "creep.voltage"]
        steps = shown.locator(".stairs a")
        expect(steps).to_have_count(2)
        hrefs = [link.get_attribute("href") for link in steps.all()]
        assert hrefs == ["/atlas#word-friction.coulomb", "/atlas#word-pso"]
        shown.wait_for_function(LARGE, arg=".stairs a")  # once drawn: it is drawn again as the page takes its size
        assert faults_of(shown) == []


def test_each_word_leads_to_its_section_of_the_atlas(shown):
    shown.focus("#blocks a")
    with shown.context.expect_page() as opened:
        shown.keyboard.press("Enter")
    atlas = opened.value
    expect(atlas.get_by_role("status")).to_contain_text("being drawn")
    expect(atlas.locator("#word-bouc_wen h3")).to_be_in_viewport()
    atlas.close()
    for sheet, word in (("parameters", "bouc_wen"), ("misfit", "quadratic_gain"), ("candidates", "creep")):
        shown.click(f"#tab-{sheet}")
        with shown.context.expect_page() as opened:
            shown.locator(f"#sheet-{sheet} a", has_text=word).first.click()
        expect(opened.value.locator(f"#word-{word} h3")).to_be_in_viewport()
        opened.value.close()


def test_choosing_an_effect_by_key_starts_nothing(shown, folder):
    shown.focus("[aria-label='Effect to add']")
    shown.keyboard.press("ArrowDown")
    shown.wait_for_timeout(400)
    expect(shown.locator("body.busy")).to_have_count(0)
    assert len(state_of(folder)["steps"]) == 1
    shown.select_option("[aria-label='Effect to add']", "")


def test_a_note_stays_with_its_step(shown):
    shown.click("#tab-steps")
    shown.fill("[aria-label='Note to step 1']", "cold stage")
    shown.keyboard.press("Tab")
    expect(shown.locator(".stairs .note")).to_have_text("cold stage")
    shown.reload()
    expect(shown.locator(".stairs .note")).to_have_text("cold stage")


def test_a_reference_is_followed(shown, folder):
    rows = [f"{i / 100},{4 + (3 * min(i, 400 - i)) / 200}" for i in range(400)]
    (folder / "ramp.csv").write_text("\n".join(["time [s],x [um]", *rows]) + "\n", encoding="utf-8")
    shown.click("#tab-control")
    shown.set_input_files("#sheet-control input[type=file]", folder / "ramp.csv")
    expect(shown.locator("#sheet-control [role=status]")).to_contain_text("400 samples")
    expect(shown.get_by_label("to, in V", exact=True)).to_be_visible()
    shown.click("#follow")
    expect(shown.locator("#ways tbody tr")).to_have_count(3)
    expect(shown.locator("body.busy")).to_have_count(0)
    with shown.expect_download() as download:
        shown.click("#take-drive")
    with open(download.value.path(), encoding="utf-8") as drive:
        assert len(list(csv.reader(drive))) > 400


def test_the_model_and_the_figures_are_given_away(shown):
    shown.click("#tab-commands")
    for button in ("[data-export=csv]", ".downloads button:text-is('tables.zip')"):
        with shown.expect_download() as download:
            shown.click(button)
        assert download.value.path().stat().st_size > 300


def test_a_double_click_on_add_adds_once_and_two_steps_are_compared(shown, folder):
    shown.locator("#action").dblclick()
    expect(shown.locator("#action")).to_have_attribute("aria-disabled", "true")
    expect(shown.locator(".stairs .mark.identify:not(.live)")).to_have_count(2)
    expect(shown.locator("body.busy")).to_have_count(0)
    assert [step["change"] for step in state_of(folder)["steps"]] == ["as given", "+ quadratic_gain"]
    shown.reload()
    expect(shown.locator("#blocks li.effect")).to_have_text("quadratic_gain×")
    shown.click("#tab-steps")
    expect(shown.locator("#step-2")).to_contain_text("Expected before")
    for step in (1, 2):
        shown.check(f"[aria-label='Compare step {step}']")
    shown.click("text=Compare two steps")
    expect(shown.locator("#time .legend").first).to_contain_text("step 1")


def test_it_is_improved_by_mouse_and_the_staircase_falls(shown, folder):
    shown.click("#improve")
    expect(shown.locator("#stop")).to_be_visible()
    expect(shown.locator(".stairs .mark.identify.live").first).to_be_visible()  # grows while it runs
    expect(shown.locator("body.busy")).to_have_count(0)
    steps = [step["change"] for step in state_of(folder)["steps"]]
    added = {change.partition(" (")[0] for change in steps}  # without the form
    assert steps[0] == "as given" and {"+ quadratic_gain", "+ creep"} < added
    expect(shown.locator(".stairs .mark.identify:not(.live)")).to_have_count(len(steps))


def test_both_bounds_are_taken_at_once(shown, folder):
    before, (lower, upper) = (
        state_of(folder),
        [shown.get_by_label(re.compile(f"bouc_wen.beta, {side} bound")) for side in ("lower", "upper")],
    )
    lower.fill("0.001")
    lower.press("Tab")
    upper.fill("0.4")
    assert state_of(folder)["steps"] == before["steps"]  # nothing is fitted in between
    upper.press("Enter")
    expect(shown.locator("#stop")).to_be_visible()
    expect(shown.locator("body.busy")).to_have_count(0)
    added = state_of(folder)["steps"][len(before["steps"]) :]
    assert [step["change"] for step in added] == ["bouc_wen.beta in 0.001000 to 0.4000"]
    expect(shown.locator("#error")).to_be_hidden()


@pytest.mark.parametrize("typed", ["", "abc", "1e400"])
def test_a_bound_that_is_no_number_changes_nothing(shown, folder, typed):
    field = shown.get_by_label(re.compile("bouc_wen.alpha, lower bound"))
    before, steps = field.input_value(), state_of(folder)["steps"]
    field.fill(typed)
    field.press("Tab")
    expect(field).to_have_value(before)
    assert shown.locator("body.busy").count() == 0 and state_of(folder)["steps"] == steps
