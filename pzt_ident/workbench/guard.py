"""Access control: requests are accepted only for this host, from this page and with the token of this session."""

from __future__ import annotations

import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from pathlib import Path
from typing import Any

from pzt_ident.errors import InputError

Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Send = Callable[[Message], Awaitable[None]]
Receive = Callable[[], Awaitable[Message]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

POLICY = "default-src 'self'; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
HEADERS = {
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cache-control": "no-store",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
}
LARGEST_UPLOAD = 256 << 20
OWN_POLICY = (
    "/report/",
    "/lot/",
    "/atlas",
)  # beginnings of the paths of pages that bring their own content security policy


class Guard:
    """ASGI middleware. A request passes if its Host is trusted, its Origin is this page or absent, and, under /api/,
    its token is right. Every response carries the security headers."""

    def __init__(self, app: App, hosts: set[str], token: str) -> None:
        self.app, self.hosts, self.token = app, hosts, token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        if scope["type"] != "http":
            return
        path = scope["path"]

        async def guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                added = HEADERS if path.startswith(OWN_POLICY) else HEADERS | {"content-security-policy": POLICY}
                message["headers"] = [*message["headers"], *((k.encode(), v.encode()) for k, v in added.items())]
            await send(message)

        refusal = self.refusal(path, headers_of(scope))
        if refusal is None:
            await self.app(scope, receive, guarded)
            return
        status, reason = refusal
        plain = [(b"content-type", b"text/plain; charset=utf-8"), (b"connection", b"close")]
        await guarded({"type": "http.response.start", "status": status, "headers": plain})
        await guarded({"type": "http.response.body", "body": reason.encode()})

    def refusal(self, path: str, headers: dict[str, list[str]]) -> tuple[int, str] | None:
        """HTTP status and reason of a refusal; None if the request may pass."""
        if len(headers.get("host", [])) != 1 or headers["host"][0].lower() not in self.hosts:
            return 421, "wrong Host: not the one that the workbench was started for"
        if any(origin.lower() not in {f"http://{host}" for host in self.hosts} for origin in headers.get("origin", [])):
            return 403, "requests from other pages are not allowed"
        token = headers.get("x-pzt-token", [""])[0]
        if path.startswith("/api/") and not secrets.compare_digest(token.encode(), self.token.encode()):
            return 403, "the token is missing or wrong: open the address that the terminal shows"
        return None


def headers_of(scope: Scope) -> dict[str, list[str]]:
    headers: dict[str, list[str]] = {}
    for key, value in scope["headers"]:
        headers.setdefault(key.decode("latin-1").lower(), []).append(value.decode("latin-1"))
    return headers


def below(root: Path, pattern: str) -> None:
    """Raises InputError unless a pattern of folders or files can match only what is below `root`."""
    parts = Path(pattern).parts
    fixed = next((place for place, part in enumerate(parts) if set(part) & set("*?[")), len(parts))
    if ".." in parts or not parts:
        raise InputError(f"{pattern!r} is not in the workbench's folder", remedy="give folders in it, such as lot/*/")
    if fixed:
        inside(root, str(Path(*parts[:fixed])))


def inside(root: Path, name: str) -> Path:
    """The path of a file below `root`. Raises InputError if it lies outside, or if a part of the path is a link."""
    path = Path(name)
    paths = [root.joinpath(*path.parts[: place + 1]) for place in range(len(path.parts))]
    if not path.parts or path.is_absolute() or ".." in path.parts or any(character in name for character in "\0\\$"):
        raise InputError(f"{name!r} is not in the workbench's folder", remedy="drop the file onto the page")
    if any(part.is_symlink() for part in paths):
        raise InputError(f"{name!r} is a link", remedy="copy the file into the folder")
    return paths[-1]
