"""What a page may ask for without changing anything."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable
from typing import Any

from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, PlainTextResponse, Response

from pzt_ident.errors import InputError
from pzt_ident.files import plain
from pzt_ident.job.edit import edited
from pzt_ident.report.spectra import spectra
from pzt_ident.workbench import downloads, page_state
from pzt_ident.workbench.bench import Bench
from pzt_ident.workbench.step_model import model_of

Get = Callable[[Bench, Request], Awaitable[Response]]


def answer(content: Any) -> JSONResponse:
    """JSON, NaN as null."""
    return JSONResponse(plain(content))


async def state(bench: Bench, request: Request) -> Response:
    return JSONResponse(await asyncio.to_thread(bench.state))


async def signals(bench: Bench, request: Request) -> Response:
    """Of the current step and the one before, or of the steps that the query names."""
    numbers = [int(word) for word in request.query_params.get("steps", "").split(",") if word]
    return JSONResponse(await asyncio.to_thread(page_state.signals, bench.session, numbers))


async def spectrum(bench: Bench, request: Request) -> Response:
    return answer(await asyncio.to_thread(spectra, bench.session.step() / "run"))


async def proposal(bench: Bench, request: Request) -> Response:
    session, effect = bench.session, request.query_params["effect"]
    parameters = await asyncio.to_thread(lambda: model_of(session.step(), session.plugins).proposal(effect))
    return answer({"effect": effect, "parameters": page_state.printed(parameters)})


async def simulate(bench: Bench, form: dict[str, Any]) -> Response:
    """A line of JSON, then the model at the kept samples as 32-bit floats. Not a change: it is asked for with every
    movement of a slider."""
    session = bench.session

    def moved() -> bytes:
        model = model_of(session.step(), session.plugins).with_effect(str(form.get("effect") or ""))
        header, values = model.answer(form.get("values") or {}, bool(form.get("positions")))
        return json.dumps(header).encode() + b"\n" + values

    return Response(await asyncio.to_thread(moved), media_type="application/octet-stream")


async def job_file(bench: Bench, request: Request) -> Response:
    """The job of a step with paths relative to the folder in which the workbench was started."""
    session, number = bench.session, request.query_params.get("step")
    job = session.job(int(number) if number else None)
    return PlainTextResponse(edited(job, job.effects, session.root))


async def drive_file(bench: Bench, request: Request) -> Response:
    diagnosis = page_state.read(bench.session.step() / "diagnosis" / "diagnosis.json")
    if not diagnosis or not diagnosis["next_experiment"]:
        raise InputError("no drive is proposed")
    return FileResponse(bench.session.step() / "diagnosis" / "next_experiment.csv", media_type="text/csv")


async def download(bench: Bench, request: Request) -> Response:
    name = request.query_params["name"]
    if name == downloads.FIGURES and name in downloads.names(bench.session):
        await bench.draw()
    path = await asyncio.to_thread(downloads.path_of, bench.session, name)
    return FileResponse(path, filename=path.name)


async def tracking(bench: Bench, request: Request) -> Response:
    """The signals of the comparison of ways to follow a reference."""
    return answer(await asyncio.to_thread(page_state.tracking, bench.session.step() / "control" / "control.csv"))


async def lot(bench: Bench, request: Request) -> Response:
    """How far the fleet is that is shown, and what is being done."""
    if bench.fleet is None:
        raise InputError("there is no lot")
    facts = await asyncio.to_thread(lambda fleet: fleet.facts, bench.fleet)
    bench.background(asyncio.to_thread(bench.fleet.draw))
    runner = bench.runner
    return answer(facts | {"running": runner.stage == "fleet", "failure": bench.session.readable(runner.failure)})


async def lot_file(bench: Bench, request: Request) -> Response:
    if bench.fleet is None:
        raise InputError("there is no lot")
    path = bench.fleet.given(request.query_params["name"])
    return FileResponse(path, filename=path.name)


GETS: dict[str, Get] = {
    "state": state,
    "signals": signals,
    "spectrum": spectrum,
    "proposal": proposal,
    "job": job_file,
    "step_job": job_file,
    "drive": drive_file,
    "download": download,
    "tracking": tracking,
    "lot": lot,
    "lot_file": lot_file,
}
