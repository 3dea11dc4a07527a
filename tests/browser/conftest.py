"""Chromium, and a workbench of its own for each test."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from queue import Queue
from threading import Thread

import pytest
import uvicorn

from pzt_ident.workbench.runner import Runner
from pzt_ident.workbench.serve import serve

PROGRAMS = ("chromium-headless-shell", "chromium", "chromium-browser")  # the first is the same without its windows
CHROMIUM = next(filter(None, map(shutil.which, PROGRAMS)), None)
AXE = Path(__file__).with_name("axe.min.js")
SECONDS = 120

if CHROMIUM is None and os.environ.get("CI"):
    raise RuntimeError("no chromium: `apt-get install chromium-headless-shell`")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_teardown(item, nextitem):
    """The tests of a file go on from each other on one page; a worker that takes over an earlier one begins anew."""
    if nextitem is not None and nextitem.path == item.path and nextitem.location[1] < item.location[1]:
        elsewhere = next((other for other in item.session.items if other.path != item.path), None)
        item.session._setupstate.teardown_exact(elsewhere)


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
        size = {"width": 1280, "height": 800}
        context = chromium.new_context(color_scheme="light", reduced_motion="reduce", viewport=size)
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


@contextmanager
def workbenches(folder: Path):
    """Starts workbenches in a folder; each start gives an address."""
    running: list[subprocess.Popen[str]] = []

    def start(*arguments: str) -> str:
        command = [sys.executable, "-m", "pzt_ident", "workbench", "--no-browser", "--out", "workbench", *arguments]
        source = str(Path(__file__).parents[2])
        environment = os.environ | {"PYTHONUNBUFFERED": "1", "PYTHONPATH": source}
        process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True, env=environment)
        running.append(process)
        assert process.stdout is not None
        return process.stdout.readline().removeprefix("workbench: ").strip()

    yield start
    for process in running:
        process.send_signal(signal.SIGINT)
        process.wait(20)


@pytest.fixture
def workbench(tmp_path):
    """As a user starts it: a process."""
    with workbenches(tmp_path) as start:
        yield start


@pytest.fixture
def workbench_here(tmp_path, monkeypatch):
    """The same in this process, without one that waits for a command: for what is seen before any."""
    running, threads = [], []

    class Server(uvicorn.Server):
        def __init__(self, config):
            super().__init__(config)
            running.append(self)

    def start(*source: str) -> str:
        arguments = [*map(Path, source)] or [None]
        threads.append(Thread(target=serve, args=(*arguments, Path("workbench"), "127.0.0.1", 0, False, said.put)))
        threads[-1].start()
        return said.get(timeout=SECONDS)

    said = Queue()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(uvicorn, "Server", Server)
    monkeypatch.setattr(Runner, "warm", lambda self: None)
    yield start
    for server in running:
        server.should_exit = True
    for thread in threads:
        thread.join(20)
        assert not thread.is_alive()


def faults_of(page) -> list[str]:
    """What axe-core finds against WCAG 2.2 AA on a page, and of its contrasts in the dark theme, too."""
    contrasts = {"runOnly": ["color-contrast", "link-in-text-block"]}
    levels = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
    every = {"runOnly": levels, "rules": {"target-size": {"enabled": True}}}
    found = []
    if page.evaluate("typeof axe") == "undefined":
        page.evaluate(AXE.read_text(encoding="utf-8"))
    for scheme, options, least in (("dark", contrasts, 0), ("light", every, 15)):
        page.emulate_media(color_scheme=scheme)
        result = page.evaluate("options => axe.run(document, options)", options)
        assert len(result["passes"]) > least
        found += [f"{scheme}: {item['id']}: {node['html']}" for item in result["violations"] for node in item["nodes"]]
    return found
