"""Time the kernels, the searches and the command line; print and write the tables and the figure of the README.

python experiments/performance/run.py             # all
python experiments/performance/run.py --searches  # the optimizers alone, printed
python experiments/performance/run.py --commands  # the command line alone, printed
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as every command has it, before NumPy comes

import numpy as np
from baselines import first_order_hold, lsoda, numpy_population, plain_loop
from roofline import Machine, machine

from pzt_ident.data.record import Record
from pzt_ident.engine.simulator import simulate
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks, optimizers
from pzt_ident.search.loop import Stop, optimize
from pzt_ident.search.problem import Problem

HERE = Path(__file__).parent
OUT = HERE.parents[1] / "results" / "reference" / "performance"
TRUTH = {
    "gain": 8.1947e-8,
    "alpha": 0.5590,
    "beta": 0.0148,
    "gamma": 0.0552,
    "mass": 0.1566,
    "damping": 5.0,
    "stiffness": 7.0028e7,
}
BOUNDS = {  # Lin & Lin (2012), Table 2, X axis
    "bouc_wen.gain": (0, 0.5),
    "bouc_wen.alpha": (0, 1),
    "bouc_wen.beta": (0, 1),
    "bouc_wen.gamma": (0, 1),
    "lumped.mass": (0.15, 0.17),
    "lumped.damping": (0, 10),
    "lumped.stiffness": (7e7, 8e7),
}
BASE = ("bouc_wen", "lumped")
MILLION = 1e6
HIDDEN = [*(("single", seed) for seed in (104, 110, 119, 125)), *(("pair", seed) for seed in (2, 100, 102, 103))]
WHOLE = "Bouc-Wen + lumped + error"


def drives(time_axis: np.ndarray) -> dict[str, np.ndarray]:
    t = time_axis
    return {
        "constant step (triangle, 1 Hz)": 130 * (1 - np.abs(1 - (2 * t) % 2)),
        "general (sine, 1 Hz)": 65 * (1 - np.cos(2 * np.pi * t)),
        "general (three sines, 1 to 111 Hz)": 60 * np.sin(2 * np.pi * t) + 5 * np.sin(234 * t) + 3 * np.sin(697 * t),
        "general (white noise)": np.random.default_rng(1).uniform(0, 130, t.size),
    }


def problem(u: np.ndarray, words: tuple[str, ...] = BASE) -> Problem:
    model, stage = (Chain([blocks[word] for word in chain], ["x"], [0]) for chain in (words, BASE))
    blank = Record("r", "identify", 1e-3, u[None], u[None] * 1e-7, response_units=("um",))
    truth = np.array([[TRUTH[entry.word] for entry in stage.entries]])
    y = np.round(simulate(stage, blank, truth)[0] / 1e-7) * 1e-7
    record = Record("r", "identify", 1e-3, u[None], y, response_units=("um",))
    specs = {name: SimpleNamespace(bounds=b, value=None) for name, b in BOUNDS.items() if name in model.names}
    return Problem(model, [record], specs)


def cpu(functions: dict[str, Callable[[], object]], rounds: int = 12, repeats: int = 9) -> dict[str, float]:
    """Least CPU seconds of a call of each, warm, in interleaved rounds: neighbours on the machine only ever add."""
    found = dict.fromkeys(functions, np.inf)
    for function in functions.values():
        function()
    for _ in range(rounds):
        for name, function in functions.items():
            for _ in range(repeats):
                begun = time.process_time()
                function()
                found[name] = min(found[name], time.process_time() - begun)
    return found


def kernels(best: Machine, samples: int = 5000, candidates: int = 70) -> list[tuple[str, float, float]]:
    """CPU microseconds a candidate, and at best."""
    t = np.arange(samples) / 1e3
    points = np.random.default_rng(0).uniform(size=(candidates, 7))
    functions: dict[str, Callable[[], object]] = {}
    least: dict[str, float] = {}
    for name, u in drives(t).items():
        whole, bare = problem(u), problem(u, ("bouc_wen",))
        least[f"{WHOLE}, {name}"] = best.seconds(whole.model, samples, "constant" in name)
        least[f"Bouc-Wen + error, {name}"] = best.seconds(bare.model, samples, "constant" in name)
        functions[f"{WHOLE}, {name}"] = lambda p=whole: p.loss(points)
        functions[f"Bouc-Wen + error, {name}"] = lambda p=bare: p.loss(points[:, :4])
    u = drives(t)["general (sine, 1 Hz)"]
    theta, response = problem(u).parameters(0.05 + 0.9 * points), problem(u).records[0].response[0]

    def loop() -> None:
        for row in theta:
            plain_loop(u, response, *row[:4], *first_order_hold(*row[4:], 1e-3))

    functions["numba loop, one candidate at a time"] = loop
    found = cpu(functions)
    found |= cpu({"NumPy exact step over the population": lambda: numpy_population(t, u, response, theta)}, 3, 1)
    rows = [(name, s / candidates * MILLION, least.get(name, np.nan) * MILLION) for name, s in found.items()]
    begun = time.process_time()
    lsoda(t[:501], u[:501], response[:501], theta[0])
    spent = (time.process_time() - begun) * samples / 500
    return [*rows, ("solve_ivp LSODA, rtol 1e-6 (500 samples, scaled)", spent * MILLION, np.nan)]


def added(best: Machine, samples: int = 5000, candidates: int = 72) -> list[tuple[str, float, float]]:
    """CPU microseconds a candidate with an effect more, in the middle of its bounds, and at best."""
    u = drives(np.arange(samples) / 1e3)["general (sine, 1 Hz)"]
    rng = np.random.default_rng(0)
    base = rng.uniform(size=(candidates, len(BOUNDS)))
    functions, least = {}, {}
    for effect in ("", *blocks.effects()):
        made = problem(u, (*BASE, *filter(None, [effect])))
        if effect and made.dimensions == len(BOUNDS):  # couples axes, of which there is one here
            continue
        points = np.full((candidates, made.dimensions), 0.5)
        own = [made.names.index(name) for name in BOUNDS]
        points[:, own] = base
        functions[effect] = lambda p=made, x=points: p.loss(x)
        least[effect] = best.seconds(made.model, samples)
    found = cpu(functions)
    rows = [(name or "none", s / candidates * MILLION, least[name] * MILLION) for name, s in found.items()]
    return sorted(rows, key=lambda row: row[1])


def whole_search() -> list[tuple[str, float]]:
    t = np.arange(5000) / 1e3
    made = problem(drives(t)["constant step (triangle, 1 Hz)"])
    settings = {"pso": {"population": 70, "generations": 250, "c1": 2.8, "c2": 1.3}}  # Lin & Lin

    functions: dict[str, Callable[[], object]] = {}
    for word in optimizers.words():
        chosen = optimizers[word].make(**settings.get(word, {})).with_budget(17_500)
        functions[word] = lambda o=chosen: optimize(
            o, made.dimensions, made.loss, 1, Stop(17_500), made.rotated_residuals
        )
    return list(cpu(functions, 3, 1).items())


def scaling() -> dict[str, list[tuple[int, float]]]:
    """CPU microseconds a candidate against samples, candidates and parameters."""
    rng = np.random.default_rng(0)
    found: dict[str, dict[int, tuple[Callable[[], object], int]]] = {"samples": {}, "candidates": {}, "parameters": {}}
    for samples in (100, 300, 1000, 3000, 10_000, 30_000, 100_000):
        made = problem(drives(np.arange(samples) / 1e3)["general (sine, 1 Hz)"])
        points = rng.uniform(size=(72, made.dimensions))
        found["samples"][samples] = (lambda p=made, x=points: p.loss(x)), 72
    u = drives(np.arange(5000) / 1e3)["general (sine, 1 Hz)"]
    made = problem(u)
    for count in (1, 8, 24, 25, 72, 240, 1200):
        points = rng.uniform(size=(count, made.dimensions))
        found["candidates"][count] = (lambda p=made, x=points: p.loss(x)), count
    record = Record("r", "identify", 1e-3, u[None], u[None] * 1e-7, response_units=("um",))
    plays, force = ("prandtl_ishlinskii",), ("lumped",)
    for words in (force, ("bouc_wen",), ("bouc_wen", *force), plays, plays + force):
        bare = Problem(Chain([blocks[word] for word in words], ["x"], [0]), [record])
        points = rng.uniform(size=(72, bare.dimensions))
        found["parameters"][bare.dimensions] = (lambda p=bare, x=points: p.loss(x)), 72
    result = {}
    for what, cases in found.items():
        spent = cpu({str(size): function for size, (function, _) in cases.items()}, 5, 3)
        result[what] = [(size, spent[str(size)] / cases[size][1] * MILLION) for size in sorted(cases)]
    return result


def command_line() -> list[tuple[str, float, float]]:
    """Wall and CPU seconds, all processes counted: the least of the second to fourth runs of each command."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        jobs = {"a small job": HERE / "small.yaml", "configs/x_axis.yaml": HERE.parents[1] / "configs" / "x_axis.yaml"}
        commands: dict[str, Callable[[int], list[str]]] = {"--help": lambda i: ["--help"]}
        for name, job in jobs.items():
            out = f"{folder}/{job.stem}"
            commands[f"run {name}"] = lambda i, job=job, out=out: ["run", str(job), "--quiet", "--out", f"{out}-{i}"]
        for name, arguments in commands.items():
            spent = [seconds([sys.executable, "-m", "pzt_ident", *arguments(i)]) for i in range(4)]
            rows.append((f"pzt-ident {name}", *map(min, zip(*spent[1:], strict=True))))
    return rows


def seconds(command: list[str]) -> tuple[float, float]:
    """Wall and CPU time of a command and what it starts."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter() - begun
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def commands() -> str:
    return table("command line, warm", "wall s | CPU s", command_line())


def improvement() -> list[tuple[str, float]]:
    """Wall seconds of `pzt-ident improve` on cases of experiments/hidden_effect, start of the program included."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for kind, seed in HIDDEN:
            draw = ["draw", "--seed", str(seed), "--cases", "1", "--kind", kind, "--out", folder]
            subprocess.run([sys.executable, "-m", "experiments.hidden_effect", *draw], check=True, cwd=HERE.parents[1])
            job = f"{folder}/cases/{kind}-{seed}/job.yaml"
            tool = [sys.executable, "-m", "pzt_ident", "improve", job, "--quiet", "--out", f"{folder}/{kind}-{seed}"]
            begun = time.perf_counter()
            subprocess.run(tool, check=True, stdout=subprocess.DEVNULL)
            rows.append((f"{kind} {seed}", time.perf_counter() - begun))
    return rows


def memory() -> list[tuple[str, float]]:
    """Peak memory in MiB of a search of few and of many generations, each in its own process."""
    rows = []
    for generations in (200, 2000, 20_000):
        done = subprocess.run(
            [sys.executable, __file__, "--memory", str(generations)], check=True, capture_output=True, text=True
        )
        rows.append((f"{generations} generations", float(done.stdout)))
    return rows


def peak(generations: int) -> float:
    made = problem(drives(np.arange(200) / 1e3)["general (sine, 1 Hz)"])
    optimize(
        optimizers["pso"].make(population=10, generations=generations),
        made.dimensions,
        made.loss,
        1,
        Stop(10 * generations),
    )
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def figure(found: dict[str, list[tuple[int, float]]]) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    labels = {"samples": "samples a record", "candidates": "candidates a batch", "parameters": "free parameters"}
    fig, axes = plt.subplots(1, 3, figsize=(180 / 25.4, 60 / 25.4), layout="constrained")
    for axis, (what, rows) in zip(axes, found.items(), strict=True):
        x, y = np.array(rows).T
        axis.plot(x, y, "o-" if what != "parameters" else "o", color="#0072B2", ms=3.5, lw=1)
        if what != "parameters":
            axis.set(xscale="log", yscale="log")
        else:
            axis.set_ylim(bottom=0)
        axis.set_xlabel(labels[what], fontsize=8)
        axis.tick_params(labelsize=7)
        axis.grid(alpha=0.25, lw=0.5)
    axes[0].set_ylabel("CPU per candidate (µs)", fontsize=8)
    fig.suptitle("Cost of one candidate: linear in samples, flat once lanes are full", fontsize=9)
    for kind in ("svg", "pdf", "png"):
        fig.savefig(OUT / f"scaling.{kind}", dpi=200)


def table(title: str, units: str, rows: Sequence[tuple[str, *tuple[float, ...]]]) -> str:
    lines = [f"| {title} | {units} |", "|---" * (2 + units.count("|")) + "|"]
    cells = (["–" if np.isnan(value) else f"{value:,.3g}" for value in values] for _, *values in rows)
    return "\n".join([*lines, *(f"| {row[0]} | {' | '.join(each)} |" for row, each in zip(rows, cells, strict=True))])


def against_roof(title: str, rows: list[tuple[str, float, float]]) -> str:
    reached = [(name, spent, least, 100 * least / spent) for name, spent, least in rows]
    return table(title, "CPU µs a candidate | at best | reached, %", reached)


def searches() -> str:
    return table("a search of 17,500 evaluations, warm", "CPU s", whole_search())


def main() -> None:
    OUT.mkdir(parents=True, exist_ok=True)
    best = machine()
    rows = kernels(best)
    ours = next(spent for name, spent, _ in rows if name == f"{WHOLE}, general (sine, 1 Hz)")
    ratios = [(name, value / ours) for name, value, _ in rows[-3:]]
    grown = scaling()
    figure(grown)
    parts = [
        f"At best {best.operations / 1e9:.0f} billion operations and {best.bytes / 1e9:.0f} GB a second and core.",
        against_roof("5,000 samples, 7 parameters, 70 candidates", rows),
        table("in ratio to pzt-ident on the same drive (sine)", "times as much", ratios),
        against_roof("Bouc-Wen + lumped + error on the sine, and an effect more", added(best)),
        searches(),
        commands(),
        table("improve, six records of some 60,000 samples, one or two hidden effects", "wall s", improvement()),
        table("peak memory, population 10", "MiB", memory()),
    ]
    text = f"Cores: {os.cpu_count()}. Load before: {os.getloadavg()[0]:.1f}.\n\n" + "\n\n".join(parts) + "\n"
    (OUT / "tables.md").write_text(text)
    (OUT / "scaling.json").write_text(json.dumps(grown))
    print(text)


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["--memory", generations]:
            print(peak(int(generations)))
        case ["--searches"]:
            print(searches())
        case ["--commands"]:
            print(commands())
        case _:
            main()
