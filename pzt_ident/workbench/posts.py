"""The changes that a page may ask for, each from its form."""

from __future__ import annotations

import asyncio
from typing import Any

from pzt_ident.data.units import duration
from pzt_ident.errors import InputError
from pzt_ident.workbench import edits
from pzt_ident.workbench.bench import Bench, Form
from pzt_ident.workbench.guard import below, inside
from pzt_ident.workbench.job_form import file_sources


async def begin(bench: Bench, form: Form) -> None:
    session = bench.session
    for source in file_sources(form["records"]):
        inside(session.root, source["file"])
    await bench.runner.stop()
    await asyncio.to_thread(session.begin, form)
    bench.runner.failure = ""
    bench.runner.warm()


async def run(bench: Bench, form: Form) -> None:
    bench.fill()


async def stop(bench: Bench, form: Form) -> None:
    await bench.runner.stop()


async def set_model(bench: Bench, form: Form) -> None:
    words = [str(word) for word in form["model"]]
    await bench.step(lambda: bench.session.set_model(words))


async def add(bench: Bench, form: Form) -> None:
    effect = str(form["effect"])
    await bench.step(lambda: bench.session.add(effect))


async def remove(bench: Bench, form: Form) -> None:
    effect = str(form["effect"])
    await bench.step(lambda: bench.session.remove(effect))


async def undo(bench: Bench, form: Form) -> None:
    await bench.move(bench.session.undo)


async def go_to(bench: Bench, form: Form) -> None:
    number = int(form["step"])
    await bench.move(lambda: bench.session.go_to(number))


async def improve(bench: Bench, form: Form) -> None:
    budget = str(form.get("budget") or "")
    if budget:
        duration(budget)
    bench.improve(budget or None)


async def settings(bench: Bench, form: Form) -> None:
    """Fix a parameter at a value, free it, or give it bounds."""
    await bench.step(lambda: edits.set_parameter(bench.session, form))


async def search(bench: Bench, form: Form) -> None:
    await bench.step(lambda: edits.search(bench.session, form))


async def polish(bench: Bench, form: Form) -> None:
    values = {str(name): float(value) for name, value in form["values"].items()}
    await bench.step(lambda: edits.polish(bench.session, values))


async def note(bench: Bench, form: Form) -> None:
    bench.session.keep(int(form.get("step", bench.session.at)), note=str(form["text"]))


async def draft(bench: Bench, form: Form) -> None:
    bench.session.keep_draft({key: value for key, value in form.items() if key != "at"})


async def control(bench: Bench, form: Form) -> None:
    bench.put_to_work(inside(bench.session.root, str(form["reference"])), control_options(form.get("options") or {}))


async def device(bench: Bench, form: Form) -> None:
    await bench.open_device(str(form["device"]))


async def fleet(bench: Bench, form: Form) -> None:
    pattern = str(form["pattern"])
    below(bench.session.root, pattern)
    bench.identify_lot(pattern, bool(form.get("improve")))


async def go_on(bench: Bench, form: Form) -> None:
    bench.resume_lot()


WORDS = {
    "rate": "--rate",
    "slew": "--slew",
    "noise_gain": "--noise-gain",
    "current": "--current",
    "capacitance": "--capacitance",
}


def control_options(options: dict[str, Any]) -> list[str]:
    """The options of `control` and `drive` that a form gives. Raises InputError for an unknown one."""
    line: list[str] = []
    for name, value in options.items():
        if value in (None, ""):
            continue
        if name == "limits":
            low, high = value
            line += ["--limits", f"{float(low):g}:{float(high):g}"]
        elif WORDS.get(name):
            line += [str(WORDS[name]), str(value)]
        else:
            raise InputError(f"unknown option {name!r}", remedy=f"give {', '.join(k for k, w in WORDS.items() if w)}")
    return line


CHANGES = {
    "job": begin,
    "run": run,
    "stop": stop,
    "model": set_model,
    "add": add,
    "remove": remove,
    "undo": undo,
    "back": go_to,
    "improve": improve,
    "settings": settings,
    "search": search,
    "polish": polish,
    "note": note,
    "draft": draft,
    "control": control,
    "device": device,
    "fleet": fleet,
    "go_on": go_on,
}
