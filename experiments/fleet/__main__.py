"""Commands of the experiment on fleets."""

from __future__ import annotations

import json
import os
import shutil
import time
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any, NamedTuple

import click
import pandas as pd
import psutil

from experiments.fleet.cluster import TCP
from experiments.fleet.lot import write_lot
from experiments.fleet.measure import Memory, overhead, peak
from experiments.fleet.shared import grown
from experiments.fleet.tables import OUT, keep
from experiments.trust.essence import differences, essence
from pzt_ident.job.schema import load_job
from pzt_ident.lot.identify import fleet
from pzt_ident.lot.outcome import read_lot
from pzt_ident.run.events import nobody
from pzt_ident.run.place import Local, Place, place_of

FOLDER = click.argument("folder", type=click.Path(path_type=Path))
KEPT = click.option("--out", type=click.Path(path_type=Path), default=OUT, show_default=True, help="Rows and tables.")


@click.group()
def main() -> None:
    """Fleets: what they find and what they cost."""


@main.command()
@FOLDER
@click.option("--devices", type=int, default=200, show_default=True)
@click.option("--seed", type=int, default=1, show_default=True)
@click.option("--hidden", type=float, default=0.1, show_default=True, help="Share with an effect the job lacks.")
@click.option("--broken", type=float, default=0.06, show_default=True, help="Share with a broken file.")
@click.option("--outliers", type=float, default=0.03, show_default=True)
@click.option("--samples", type=int, default=2000, show_default=True)
@click.option("--swarm", type=(int, int), default=(70, 250), show_default=True, help="Particles and generations.")
def draw(folder: Path, devices: int, **facts: object) -> None:
    """Write a lot of DEVICES into FOLDER."""
    folder.mkdir(parents=True)
    click.echo(write_lot(folder, devices, **facts))  # type: ignore[arg-type]


def identified(folder: Path, name: str, place: Place, listen: Callable[[dict], None] = nobody, **more: Any) -> Path:
    """The lot in a folder, identified anew into its folder `name`."""
    shutil.rmtree(folder / name, ignore_errors=True)
    job, devices = load_job(folder / "job.yaml"), [str(folder / "lot.csv")]
    return fleet(job, devices, folder / name, place=place, listen=listen, **more)


@main.command("overhead")
@click.option("--tasks", type=int, default=40, show_default=True)
@click.option("--seconds", type=float, default=1.0, show_default=True)
@KEPT
def overhead_(tasks: int, seconds: float, out: Path) -> None:
    """What a task that waits costs beside itself, in processes of this machine and on a scheduler on TCP, two workers
    each."""
    with TCP(workers=2) as cluster:
        places = {"local:2": Local(2), "tcp, 2 workers": place_of(cluster.address)}
        costs = {name: overhead(place, tasks, seconds, 2) for name, place in places.items()}
    rows = [
        {"place": name, "tasks": tasks, "ms a task": 1000 * cost["overhead"], "efficiency": cost["efficiency"]}
        for name, cost in costs.items()
    ]
    click.echo(keep("overhead", rows, out))


@main.command()
@FOLDER
@KEPT
def workers(folder: Path, out: Path) -> None:
    """How much sooner two workers than one have identified the lot in FOLDER, by the clock: the devices compute."""
    rows: list[dict[str, Any]] = []
    for place in ("local", "tcp"):
        one, two = (clocked(folder, place, count) for count in (1, 2))
        seconds = {"one worker [s a device]": one.clock, "two workers [s a device]": two.clock}
        cpu = {"CPU of a device, one worker [s]": one.device, "CPU of a device, two workers [s]": two.device}
        cpu |= {"client and scheduler [s of CPU a device]": two.beside}
        idle = {"two cores idle": 1 - (two.device + two.beside) / (2 * two.clock)}
        devices = len(read_lot(folder / "workers").done)
        efficiency = {"efficiency": one.clock / (2 * two.clock)}
        rows.append({"place": place, "devices": devices, **seconds, **efficiency, **cpu, **idle})
    click.echo(keep("workers", rows, out))


class Clocked(NamedTuple):
    """Seconds a device: by the clock, from the first that each worker has done to the last, so that what starting takes
    is not counted; of CPU in its worker; and of CPU that client and scheduler, which are on the same cores, took."""

    clock: float
    device: float
    beside: float


def clocked(folder: Path, place: str, count: int) -> Clocked:
    ends: list[tuple[float, float]] = []
    beside = [psutil.Process()]

    def listen(event: dict) -> None:
        if event["event"] == "devices" and event["done"]:
            ends.append((time.perf_counter(), sum(sum(process.cpu_times()[:2]) for process in beside)))

    with TCP(workers=count) if place == "tcp" else nullcontext() as cluster:
        beside += [psutil.Process(cluster.scheduler.pid)] if cluster else []
        identified(folder, "workers", place_of(cluster.address) if cluster else Local(count), listen)
    (begun, before), (over, after) = ends[count - 1], ends[-1]
    devices = len(ends) - count
    cpu = pd.read_csv(folder / "workers" / "devices.csv")["cpu [s]"].mean()
    return Clocked((over - begun) / devices, float(cpu), (after - before) / devices)


@main.command()
@FOLDER
@click.option("--every", type=int, default=250, show_default=True)
@click.option("--budget", type=float, default=1e9, help="Stop after so many seconds.")
@click.option("--on", help="As of `pzt-ident fleet --on`; a scheduler and two workers on TCP if not given.")
@KEPT
def memory(folder: Path, every: int, budget: float, on: str | None, out: Path) -> None:
    """The memory of client, scheduler and workers over the devices of the lot in FOLDER, and the client's time."""
    with nullcontext() if on else TCP(workers=2) as cluster:
        numbers = {"client": os.getpid()}
        if cluster:
            numbers |= {"scheduler": cluster.scheduler.pid, "worker": cluster.workers[0].pid}
        note, start, cpu = Memory(numbers, every), time.perf_counter(), time.process_time()

        def listen(event: dict) -> None:
            note(event)
            if time.perf_counter() - start > budget:
                raise KeyboardInterrupt

        try:
            identified(folder, "out", place_of(on or cluster.address), listen)
        except KeyboardInterrupt:
            click.echo("stopped")
    last, spent = note.rows[-1], time.process_time() - cpu
    client = {"ms of CPU a device": 1000 * spent / last["devices"], "MiB with the table": peak()}
    rows = [
        {"process": name, "MiB": last[name], "KiB a device": note.growth(name), **(client if name == "client" else {})}
        for name in numbers
    ]
    click.echo(f"{last['devices']:.0f} devices in {last['seconds']:.0f} s")
    words = "memory-local" if on else "memory"
    keep(f"{words}-by-device", note.rows, out)
    click.echo(keep(words, rows, out))


@main.command()
@FOLDER
@click.option("--improve", is_flag=True)
@click.option("--budget", type=float, default=None, help="CPU seconds of each diagnosis.")
@click.option("--after", type=int, default=20, show_default=True, help="Devices after which a worker is killed.")
@KEPT
def killed(folder: Path, improve: bool, budget: float | None, after: int, out: Path) -> None:
    """The lot in FOLDER on two workers on TCP, of which one is killed and replaced; what is found, beside the truth,
    and whether it is what a fleet finds that nobody disturbs."""
    asked = {"improve": improve, "budget": budget}
    with TCP(workers=2) as cluster:

        def listen(event: dict) -> None:
            if event["event"] == "devices" and event["done"] == after and cluster.workers[0].poll() is None:
                cluster.workers[0].kill()
                cluster.workers.append(cluster.worker())

        start = time.perf_counter()
        disturbed = identified(folder, "out", place_of(cluster.address), listen, **asked)
        seconds = time.perf_counter() - start
    whole = identified(folder, "undisturbed", Local(2), **asked)
    other = differences(essence(whole), essence(disturbed))
    click.echo("\n".join([f"{seconds:.0f} s; {len(other)} files differ from those of an undisturbed fleet", *other]))
    words = "killed-improve" if improve else "killed"
    files = {"seconds": seconds, "files compared": len(essence(whole)), "files that differ": len(other)}
    keep(f"{words}-against-undisturbed", [files], out)
    click.echo(keep(words, list(score(folder, disturbed)), out))


def score(folder: Path, out: Path) -> list[dict[str, Any]]:
    """What was found of each kind of device."""
    truth, lot = json.loads((folder / "truth.json").read_text()), read_lot(out)
    odd, ill, states = set(lot.odd), set(lot.ill_fitted), {row["device"]: row for row in lot.rows}
    rows = []
    for kind in sorted({facts["kind"] for facts in truth.values()}):
        names = [name for name, facts in truth.items() if facts["kind"] == kind]
        counts = {
            "devices": len(names),
            "done": sum(states[name]["state"] == "done" for name in names),
            "fits worse": sum(name in ill for name in names),
            "parameters out of line": sum(name in odd for name in names),
            "named right": sum(states[name].get("effects") == [kind] for name in names),
            "named": sum(bool(states[name].get("effects")) for name in names),
        }
        rows.append({"kind": kind, **counts})
    return rows


@main.command()
@FOLDER
@click.option("--devices", type=int, multiple=True, default=(1, 2, 4, 8), show_default=True)
@click.option("--evaluations", type=int, default=2000, show_default=True)
@KEPT
def shared(folder: Path, devices: tuple[int, ...], evaluations: int, out: Path) -> None:
    """Time and memory of one job on the first devices of the lot in FOLDER, of which each has a gain of its own and
    all share the rest."""
    click.echo(keep("shared", [grown(folder, count, evaluations) for count in devices], out))


if __name__ == "__main__":
    main()
