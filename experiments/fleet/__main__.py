"""Commands of the experiment on fleets."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path

import click

from experiments.fleet.cluster import TCP
from experiments.fleet.lot import write_lot
from experiments.fleet.measure import Memory, overhead, peak, write_rows
from pzt_ident.job.schema import load_job
from pzt_ident.lot.identify import fleet
from pzt_ident.lot.outcome import read_lot
from pzt_ident.run.place import Local, place_of

FOLDER = click.argument("folder", type=click.Path(path_type=Path))


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


@main.command("overhead")
@click.option("--tasks", type=int, default=40, show_default=True)
@click.option("--seconds", type=float, default=1.0, show_default=True)
def overhead_(tasks: int, seconds: float) -> None:
    """What a task costs beside itself, in processes of this machine and on a scheduler on TCP, two workers each."""
    cluster = TCP(workers=2)
    try:
        for name, place in (("local:2", Local(2)), ("tcp, 2 workers", place_of(cluster.address))):
            cost = overhead(place, tasks, seconds, 2)
            click.echo(f"{name}: {1000 * cost['overhead']:.1f} ms a task, efficiency {cost['efficiency']:.1%}")
    finally:
        cluster.end()


@main.command()
@FOLDER
@click.option("--every", type=int, default=250, show_default=True)
@click.option("--budget", type=float, default=1e9, help="Stop after so many seconds.")
@click.option("--on", help="As of `pzt-ident fleet --on`; a scheduler and two workers on TCP if not given.")
def memory(folder: Path, every: int, budget: float, on: str | None) -> None:
    """The memory of client, scheduler and workers over the devices of the lot in FOLDER, and the client's time."""
    cluster, numbers = None if on else TCP(workers=2), {"client": os.getpid()}
    if cluster:
        numbers |= {"scheduler": cluster.scheduler.pid, "worker": cluster.workers[0].pid}
    note = Memory(numbers, every)
    start, cpu = time.perf_counter(), time.process_time()

    def listen(event: dict) -> None:
        note(event)
        if time.perf_counter() - start > budget:
            raise KeyboardInterrupt

    try:
        fleet(
            load_job(folder / "job.yaml"),
            [str(folder / "lot.csv")],
            folder / "out",
            place=place_of(on or cluster.address),
            listen=listen,
        )
    except KeyboardInterrupt:
        click.echo("stopped")
    finally:
        if cluster:
            cluster.end()
    write_rows(folder / "memory.csv", note.rows)
    last, spent = note.rows[-1], time.process_time() - cpu
    click.echo(f"{last['devices']:.0f} devices in {last['seconds']:.0f} s")
    for name in numbers:
        click.echo(f"{name}: {last[name]:.0f} MiB, {note.growth(name):+.2f} KiB a device")
    click.echo(f"client: {1000 * spent / last['devices']:.1f} ms of CPU a device, {peak():.0f} MiB with the table")


@main.command()
@FOLDER
@click.option("--improve", is_flag=True)
@click.option("--budget", type=float, default=None, help="CPU seconds of each diagnosis.")
@click.option("--after", type=int, default=20, show_default=True, help="Devices after which a worker is killed.")
def killed(folder: Path, improve: bool, budget: float | None, after: int) -> None:
    """The lot in FOLDER on two workers on TCP, of which one is killed and replaced; what is found, beside the truth."""
    cluster, start = TCP(workers=2), time.perf_counter()

    def listen(event: dict) -> None:
        if event["event"] == "devices" and event["done"] == after and cluster.workers[0].poll() is None:
            cluster.workers[0].kill()
            cluster.workers.append(cluster.worker())

    try:
        out = fleet(
            load_job(folder / "job.yaml"),
            [str(folder / "lot.csv")],
            folder / "out",
            improve=improve,
            budget=budget,
            place=place_of(cluster.address),
            listen=listen,
        )
    finally:
        cluster.end()
    click.echo(f"{time.perf_counter() - start:.0f} s")
    score(folder, out)


def score(folder: Path, out: Path) -> None:
    """What was found of each kind of device."""
    truth, lot = json.loads((folder / "truth.json").read_text()), read_lot(out)
    odd, ill, states = set(lot.odd), set(lot.ill_fitted), {row["device"]: row for row in lot.rows}
    for kind in sorted({facts["kind"] for facts in truth.values()}):
        names = [name for name, facts in truth.items() if facts["kind"] == kind]
        counts = {
            "done": sum(states[name]["state"] == "done" for name in names),
            "fits worse": sum(name in ill for name in names),
            "parameters out of line": sum(name in odd for name in names),
            "named right": sum(states[name].get("effects") == [kind] for name in names),
            "named": sum(bool(states[name].get("effects")) for name in names),
        }
        click.echo(f"{kind}: {len(names)}; " + ", ".join(f"{count} {what}" for what, count in counts.items() if count))


if __name__ == "__main__":
    main()
