"""How long a frame of the page takes on a record of 200,000 samples, drawn without a graphics card.

python -m experiments.demo.fluid
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile

from playwright.sync_api import sync_playwright

SAMPLES = 200_000
FRAMES = """async (samples) => {
  const { Explorer } = await import("/web/explorer.js");
  const make = (value) => Float64Array.from({ length: samples }, (_, i) => value(i));
  const time = make((i) => 1e-4 * i), drive = time.map((t) => 50 - 50 * Math.cos(8 * t) * Math.exp(-t / 15));
  const response = time.map((t, i) => 0.1 * drive[i] - 0.4 * Math.sin(8 * t) + 0.01 * Math.random());
  const sums = (values) => { let sum = 0; return Float64Array.from([0, ...values], (value) => (sum += value)); };
  const model = (name, size) => {
    const residual = make(() => size * (Math.random() - 0.5));
    return { name, residual, squares: sums(residual.map((value) => value ** 2)) };
  };
  const root = document.createElement("div");
  document.querySelector("main").replaceChildren(root);
  const page = new Explorer(root, [{
    name: "long", axis: "x", use: "identify", unit: "µm", driveUnit: "V", start: 0, dt: 1e-4, settle: 0, time, drive,
    response, index: make((i) => i), counts: sums(make(() => 1)), models: [model("now", 0.02), model("before", 0.05)],
  }], { floors: { x: 0.01 } });
  const acts = {
    "move the cursor": (i) => page.hover({ cursor: { idx: 10 * i }, shown: page.plots[0].shown }),
    "zoom or pan": (i) => page.zoom(1000 * i, samples / 2 + 1000 * i),
    "mark 6 s": (i) => page.mark([[1000 * i, 60000 + 1000 * i]]),
  };
  const found = {};
  for (const [name, act] of Object.entries(acts)) {
    const taken = [];
    for (let i = 0; i < 30; i++) {
      const begun = performance.now();
      act(i);
      await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
      taken.push(performance.now() - begun);
    }
    found[name] = taken.sort((a, b) => a - b);
  }
  return found;
}"""


def main() -> None:
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        command = [sys.executable, "-m", "pzt_ident", "workbench", "--no-browser"]
        server = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True)
        try:
            assert server.stdout is not None
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1280, "height": 900})
            page.goto(server.stdout.readline().removeprefix("workbench: ").strip())
            for name, taken in page.evaluate(FRAMES, SAMPLES).items():
                print(f"{name}: {taken[0]:.0f} ms at best, {taken[len(taken) // 2]:.0f} ms in the median")
            browser.close()
        finally:
            server.terminate()
            server.wait()


if __name__ == "__main__":
    main()
