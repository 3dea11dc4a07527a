"""Take the pictures of README: the report of the demo, and the workbench while and after it finds what is missing.

python -m experiments.demo.pictures
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import Page, expect, sync_playwright

FOLDER = Path(__file__).parents[2] / "results" / "reference" / "picture"
COMMAND = [sys.executable, "-m", "pzt_ident"]
SECONDS = 120


def report(page: Page, folder: Path) -> None:
    """The page that `pzt-ident demo` opens, with a stretch marked."""
    subprocess.run([*COMMAND, "demo", "--out", str(folder), "--no-browser", "--quiet"], check=True)
    page.goto((folder / "improved" / "report.html").as_uri())
    page.click("[data-mode=mark]")
    box = page.locator("#explorer .time .plot").first.bounding_box()
    assert box
    page.mouse.move(box["x"] + 0.45 * box["width"], box["y"] + 50)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.67 * box["width"], box["y"] + 60, steps=4)
    page.mouse.up()
    page.mouse.move(0, 0)
    expect(page.locator(".readout")).to_contain_text("Marked")
    bottom = page.locator("#residuals").bounding_box()
    assert bottom
    page.screenshot(path=FOLDER / "report.png", clip={"x": 0, "y": 0, "width": 1280, "height": bottom["y"]})


def workbench(page: Page, folder: Path) -> None:
    """The demo's job in the workbench: what is missing is said, added, and the error falls."""
    command = [*COMMAND, "workbench", "job.yaml", "--no-browser"]
    server = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None
        page.set_viewport_size({"width": 1280, "height": 800})
        page.goto(server.stdout.readline().removeprefix("workbench: ").strip())
        page.click("#action")
        for missing in ("quadratic_gain", "creep"):
            page.click(f"#action:text('Add {missing}')")
        expect(page.locator("#verdict")).to_contain_text("adequate")
        expect(page.locator("body.busy")).to_have_count(0)
        page.wait_for_timeout(500)
        page.screenshot(path=FOLDER / "workbench.png")
    finally:
        server.terminate()
        server.wait()


def main() -> None:
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as scratch:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1280, "height": 2400}, color_scheme="light")
        page.set_default_timeout(1000 * SECONDS)
        expect.set_options(timeout=1000 * SECONDS)
        report(page, Path(scratch) / "demo")
        workbench(page, Path(scratch) / "demo")
        browser.close()


if __name__ == "__main__":
    main()
