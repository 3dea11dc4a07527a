"""Chromium, and a workbench of its own for each test."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
SECONDS = 180

if CHROMIUM is None and os.environ.get("CI"):
    raise RuntimeError("no chromium: `apt-get install chromium`")


@pytest.fixture(scope="session")
def chromium():
    if CHROMIUM is None:
        pytest.skip("no chromium")
    from playwright.sync_api import expect, sync_playwright

    expect.set_options(timeout=1000 * SECONDS)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def browsing(chromium):
    """Opens a page that fails the test with any error on its console and any request to another place."""

    @contextmanager
    def browse():
        context = chromium.new_context(color_scheme="light", viewport={"width": 1280, "height": 900})
        page, faults = context.new_page(), []
        page.set_default_timeout(1000 * SECONDS)
        page.on("console", lambda said: faults.append(said.text) if said.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("request", lambda asked: faults.append(asked.url) if outside(asked.url) else None)
        yield page
        context.close()
        assert faults == []

    return browse


@pytest.fixture
def page(browsing):
    with browsing() as page:
        yield page


def outside(url: str) -> bool:
    return not url.startswith(("file:///", "data:", "blob:", "http://127.0.0.1:"))


@pytest.fixture
def workbench(tmp_path):
    """Start a workbench in a folder; gives its address."""
    running: list[subprocess.Popen[str]] = []

    def start(*arguments: str) -> str:
        command = [sys.executable, "-m", "pzt_ident", "workbench", "--no-browser", "--out", "workbench", *arguments]
        source = str(Path(__file__).parents[2])
        environment = os.environ | {"PYTHONUNBUFFERED": "1", "PYTHONPATH": source}
        process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True, env=environment)
        running.append(process)
        assert process.stdout is not None
        return process.stdout.readline().removeprefix("workbench: ").strip()

    yield start
    for process in running:
        process.send_signal(signal.SIGINT)
        process.wait(20)
