"""Start the workbench: a free port of this machine, a token, and the browser."""

from __future__ import annotations

import secrets
import socket
from collections.abc import Callable
from pathlib import Path

from pzt_ident.errors import InputError
from pzt_ident.workbench.app import make_app
from pzt_ident.workbench.session import Session

LOOPBACK = ("127.0.0.1", "localhost", "::1")


def serve(
    source: Path | None,
    folder: Path,
    host: str,
    port: int,
    exposed: bool,
    ready: Callable[[str], None],
    plugins: bool = False,
) -> None:
    """Serve until interrupted; `ready` is told the address with its token. `source` is a job, or a file of data that
    the page opens with. With `plugins`, the files of code that jobs name are loaded.

    Raises InputError where the host is another machine's and `exposed` is not set, or the port is taken.
    """
    import uvicorn

    if host not in LOOPBACK and not exposed:
        remedy = "add --allow-network if whoever can reach it may read and run everything in this folder"
        raise InputError(f"{host} can be reached from other machines", where="--host", remedy=remedy)
    root = Path.cwd()
    session = Session(root, folder, plugins)
    given = opened(session, source, root) if source else ""
    bound = bind(host, port)
    number = bound.getsockname()[1]
    shown = f"[{host}]" if ":" in host else host
    hosts = {f"{name}:{number}" for name in ({"127.0.0.1", "localhost", "[::1]"} if host in LOOPBACK else {shown})}
    token = secrets.token_urlsafe(24)
    config = uvicorn.Config(
        make_app(session, hosts, token), log_level="error", server_header=False, timeout_graceful_shutdown=2
    )
    server = uvicorn.Server(config)
    session.closing = lambda: server.should_exit
    ready(f"http://{shown}:{number}/#{token}{given}")
    server.run(sockets=[bound])


def opened(session: Session, source: Path, root: Path) -> str:
    """Begin with a job, or go on with its session; a file of data is named to the page, which asks for its columns."""
    if source.suffix.lower() in (".yaml", ".yml"):
        session.open(source)
        return ""
    if not source.resolve().is_relative_to(root):
        raise InputError("is not in this folder", where=str(source), remedy="start the workbench where the data are")
    return f"&{source.resolve().relative_to(root)}"


def bind(host: str, port: int) -> socket.socket:
    bound = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET)
    bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        bound.bind((host, port))
    except OSError as error:
        raise InputError(error.strerror or str(error), where=f"{host}:{port}", remedy="give another --port") from None
    bound.listen()
    return bound
