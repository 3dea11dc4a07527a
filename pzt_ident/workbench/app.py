"""The workbench's server: one process, this machine only, no file beyond the folder it was started in."""

from __future__ import annotations

import asyncio
import json
import re
import secrets
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from importlib.resources import files
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, PlainTextResponse, Response, StreamingResponse
from starlette.routing import Route

from pzt_ident.amend import amended
from pzt_ident.errors import InputError, RunError
from pzt_ident.workbench import view
from pzt_ident.workbench.bench import Bench
from pzt_ident.workbench.columns import columns_of
from pzt_ident.workbench.form import places
from pzt_ident.workbench.gather import gathered
from pzt_ident.workbench.guard import LARGEST_UPLOAD, Guard, inside

LARGEST_FORM = 1 << 20
SECONDS_BETWEEN_LOOKS = 0.1
NAME = re.compile(r"\w[\w .,;+=@#%&'()\[\]-]{0,120}")
SERVED = {".js": "text/javascript", ".css": "text/css", ".html": "text/html"}

Handler = Callable[[Bench, Request], Awaitable[Response]]


def make_app(bench: Bench, hosts: set[str], token: str) -> Guard:
    """The application; `hosts` are the values that a request's Host may have."""

    @asynccontextmanager
    async def life(app: Starlette) -> AsyncIterator[None]:
        yield
        await bench.stop()

    posts = {"upload": upload, "look": look, "job": begin, "run": run, "stop": stop, "model": choose, "report": ticket}
    posts |= {"add": change, "remove": change, "undo": undo, "back": back}
    gets = {"state": state, "signals": signals, "events": events, "job": job_file, "drive": drive_file}
    pages = {"/": page, "/favicon.ico": nothing, "/web/{name:path}": web, "/report/{key}": report}
    routes = [route(bench, path, handler) for path, handler in pages.items()]
    routes += [route(bench, f"/api/{name}", handler) for name, handler in gets.items()]
    routes += [route(bench, f"/api/{name}", handler, "POST") for name, handler in posts.items()]
    app = Starlette(routes=routes, lifespan=life)
    app.state.reports = dict[str, Path]()
    return Guard(app, hosts, token)


def route(bench: Bench, path: str, handler: Handler, method: str = "GET") -> Route:
    """A handler at a path; what it raises of bad input is said."""

    async def answer(request: Request) -> Response:
        try:
            return await handler(bench, request)
        except (InputError, RunError) as error:
            return JSONResponse({"error": bench.readable(str(error))}, status_code=400)
        except (KeyError, TypeError, ValueError) as error:
            return JSONResponse({"error": f"not a form of the workbench: {error!r}"}, status_code=400)

    return Route(path, answer, methods=[method])


async def ticket(bench: Bench, request: Request) -> Response:
    """Write the report of the step shown; where it can be read, by who has the address only."""
    from pzt_ident.report.page import write_report

    made, key = await asyncio.to_thread(lambda: write_report(gathered(bench))), secrets.token_urlsafe(24)
    request.app.state.reports[key] = made
    return JSONResponse({"url": f"/report/{key}", "file": bench.relative(made)})


async def report(bench: Bench, request: Request) -> Response:
    path = request.app.state.reports.get(request.path_params["key"])
    return FileResponse(path, media_type="text/html") if path else PlainTextResponse("not found", 404)


async def page(bench: Bench, request: Request) -> Response:
    return served("workbench.html")


async def nothing(bench: Bench, request: Request) -> Response:
    return Response(status_code=204)


async def web(bench: Bench, request: Request) -> Response:
    return served(request.path_params["name"])


def served(name: str) -> Response:
    """A file of the page, by its name among those that the package has."""
    folder = files("pzt_ident.web")
    known = {item.name: item for item in folder.iterdir()} | {
        f"uplot/{item.name}": item for item in folder.joinpath("uplot").iterdir()
    }
    kind = SERVED.get(Path(name).suffix)
    if name not in known or kind is None:
        return PlainTextResponse("not found", 404)
    return Response(known[name].read_bytes(), media_type=f"{kind}; charset=utf-8")


async def state(bench: Bench, request: Request) -> Response:
    return JSONResponse(await asyncio.to_thread(view.state, bench))


async def signals(bench: Bench, request: Request) -> Response:
    return JSONResponse(await asyncio.to_thread(view.signals, bench))


async def form(request: Request) -> dict[str, Any]:
    """The body as JSON. Raises InputError where it is too large or none."""
    body = bytearray()
    async for part in request.stream():
        body += part
        if len(body) > LARGEST_FORM:
            raise InputError("the form is too large")
    found = json.loads(body or b"{}")
    if not isinstance(found, dict):
        raise InputError("the form is no mapping")
    return found


async def upload(bench: Bench, request: Request) -> Response:
    """Keep a dropped file in the session's folder and say what is in it. It is read as numbers, never run."""
    name = request.query_params.get("name", "")
    if not NAME.fullmatch(name):
        raise InputError(f"{name!r} cannot be the name of a file", remedy="use letters, digits, blanks and . , _ + -")
    if int(request.headers.get("content-length", 0)) > LARGEST_UPLOAD:
        return too_large()
    bench.data.mkdir(parents=True, exist_ok=True)
    path, part = bench.data / name, bench.data / f".{secrets.token_hex(8)}.part"
    new = not path.exists()
    try:
        size = 0
        with part.open("wb") as file:
            async for piece in request.stream():
                size += len(piece)
                if size > LARGEST_UPLOAD:
                    return too_large()
                file.write(piece)
        if path.exists() and path.read_bytes() != part.read_bytes():
            raise InputError(f"another {name!r} was dropped before", remedy="give it another name")
        part.replace(path)
        return await looked_at(bench, (path, None))
    except InputError:
        if new:  # it may be dropped again once it is mended
            path.unlink(missing_ok=True)
        raise
    finally:
        part.unlink(missing_ok=True)


def too_large() -> Response:
    return JSONResponse(
        {"error": f"larger than {LARGEST_UPLOAD >> 20} MiB"}, status_code=413, headers={"connection": "close"}
    )


async def look(bench: Bench, request: Request) -> Response:
    """What is in files of the folder that the workbench was started in, or in one of the tables or sheets of each."""
    wanted = (await form(request))["files"]
    return await looked_at(bench, *((inside(bench.root, item["file"]), item.get("part")) for item in wanted))


async def looked_at(bench: Bench, *files: tuple[Path, str | None]) -> Response:
    found = await asyncio.to_thread(columns_of, *files)
    for about, (path, _) in zip(found["files"], files, strict=True):
        about["file"] = bench.relative(path)
    return JSONResponse(found)


async def begin(bench: Bench, request: Request) -> Response:
    wanted = await form(request)
    for place in places(wanted["records"]):
        inside(bench.root, place["file"])
    await asyncio.to_thread(bench.begin, wanted)
    return await state(bench, request)


async def choose(bench: Bench, request: Request) -> Response:
    words = [str(word) for word in (await form(request))["model"]]
    await bench.stop()
    await asyncio.to_thread(bench.choose, words)
    bench.start()
    return await state(bench, request)


async def run(bench: Bench, request: Request) -> Response:
    bench.start()
    return await state(bench, request)


async def stop(bench: Bench, request: Request) -> Response:
    await bench.stop()
    return await state(bench, request)


async def change(bench: Bench, request: Request) -> Response:
    """Add an effect or take one off, and run."""
    act = bench.add if request.url.path.endswith("/add") else bench.remove
    effect = str((await form(request))["effect"])
    await bench.stop()
    await asyncio.to_thread(act, effect)
    bench.start()
    return await state(bench, request)


async def undo(bench: Bench, request: Request) -> Response:
    await bench.stop()
    bench.undo()
    return await state(bench, request)


async def back(bench: Bench, request: Request) -> Response:
    number = int((await form(request))["step"])
    await bench.stop()
    bench.go(number)
    return await state(bench, request)


async def job_file(bench: Bench, request: Request) -> Response:
    """The job, for the folder that the workbench was started in."""
    job = bench.job()
    return PlainTextResponse(amended(job, job.effects, bench.root))


async def drive_file(bench: Bench, request: Request) -> Response:
    found = view.read(bench.step() / "diagnosis" / "diagnosis.json")
    if not found or not found["next_experiment"]:
        raise InputError("no drive is proposed")
    return FileResponse(bench.step() / "diagnosis" / "next_experiment.csv", media_type="text/csv")


async def events(bench: Bench, request: Request) -> Response:
    """Server-sent events: the lines of the `events.jsonl` of the step shown, and `changed` when the state has."""
    return StreamingResponse(following(bench, request), media_type="text/event-stream")


async def following(bench: Bench, request: Request) -> AsyncIterator[str]:
    shown, version, told = -1, -1, dict[Path, int]()
    while not bench.closing() and not await request.is_disconnected():
        if bench.at != shown:
            shown, told = bench.at, {}
            yield event({"event": "step", "step": shown})
        for path in bench.logs():
            for line in news(path, told):
                yield event(view.printed(json.loads(line)))
        if bench.version != version:
            version = bench.version
            yield event({"event": "changed", "version": version})
        await asyncio.sleep(SECONDS_BETWEEN_LOOKS)


def news(path: Path, told: dict[Path, int]) -> list[bytes]:
    """The whole lines of a log that were not told yet; all of them where it began anew."""
    with suppress(FileNotFoundError), path.open("rb") as file:
        if told.get(path, 0) > path.stat().st_size:
            told[path] = 0
        file.seek(told.get(path, 0))
        lines = file.read().rpartition(b"\n")[0]
        told[path] = told.get(path, 0) + len(lines) + bool(lines)
        return lines.splitlines()
    return []


def event(content: dict[str, Any]) -> str:
    return f"data: {json.dumps(content)}\n\n"
