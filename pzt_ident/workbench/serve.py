"""Start the workbench: a free port of this machine, a token, and the browser."""

from __future__ import annotations

import secrets
import socket
from collections.abc import Callable
from pathlib import Path

from pzt_ident.errors import InputError
from pzt_ident.lot.outcome import read_lot
from pzt_ident.workbench.app import make_app
from pzt_ident.workbench.fleet import Fleet
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
    """Serve until interrupted; `ready` is called with the address and its token. `source`: a job, a data file that the
    page opens, or the folder of a fleet. `plugins`: whether code files that jobs name are loaded.

    Raises InputError if the host can be reached from other machines and `exposed` is not set, or if the port is taken.
    """
    import uvicorn

    if host not in LOOPBACK and not exposed:
        remedy = "add --allow-network if everyone who can reach it may read and run everything in this folder"
        raise InputError(f"{host} can be reached from other machines", where="--host", remedy=remedy)
    root = Path.cwd()
    session = Session(root, folder, plugins)
    fleet = Fleet(folder_of_fleet(source, root)) if source and source.is_dir() else None
    fragment = opened(session, source, root) if source and not fleet else ""
    listener = bind(host, port)
    number = listener.getsockname()[1]
    address = f"[{host}]" if ":" in host else host
    hosts = {f"{name}:{number}" for name in ({"127.0.0.1", "localhost", "[::1]"} if host in LOOPBACK else {address})}
    token = secrets.token_urlsafe(24)
    config = uvicorn.Config(
        make_app(session, hosts, token, fleet), log_level="error", server_header=False, timeout_graceful_shutdown=2
    )
    server = uvicorn.Server(config)
    session.closing = lambda: server.should_exit
    ready(f"http://{address}:{number}{fleet.url if fleet else '/'}#{token}{fragment}")
    server.run(sockets=[listener])


def opened(session: Session, source: Path, root: Path) -> str:
    """Open a job in the session, or check a data file; returns the part of the page's address that names that file."""
    if source.suffix.lower() in (".yaml", ".yml"):
        session.open(source)
        return ""
    return f"&{in_root(source, root).relative_to(root)}"


def folder_of_fleet(source: Path, root: Path) -> Path:
    read_lot(source)
    return in_root(source, root)


def in_root(source: Path, root: Path) -> Path:
    if not source.resolve().is_relative_to(root):
        remedy = "start the workbench in the folder of the data"
        raise InputError("is not in this folder", where=str(source), remedy=remedy)
    return source.resolve()


def bind(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listener = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)  # named, so that asyncio sets TCP_NODELAY
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((host, port))
    except OSError as error:
        raise InputError(error.strerror or str(error), where=f"{host}:{port}", remedy="give another --port") from None
    listener.listen()
    return listener
