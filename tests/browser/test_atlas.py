"""The atlas in a browser: found by a word, by keyboard, on a phone, from the disk."""

from playwright.sync_api import expect

from browser.conftest import faults_of

PHONE = {"width": 390, "height": 844}


def test_a_word_is_found_and_gone_to_by_keyboard(page, atlas_page):
    page.goto(atlas_page.as_uri())
    page.keyboard.press("/")
    page.keyboard.type("hum")
    cards = page.locator(".cards li:visible")
    expect(cards.filter(has_text="periodic_disturbance")).to_have_count(1)
    expect(page.get_by_role("status")).to_contain_text("words")
    expect(page.locator("#word-creep")).to_be_hidden()
    page.keyboard.press("Escape")
    expect(page.locator("#word-creep")).to_be_visible()
    page.keyboard.type("wave gratings of encoders nobody has")
    expect(cards).to_have_count(0)
    page.keyboard.press("Escape")
    page.keyboard.type("sub-divisional error")
    page.keyboard.press("Enter")
    expect(page.locator("#word-encoder_cyclic_error")).to_be_in_viewport()


def test_a_symptom_leads_to_its_effects(page, atlas_page):
    page.goto(atlas_page.as_uri())
    page.get_by_role("row", name="holds still").get_by_role("link", name="creep").click()
    expect(page.locator("#word-creep h3").first).to_be_in_viewport()
    page.locator("#word-creep").get_by_role("link", name="thermal_relaxation").first.click()
    expect(page.locator("#word-thermal_relaxation h3").first).to_be_in_viewport()


def test_a_phone_needs_no_sideways_scrolling(page, atlas_page):
    page.set_viewport_size(PHONE)
    page.goto(atlas_page.as_uri())
    assert page.evaluate("document.documentElement.scrollWidth") == PHONE["width"]


def test_small_pictures_are_drawn(page, atlas_page):
    page.goto(atlas_page.as_uri())
    stroke = "getComputedStyle(document.querySelector('#creep-loop-with')).stroke"
    assert page.evaluate(stroke) == "rgb(11, 87, 201)"
    for use in page.locator(".thumbnail use").all()[:6]:
        assert use.bounding_box()["width"] > 20


def test_it_is_accessible(page, atlas_page):
    """The words with pictures, forms, look-alikes and settings; the others are made of the same parts."""
    page.goto(atlas_page.as_uri())
    page.evaluate(
        "document.querySelectorAll('.word:not(#word-creep, #word-bouc_wen, #word-pso)').forEach(word => word.remove())"
    )
    assert faults_of(page) == []
