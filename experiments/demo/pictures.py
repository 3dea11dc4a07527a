"""Take the pictures of README: the report of the demo, and the workbench while and after it finds what is missing.

python -m experiments.demo.pictures
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from playwright.sync_api import Page, expect, sync_playwright

FOLDER = Path(__file__).parents[2] / "results" / "reference" / "picture"
COMMAND = [sys.executable, "-m", "pzt_ident"]
SECONDS = 120


def report(page: Page, folder: Path) -> None:
    """The page that `pzt-ident demo` opens, with a stretch marked."""
    subprocess.run([*COMMAND, "demo", "--out", str(folder), "--no-browser", "--quiet"], check=True)
    page.goto((folder / "improved" / "report.html").as_uri())
    fields = page.locator(".bar input")
    fields.nth(0).fill("4.8")
    fields.nth(1).fill("7.4")
    fields.nth(1).press("Enter")
    expect(page.locator(".readout")).to_contain_text("Marked")
    page.mouse.move(0, 0)
    page.screenshot(path=FOLDER / "report.png", clip=clip(page, "h1", "#residuals"))


def workbench(page: Page, folder: Path) -> None:
    """The demo's job in the workbench: what is missing is said, added, and the error falls."""
    command = [*COMMAND, "workbench", "job.yaml", "--no-browser"]
    server = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None
        page.goto(server.stdout.readline().removeprefix("workbench: ").strip())
        page.click("#run")
        for missing in ("quadratic_gain", "creep"):
            page.click(f"#advice button[data-effect={missing}]")
        expect(page.locator("#verdict")).to_contain_text("adequate")
        page.wait_for_timeout(500)
        page.screenshot(path=FOLDER / "workbench.png", clip=clip(page, "h1", "#where-it-fails"))
    finally:
        server.terminate()
        server.wait()


def clip(page: Page, first: str, last: str) -> Any:
    """From one element to where another begins."""
    page.evaluate("scrollTo(0, 0)")
    top, bottom = (page.locator(name).first.bounding_box() for name in (first, last))
    assert top and bottom
    return {"x": 0, "y": 0, "width": 1280, "height": bottom["y"]}


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
