"""How fast the workbench is: from the drop to the loop, from a click to the first curve, to the fallen error and to the
next verdict, and while a slider is dragged. On Linux.

python -m experiments.demo.pace 60000
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import Browser, Page, sync_playwright

from experiments.simulate import simulate

SPAN, NOISE, SECONDS = 40.0, 0.005, 300  # s, um, s
CHAIN = ("quadratic_gain", "bouc_wen", "creep")
STAGE = {
    "quadratic_gain.curvature": 3e-4,
    "bouc_wen.gain": 0.082,
    "bouc_wen.alpha": 0.55,
    "bouc_wen.beta": 0.015,
    "bouc_wen.gamma": 0.005,
    "creep.ratio": 0.08,
    "creep.tau": 1.0,
    "creep.decades": 4.0,
}
TURNS = {"identify": (0, 120, 20, 100, 10, 80, 40, 120, 0, 60, 0), "validate": (0, 90, 30, 110, 0, 70, 20, 120, 50, 0)}
DROP = """async ([names, texts]) => {
  const begun = performance.now(), transfer = new DataTransfer();
  names.forEach((name, place) => transfer.items.add(new File([texts[place]], name)));
  dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true }));
  while (!document.querySelector("#loop .legend li")) await new Promise(requestAnimationFrame);
  return performance.now() - begun;
}"""
DRAG = """async (milliseconds) => {
  const range = document.querySelector(".parameter input[type=range]"), begun = performance.now();
  const start = Number(range.value);
  let frames = 0;
  const seen = new MutationObserver(() => { frames += 1; });
  seen.observe(document.querySelector("#sheet-parameters [role=status]"), { childList: true });
  for (let t = 0; t < milliseconds; t = performance.now() - begun) {
    range.value = start + 200 * Math.sin(t / 300);
    range.dispatchEvent(new Event("input", { bubbles: true }));
    await new Promise(requestAnimationFrame);
  }
  seen.disconnect();
  return frames;
}"""


def measurement(samples: int) -> dict[str, str]:
    """Two records of a stage with a quadratic gain and creep, as CSV; two thirds of the samples to identify."""
    rng, dt, texts = np.random.default_rng(1), SPAN / samples, {}
    for (name, turns), share in zip(TURNS.items(), (2, 1), strict=True):
        count = samples * share // 3
        phase = np.linspace(0, len(turns) - 1, count)
        eased = np.floor(phase) + (1 - np.cos(np.pi * (phase % 1))) / 2
        drive = np.interp(eased, range(len(turns)), turns)
        response = simulate(CHAIN, STAGE, drive, dt) + rng.normal(0, NOISE, count)
        rows = zip(dt * np.arange(count), drive, response, strict=True)
        lines = [f"{t:.9g},{u:.9g},{x:.9g}" for t, u, x in rows]
        texts[f"{name}.csv"] = "\n".join(["time [s],u_x [V],x [um]", *lines]) + "\n"
    return texts


def until(page: Page, condition: str) -> None:
    end = time.monotonic() + SECONDS
    while not page.evaluate(condition):
        if time.monotonic() > end:
            raise SystemExit(f"not within {SECONDS} s: {condition}")
        time.sleep(0.02)


def tell(what: str, act: Callable[[], Any], condition: str, page: Page) -> None:
    begun = time.monotonic()
    act()
    until(page, condition)
    print(f"{what}: {time.monotonic() - begun:.2f} s (load {os.getloadavg()[0]:.0f})")


def cpu_of(process: int) -> float:
    """CPU time of a process, s."""
    user, system = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


def browser_cpu(browser: Browser) -> float:
    """CPU time of the browser with all its processes, s."""
    found = browser.new_browser_cdp_session().send("SystemInfo.getProcessInfo")
    return float(sum(process["cpuTime"] for process in found["processInfo"]))


def drag(browser: Browser, page: Page, server: int, seconds: float = 6.0) -> None:
    before = cpu_of(server), browser_cpu(browser)
    frames = page.evaluate(DRAG, 1000 * seconds)
    ours, pages = cpu_of(server) - before[0], browser_cpu(browser) - before[1]
    costs = f"{1000 * ours / frames:.0f} ms of CPU in the workbench and {1000 * pages / frames:.0f} ms in the browser"
    print(f"dragged slider: {frames / seconds:.0f} models a second, each {costs} (load {os.getloadavg()[0]:.0f})")


def story(browser: Browser, address: str, server: int, texts: dict[str, str]) -> None:
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.goto(address)
    page.wait_for_timeout(10_000)  # until a process waits, as it does for someone who looks for a file
    taken = page.evaluate(DROP, [list(texts), list(texts.values())])
    print(f"drop to loop: {taken / 1000:.2f} s (load {os.getloadavg()[0]:.0f})")
    page.wait_for_timeout(2000)
    idle = "!document.body.classList.contains('busy')"
    tell(
        "confirm to the first curve", lambda: page.click("#confirm"), "!!document.querySelector('.stairs .live')", page
    )
    until(page, f"{idle} && document.querySelector('#action').textContent.startsWith('Add')")
    page.wait_for_timeout(1000)
    drag(browser, page, server)
    page.get_by_text("Reset", exact=True).click()
    fallen = "document.querySelectorAll('.stairs .mark.identify:not(.live)').length === 2"
    begun = time.monotonic()
    tell("add to the fallen error", lambda: page.click("#action"), fallen, page)
    until(page, idle)
    print(f"add to the next verdict: {time.monotonic() - begun:.1f} s (load {os.getloadavg()[0]:.0f})")


def main(samples: int) -> None:
    texts = measurement(samples)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        command = [sys.executable, "-m", "pzt_ident", "workbench", "--no-browser"]
        server = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True)
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        try:
            assert server.stdout is not None
            address = server.stdout.readline().removeprefix("workbench: ").strip()
            story(browser, address, server.pid, texts)
        finally:
            browser.close()
            server.terminate()
            server.wait()


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20_000)
