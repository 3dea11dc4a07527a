"""The workbench's HTTP server: one process, this machine only, no file outside the folder in which it was started."""

from __future__ import annotations

import asyncio
import json
import secrets
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from functools import partial
from importlib import import_module
from importlib.resources import files
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, PlainTextResponse, Response, StreamingResponse
from starlette.routing import Route

from pzt_ident.errors import InputError, RunError
from pzt_ident.workbench import gets, page_state
from pzt_ident.workbench.bench import Bench
from pzt_ident.workbench.export import exported
from pzt_ident.workbench.fleet import Fleet
from pzt_ident.workbench.guard import Guard
from pzt_ident.workbench.posts import CHANGES
from pzt_ident.workbench.session import Session
from pzt_ident.workbench.session_results import gathered
from pzt_ident.workbench.uploads import TooLarge, form_of, inspect, measurement, reference, upload

POLLING_INTERVAL = 0.1  # s
SERVED = {".js": "text/javascript", ".css": "text/css", ".html": "text/html", ".svg": "image/svg+xml"}

Handler = Callable[[Bench, Request], Awaitable[Response]]


def make_app(session: Session, hosts: set[str], token: str, fleet: Fleet | None = None) -> Guard:
    """The application; `hosts`: the allowed values of the Host header; `fleet`: the lot that is shown first."""
    bench = Bench(session, fleet)

    @asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        bench.runner.warm()
        ready = asyncio.create_task(asyncio.to_thread(prepare, bench))
        yield
        await ready
        await bench.close()

    posts: dict[str, Handler] = {name: partial(change, name) for name in CHANGES}
    posts |= {"upload": upload, "reference": reference, "look": inspect, "measurement": measurement}
    posts |= {"simulate": simulate, "report": make_report, "export": make_export}
    pages: dict[str, Handler] = {"/": page, "/favicon.ico": no_content, "/web/{name:path}": web_file}
    pages |= {"/report/{key}": report, "/file/{key}": handout, "/atlas": atlas, "/lot/{key}": lot}
    routes = [route(bench, path, handler) for path, handler in pages.items()]
    routes += [route(bench, f"/api/{name}", handler) for name, handler in {**gets.GETS, "events": events}.items()]
    routes += [route(bench, f"/api/{name}", handler, "POST") for name, handler in posts.items()]
    app = Starlette(routes=routes, lifespan=lifespan)
    app.state.bench = bench
    return Guard(app, hosts, token)


def prepare(bench: Bench) -> None:
    """Have in this process the compiled kernels and the model of the current step before the page asks for them."""
    import_module("pzt_ident.engine.kernel")
    with suppress(InputError):
        bench.state()


def route(bench: Bench, path: str, handler: Handler, method: str = "GET") -> Route:
    """A handler at a path; InputError and RunError become responses with status 400 and their message."""

    async def respond(request: Request) -> Response:
        try:
            return await handler(bench, request)
        except asyncio.CancelledError:
            return PlainTextResponse("the workbench has ended", 503)
        except TooLarge as error:
            return JSONResponse({"error": str(error)}, status_code=413, headers={"connection": "close"})
        except (InputError, RunError) as error:
            return JSONResponse({"error": bench.session.readable(str(error))}, status_code=400)
        except (KeyError, TypeError, ValueError) as error:
            return JSONResponse({"error": f"not a form of the workbench: {error!r}"}, status_code=400)

    return Route(path, respond, methods=[method])


async def change(name: str, bench: Bench, request: Request) -> Response:
    """A change of the session; the answer is the state after it."""
    await bench.change(name, CHANGES[name], await form_of(request))
    return await gets.state(bench, request)


async def simulate(bench: Bench, request: Request) -> Response:
    return await gets.simulate(bench, await form_of(request))


async def make_report(bench: Bench, request: Request) -> Response:
    """Write the report of the current step; returns an address that cannot be guessed."""
    from pzt_ident.report.page import write_report

    path = await asyncio.to_thread(lambda: write_report(gathered(bench.session)))
    return JSONResponse({"url": f"/report/{handed_out(bench, path)}", "file": bench.session.relative(path)})


async def make_export(bench: Bench, request: Request) -> Response:
    """Write the model of the current step for another program, as an archive; returns an address as of a report."""
    form = await form_of(request)
    path = await asyncio.to_thread(exported, bench.session, form)
    return JSONResponse({"url": f"/file/{handed_out(bench, path)}", "file": bench.session.relative(path)})


def handed_out(bench: Bench, path: Path) -> str:
    """The key of a file that is given away."""
    key = secrets.token_urlsafe(24)
    bench.handouts[key] = path
    return key


async def report(bench: Bench, request: Request) -> Response:
    path = bench.handouts.get(request.path_params["key"])
    return FileResponse(path, media_type="text/html") if path else PlainTextResponse("not found", 404)


async def handout(bench: Bench, request: Request) -> Response:
    path = bench.handouts.get(request.path_params["key"])
    return FileResponse(path, filename=path.name) if path else PlainTextResponse("not found", 404)


async def lot(bench: Bench, request: Request) -> Response:
    """The page of the lot."""
    fleet = bench.fleet
    if fleet is None or not secrets.compare_digest(request.path_params["key"].encode(), fleet.key.encode()):
        return PlainTextResponse("not found", 404)
    return HTMLResponse(await asyncio.to_thread(lambda: fleet.page))


async def atlas(bench: Bench, request: Request) -> Response:
    """The atlas of effects, or, with status 202, a page that waits for it."""
    if html := bench.atlas.page():
        return HTMLResponse(html)
    waiting = served("waiting.html")
    waiting.status_code = 202
    return waiting


async def page(bench: Bench, request: Request) -> Response:
    return served("workbench.html")


async def no_content(bench: Bench, request: Request) -> Response:
    return Response(status_code=204)


async def web_file(bench: Bench, request: Request) -> Response:
    return served(request.path_params["name"])


def served(name: str) -> Response:
    """A file of the page by its name, which must be one of those in the package."""
    folders = [files(f"pzt_ident.{package}").joinpath("web") for package in ("report", "workbench")]
    web_files = {item.name: item for folder in folders for item in folder.iterdir()}
    kind = SERVED.get(Path(name).suffix)
    if name not in web_files or kind is None:
        return PlainTextResponse("not found", 404)
    return Response(web_files[name].read_bytes(), media_type=f"{kind}; charset=utf-8")


async def events(bench: Bench, request: Request) -> Response:
    """Server-sent events: the lines of `events.jsonl` of the current step, and `changed` when the state changes."""
    return StreamingResponse(event_stream(bench, request), media_type="text/event-stream")


async def event_stream(bench: Bench, request: Request) -> AsyncIterator[str]:
    step, version, offsets = (bench.session, -1), -1, dict[Path, int]()
    while not bench.session.closing() and not await request.is_disconnected():
        session = bench.session
        if (session, session.at) != step:
            step, offsets = (session, session.at), {}
            yield event({"event": "step", "step": session.at})
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
