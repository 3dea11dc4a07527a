"""Files that are dropped onto the page, and forms."""

from __future__ import annotations

import asyncio
import json
import re
import secrets
from pathlib import Path
from typing import Any

from starlette.requests import Request
from starlette.responses import JSONResponse, Response

from pzt_ident.errors import InputError
from pzt_ident.files import plain
from pzt_ident.workbench.bench import Bench
from pzt_ident.workbench.columns import columns_of
from pzt_ident.workbench.guard import LARGEST_UPLOAD, inside
from pzt_ident.workbench.measurement import measured

LARGEST_FORM = 1 << 20
NAME = re.compile(r"\w[\w .,;+=@#%&'()\[\]-]{0,120}")


async def form_of(request: Request) -> dict[str, Any]:
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


class TooLarge(InputError):
    """A dropped file that is larger than any that is taken."""


async def upload(bench: Bench, request: Request) -> Response:
    """Store a dropped file in the session's folder and return its columns. It is read as numbers, never executed. One
    that cannot be read is not kept, so that a corrected one can be dropped."""
    path, new = await stored(bench.session.data, request)
    bench.runner.warm()
    try:
        return await inspected(bench, (path, None))
    except InputError:
        if new:
            path.unlink(missing_ok=True)
        raise


async def reference(bench: Bench, request: Request) -> Response:
    """Store a reference that the stage is to follow, and say what is in it."""
    path, new = await stored(bench.session.folder / "references", request)
    try:
        return JSONResponse(
            await asyncio.to_thread(reference_facts, bench, path, request.query_params.get("rate") or None)
        )
    except InputError:
        if new:
            path.unlink(missing_ok=True)
        raise


def reference_facts(bench: Bench, path: Path, rate: str | None) -> dict[str, Any]:
    """Axes, samples and rate of a reference for the model of the current step. Raises InputError where it is none."""
    from pzt_ident.api.drive import reference_of
    from pzt_ident.api.reference import read_reference
    from pzt_ident.run.identified import read_identified

    session = bench.session
    identified = read_identified(session.step() / "run", session.plugins)
    record = read_reference(path, identified, rate)
    signals, dt, _ = reference_of(identified, record, None)
    axes = {axis: {"unit": record.drive[axis]} for axis in record.axes}
    return {"file": session.relative(path), "axes": axes, "samples": signals.shape[1], "rate": 1 / dt}


async def stored(folder: Path, request: Request) -> tuple[Path, bool]:
    """Where a dropped file lies now, and whether it is new. Raises InputError for a name that cannot be, or that
    another file has, and for a file that is too large."""
    name = request.query_params.get("name", "")
    if not NAME.fullmatch(name):
        raise InputError(f"{name!r} cannot be the name of a file", remedy="use letters, digits, spaces and . , _ + -")
    if int(request.headers.get("content-length", 0)) > LARGEST_UPLOAD:
        raise TooLarge(f"larger than {LARGEST_UPLOAD >> 20} MiB")
    folder.mkdir(parents=True, exist_ok=True)
    path, part = folder / name, folder / f".{secrets.token_hex(8)}.part"
    new = not path.exists()
    try:
        size = 0
        with part.open("wb") as file:
            async for piece in request.stream():
                size += len(piece)
                if size > LARGEST_UPLOAD:
                    raise TooLarge(f"larger than {LARGEST_UPLOAD >> 20} MiB")
                file.write(piece)
        if path.exists() and path.read_bytes() != part.read_bytes():
            raise InputError(f"another {name!r} was dropped before", remedy="give it another name")
        part.replace(path)
        return path, new
    finally:
        part.unlink(missing_ok=True)


async def inspect(bench: Bench, request: Request) -> Response:
    """The columns of files in the folder of the workbench, or of one table or sheet of each."""
    return await inspected(bench, *files_of(bench, (await form_of(request))["files"]))


def files_of(bench: Bench, sources: list[dict[str, Any]]) -> list[tuple[Path, str | None]]:
    return [(inside(bench.session.root, source["file"]), source.get("part")) for source in sources]


async def inspected(bench: Bench, *files: tuple[Path, str | None]) -> Response:
    record = await asyncio.to_thread(columns_of, *files)
    for file, (path, _) in zip(record["files"], files, strict=True):
        file["file"] = bench.session.relative(path)
    return JSONResponse(plain(record))


async def measurement(bench: Bench, request: Request) -> Response:
    """The signals of records before there is a job, and what can be guessed from them."""
    form = await form_of(request)
    records = form.get("records") or [{"files": form["files"]}]
    files = [files_of(bench, record["files"]) for record in records]
    return JSONResponse(plain(await asyncio.to_thread(measured, files, form.get("columns"))))
