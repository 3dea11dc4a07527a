"""The workbench's HTTP server: one process, this machine only, no file outside the folder in which it was started."""

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
from pzt_ident.workbench.job_form import file_sources
from pzt_ident.workbench.session import Session
from pzt_ident.workbench.session_results import gathered

LARGEST_FORM = 1 << 20
POLLING_INTERVAL = 0.1  # s
NAME = re.compile(r"\w[\w .,;+=@#%&'()\[\]-]{0,120}")
SERVED = {".js": "text/javascript", ".css": "text/css", ".html": "text/html"}

Handler = Callable[[Session, Request], Awaitable[Response]]


def make_app(session: Session, hosts: set[str], token: str) -> Guard:
    """The application; `hosts`: the allowed values of the Host header."""

    @asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        yield
        await session.stop()

    posts = {
        "upload": upload,
        "look": inspect,
        "job": begin,
        "run": run,
        "stop": stop,
        "model": set_model,
        "report": make_report,
    }
    posts |= {"add": change, "remove": change, "undo": undo, "back": go_to}
    gets = {"state": state, "signals": signals, "events": events, "job": job_file, "drive": drive_file}
    pages = {"/": page, "/favicon.ico": no_content, "/web/{name:path}": web_file, "/report/{key}": report}
    routes = [route(session, path, handler) for path, handler in pages.items()]
    routes += [route(session, f"/api/{name}", handler) for name, handler in gets.items()]
    routes += [route(session, f"/api/{name}", handler, "POST") for name, handler in posts.items()]
    app = Starlette(routes=routes, lifespan=lifespan)
    app.state.reports = dict[str, Path]()
    return Guard(app, hosts, token)


def route(session: Session, path: str, handler: Handler, method: str = "GET") -> Route:
    """A handler at a path; InputError and RunError become responses with status 400 and their message."""

    async def respond(request: Request) -> Response:
        try:
            return await handler(session, request)
        except (InputError, RunError) as error:
            return JSONResponse({"error": session.readable(str(error))}, status_code=400)
        except (KeyError, TypeError, ValueError) as error:
            return JSONResponse({"error": f"not a form of the workbench: {error!r}"}, status_code=400)

    return Route(path, respond, methods=[method])


async def make_report(session: Session, request: Request) -> Response:
    """Write the report of the current step; returns an address that cannot be guessed."""
    from pzt_ident.report.page import write_report

    path, key = await asyncio.to_thread(lambda: write_report(gathered(session))), secrets.token_urlsafe(24)
    request.app.state.reports[key] = path
    return JSONResponse({"url": f"/report/{key}", "file": session.relative(path)})


async def report(session: Session, request: Request) -> Response:
    path = request.app.state.reports.get(request.path_params["key"])
    return FileResponse(path, media_type="text/html") if path else PlainTextResponse("not found", 404)


async def page(session: Session, request: Request) -> Response:
    return served("workbench.html")


async def no_content(session: Session, request: Request) -> Response:
    return Response(status_code=204)


async def web_file(session: Session, request: Request) -> Response:
    return served(request.path_params["name"])


def served(name: str) -> Response:
    """A file of the page by its name, which must be one of those in the package."""
    folders = [files(f"pzt_ident.{package}").joinpath("web") for package in ("report", "workbench")]
    web_files = {item.name: item for folder in folders for item in folder.iterdir()}
    web_files |= {f"uplot/{item.name}": item for item in web_files.pop("uplot").iterdir()}
    kind = SERVED.get(Path(name).suffix)
    if name not in web_files or kind is None:
        return PlainTextResponse("not found", 404)
    return Response(web_files[name].read_bytes(), media_type=f"{kind}; charset=utf-8")


async def state(session: Session, request: Request) -> Response:
    return JSONResponse(await asyncio.to_thread(page_state.state, session))


async def signals(session: Session, request: Request) -> Response:
    return JSONResponse(await asyncio.to_thread(page_state.signals, session))


async def form(request: Request) -> dict[str, Any]:
    """The body as a JSON mapping. Raises InputError if it is too large or not a mapping."""
    body = bytearray()
    async for part in request.stream():
        body += part
        if len(body) > LARGEST_FORM:
            raise InputError("the form is too large")
    content = json.loads(body or b"{}")
    if not isinstance(content, dict):
        raise InputError("the form is not a mapping")
    return content


async def upload(session: Session, request: Request) -> Response:
    """Store a dropped file in the session's folder and return its columns. It is read as numbers, never executed."""
    name = request.query_params.get("name", "")
    if not NAME.fullmatch(name):
        raise InputError(f"{name!r} cannot be the name of a file", remedy="use letters, digits, spaces and . , _ + -")
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
        return await inspected(session, (path, None))
    except InputError:
        if new:  # so that a corrected file can be dropped
            path.unlink(missing_ok=True)
        raise
    finally:
        part.unlink(missing_ok=True)


def too_large() -> Response:
    return JSONResponse(
        {"error": f"larger than {LARGEST_UPLOAD >> 20} MiB"}, status_code=413, headers={"connection": "close"}
    )


async def inspect(session: Session, request: Request) -> Response:
    """The columns of files in the folder of the workbench, or of one table or sheet of each."""
    items = (await form(request))["files"]
    return await inspected(session, *((inside(session.root, item["file"]), item.get("part")) for item in items))


async def inspected(session: Session, *files: tuple[Path, str | None]) -> Response:
    record = await asyncio.to_thread(columns_of, *files)
    for file, (path, _) in zip(record["files"], files, strict=True):
        file["file"] = session.relative(path)
    return JSONResponse(record)


async def begin(session: Session, request: Request) -> Response:
    job_form = await form(request)
    for source in file_sources(job_form["records"]):
        inside(session.root, source["file"])
    await asyncio.to_thread(session.begin, job_form)
    return await state(session, request)


async def set_model(session: Session, request: Request) -> Response:
    words = [str(word) for word in (await form(request))["model"]]
    await session.stop()
    await asyncio.to_thread(session.set_model, words)
    session.start()
    return await state(session, request)


async def run(session: Session, request: Request) -> Response:
    session.start()
    return await state(session, request)


async def stop(session: Session, request: Request) -> Response:
    await session.stop()
    return await state(session, request)


async def change(session: Session, request: Request) -> Response:
    """Add or remove an effect, and run."""
    action = session.add if request.url.path.endswith("/add") else session.remove
    effect = str((await form(request))["effect"])
    await session.stop()
    await asyncio.to_thread(action, effect)
    session.start()
    return await state(session, request)


async def undo(session: Session, request: Request) -> Response:
    await session.stop()
    session.undo()
    return await state(session, request)


async def go_to(session: Session, request: Request) -> Response:
    number = int((await form(request))["step"])
    await session.stop()
    session.go_to(number)
    return await state(session, request)


async def job_file(session: Session, request: Request) -> Response:
    """The job file with paths relative to the folder in which the workbench was started."""
    job = session.job()
    return PlainTextResponse(edited(job, job.effects, session.root))


async def drive_file(session: Session, request: Request) -> Response:
    diagnosis = page_state.read(session.step() / "diagnosis" / "diagnosis.json")
    if not diagnosis or not diagnosis["next_experiment"]:
        raise InputError("no drive is proposed")
    return FileResponse(session.step() / "diagnosis" / "next_experiment.csv", media_type="text/csv")


async def events(session: Session, request: Request) -> Response:
    """Server-sent events: the lines of `events.jsonl` of the current step, and `changed` when the state changes."""
    return StreamingResponse(event_stream(session, request), media_type="text/event-stream")


async def event_stream(session: Session, request: Request) -> AsyncIterator[str]:
    step, version, offsets = -1, -1, dict[Path, int]()
    while not session.closing() and not await request.is_disconnected():
        if session.at != step:
            step, offsets = session.at, {}
            yield event({"event": "step", "step": step})
        for path in session.logs():
            for line in new_lines(path, offsets):
                yield event(page_state.printed(json.loads(line)))
        if session.version != version:
            version = session.version
            yield event({"event": "changed", "version": version})
        await asyncio.sleep(POLLING_INTERVAL)


def new_lines(path: Path, offsets: dict[Path, int]) -> list[bytes]:
    """The complete lines of a log beyond its offset, which is moved on; all lines if the log was started anew."""
    with suppress(FileNotFoundError), path.open("rb") as file:
        if offsets.get(path, 0) > path.stat().st_size:
            offsets[path] = 0
        file.seek(offsets.get(path, 0))
        lines = file.read().rpartition(b"\n")[0]
        offsets[path] = offsets.get(path, 0) + len(lines) + bool(lines)
        return lines.splitlines()
    return []


def event(content: dict[str, Any]) -> str:
    return f"data: {json.dumps(content)}\n\n"
