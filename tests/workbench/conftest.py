"""A workbench in a folder of its own, spoken to without a network."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from pzt_ident.workbench.app import make_app
from pzt_ident.workbench.session import Session

TOKEN = "a-token-of-the-session"
HOST = "127.0.0.1:8000"
GOOD = {"host": HOST, "x-pzt-token": TOKEN}


def alone(story: Coroutine[Any, Any, Any]) -> Any:
    """Run in a thread of its own: the tests in a browser leave a loop running in this one."""
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(asyncio.run, story).result()


@pytest.fixture
def session(tmp_path, monkeypatch) -> Session:
    monkeypatch.chdir(tmp_path)
    return Session(tmp_path, tmp_path / "workbench")


@pytest.fixture
def app(session):
    return make_app(session, {HOST, "localhost:8000"}, TOKEN)


@pytest.fixture
def client(app) -> TestClient:
    """Knows the token."""
    return TestClient(app, base_url=f"http://{HOST}", headers=GOOD)


@pytest.fixture
def stranger(app) -> TestClient:
    return TestClient(app, base_url=f"http://{HOST}")


def measured(path: Path, rows: int = 400) -> Path:
    """A little measurement with headings and units."""
    lines = ["time [s],u_x [V],x [um]"]
    for i in range(rows):
        drive = 50 - abs(50 - i % 100)
        lines.append(f"{i / 100:.2f},{drive},{0.1 * drive + 0.01 * (i % 7):.4f}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def form(**more):
    """What the page sends when the columns are confirmed."""
    columns = {
        name: {"header": header, "number": number, "unit": unit}
        for number, (name, header, unit) in enumerate(
            [("time", "time [s]", "s"), ("drive", "u_x [V]", "V"), ("response", "x [um]", "um")], 1
        )
    }
    return {
        "name": "small",
        "records": [{"file": "data.csv", "use": "identify"}],
        "time": columns["time"],
        "axes": {"x": {"drive": columns["drive"], "response": columns["response"]}},
        "model": ["bouc_wen"],
    } | more
