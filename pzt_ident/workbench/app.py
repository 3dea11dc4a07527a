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

from pzt_ident.errors import InputError, RunError
from pzt_ident.job.edit import edited
from pzt_ident.workbench import page_state
from pzt_ident.workbench.columns import columns_of
from pzt_ident.workbench.guard import LARGEST_UPLOAD, Guard, inside
from pzt_ident.workbench.job_form import places
from pzt_ident.workbench.session import Session
from pzt_ident.workbench.session_results import gathered

LARGEST_FORM = 1 << 20
SECONDS_BETWEEN_LOOKS = 0.1
NAME = re.compile(r"\w[\w .,;+=@#%&'()\[\]-]{0,120}")
SERVED = {".js": "text/javascript", ".css": "text/css", ".html": "text/html"}

Handler = Callable[[Session, Request], Awaitable[Response]]


def make_app(session: Session, hosts: set[str], token: str) -> Guard:
    """The application; `hosts` are the values that a request's Host may have."""

    @asynccontextmanager
    async def life(app: Starlette) -> AsyncIterator[None]:
        yield
        await session.stop()

    posts = {"upload": upload, "look": look, "job": begin, "run": run, "stop": stop, "model": choose, "report": ticket}
    posts |= {"add": change, "remove": change, "undo": undo, "back": back}
    gets = {"state": state, "signals": signals, "events": events, "job": job_file, "drive": drive_file}
    pages = {"/": page, "/favicon.ico": nothing, "/web/{name:path}": web, "/report/{key}": report}
    routes = [route(session, path, handler) for path, handler in pages.items()]
    routes += [route(session, f"/api/{name}", handler) for name, handler in gets.items()]
    routes += [route(session, f"/api/{name}", handler, "POST") for name, handler in posts.items()]
    app = Starlette(routes=routes, lifespan=life)
    app.state.reports = dict[str, Path]()
    return Guard(app, hosts, token)


def route(session: Session, path: str, handler: Handler, method: str = "GET") -> Route:
    """A handler at a path; what it raises of bad input is said."""

    async def answer(request: Request) -> Response:
        try:
            return await handler(session, request)
        except (InputError, RunError) as error:
            return JSONResponse({"error": session.readable(str(error))}, status_code=400)
        except (KeyError, TypeError, ValueError) as error:
            return JSONResponse({"error": f"not a form of the workbench: {error!r}"}, status_code=400)

    return Route(path, answer, methods=[method])


async def ticket(session: Session, request: Request) -> Response:
    """Write the report of the step shown; where it can be read, by who has the address only."""
    from pzt_ident.report.page import write_report

    made, key = await asyncio.to_thread(lambda: write_report(gathered(session))), secrets.token_urlsafe(24)
    request.app.state.reports[key] = made
    return JSONResponse({"url": f"/report/{key}", "file": session.relative(made)})


async def report(session: Session, request: Request) -> Response:
    path = request.app.state.reports.get(request.path_params["key"])
    return FileResponse(path, media_type="text/html") if path else PlainTextResponse("not found", 404)


async def page(session: Session, request: Request) -> Response:
    return served("workbench.html")


async def nothing(session: Session, request: Request) -> Response:
    return Response(status_code=204)


async def web(session: Session, request: Request) -> Response:
    return served(request.path_params["name"])


def served(name: str) -> Response:
    """A file of the page, by its name among those that the package has."""
    folders = [files(f"pzt_ident.{room}").joinpath("web") for room in ("report", "workbench")]
    known = {item.name: item for folder in folders for item in folder.iterdir()}
    known |= {f"uplot/{item.name}": item for item in known.pop("uplot").iterdir()}
    kind = SERVED.get(Path(name).suffix)
    if name not in known or kind is None:
        return PlainTextResponse("not found", 404)
    return Response(known[name].read_bytes(), media_type=f"{kind}; charset=utf-8")


async def state(session: Session, request: Request) -> Response:
    return JSONResponse(await asyncio.to_thread(page_state.state, session))


async def signals(session: Session, request: Request) -> Response:
    return JSONResponse(await asyncio.to_thread(page_state.signals, session))


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


async def upload(session: Session, request: Request) -> Response:
    """Keep a dropped file in the session's folder and say what is in it. It is read as numbers, never run."""
    name = request.query_params.get("name", "")
    if not NAME.fullmatch(name):
        raise InputError(f"{name!r} cannot be the name of a file", remedy="use letters, digits, blanks and . , _ + -")
    if int(request.headers.get("content-length", 0)) > LARGEST_UPLOAD:
        return too_large()
    session.data.mkdir(parents=True, exist_ok=True)
    path, part = session.data / name, session.data / f".{secrets.token_hex(8)}.part"
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
        return await looked_at(session, (path, None))
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


async def look(session: Session, request: Request) -> Response:
    """What is in files of the folder that the workbench was started in, or in one of the tables or sheets of each."""
    wanted = (await form(request))["files"]
    return await looked_at(session, *((inside(session.root, item["file"]), item.get("part")) for item in wanted))


async def looked_at(session: Session, *files: tuple[Path, str | None]) -> Response:
    found = await asyncio.to_thread(columns_of, *files)
    for about, (path, _) in zip(found["files"], files, strict=True):
        about["file"] = session.relative(path)
    return JSONResponse(found)


async def begin(session: Session, request: Request) -> Response:
    wanted = await form(request)
    for place in places(wanted["records"]):
        inside(session.root, place["file"])
    await asyncio.to_thread(session.begin, wanted)
    return await state(session, request)


async def choose(session: Session, request: Request) -> Response:
    words = [str(word) for word in (await form(request))["model"]]
    await session.stop()
    await asyncio.to_thread(session.choose, words)
    session.start()
    return await state(session, request)


async def run(session: Session, request: Request) -> Response:
    session.start()
    return await state(session, request)


async def stop(session: Session, request: Request) -> Response:
    await session.stop()
    return await state(session, request)


async def change(session: Session, request: Request) -> Response:
    """Add an effect or take one off, and run."""
    act = session.add if request.url.path.endswith("/add") else session.remove
    effect = str((await form(request))["effect"])
    await session.stop()
    await asyncio.to_thread(act, effect)
    session.start()
    return await state(session, request)


async def undo(session: Session, request: Request) -> Response:
    await session.stop()
    session.undo()
    return await state(session, request)


async def back(session: Session, request: Request) -> Response:
    number = int((await form(request))["step"])
    await session.stop()
    session.go(number)
    return await state(session, request)


async def job_file(session: Session, request: Request) -> Response:
    """The job, for the folder that the workbench was started in."""
    job = session.job()
    return PlainTextResponse(edited(job, job.effects, session.root))


async def drive_file(session: Session, request: Request) -> Response:
    found = page_state.read(session.step() / "diagnosis" / "diagnosis.json")
    if not found or not found["next_experiment"]:
        raise InputError("no drive is proposed")
    return FileResponse(session.step() / "diagnosis" / "next_experiment.csv", media_type="text/csv")


async def events(session: Session, request: Request) -> Response:
    """Server-sent events: the lines of the `events.jsonl` of the step shown, and `changed` when the state has."""
    return StreamingResponse(following(session, request), media_type="text/event-stream")


async def following(session: Session, request: Request) -> AsyncIterator[str]:
    shown, version, told = -1, -1, dict[Path, int]()
    while not session.closing() and not await request.is_disconnected():
        if session.at != shown:
            shown, told = session.at, {}
            yield event({"event": "step", "step": shown})
        for path in session.logs():
            for line in news(path, told):
                yield event(page_state.printed(json.loads(line)))
        if session.version != version:
            version = session.version
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
