"""Who may speak to the workbench, and what it gives away: the cases of an attacker."""

import itertools
import json
import os
import socket

import pytest
from starlette.testclient import TestClient

from pzt_ident.errors import InputError
from pzt_ident.workbench import uploads
from pzt_ident.workbench.gets import GETS as GETS_
from pzt_ident.workbench.guard import inside
from pzt_ident.workbench.posts import CHANGES
from pzt_ident.workbench.serve import bind

from .conftest import GOOD, HOST, TOKEN, form, measured

POSTS = [*CHANGES, "upload?name=a.csv", "reference?name=a.csv", "look", "measurement", "simulate", "report", "export"]
GETS = [*GETS_, "events"]


@pytest.mark.parametrize("name", POSTS)
def test_nothing_changes_without_the_token(stranger, session, name):
    for headers in ({}, {"x-pzt-token": ""}, {"x-pzt-token": TOKEN[:-1]}, {"x-pzt-token": "é"}):
        raw = {key: value.encode() for key, value in headers.items()}
        assert stranger.post(f"/api/{name}", content=b"{}", headers=raw).status_code == 403
    assert not session.folder.exists()


@pytest.mark.parametrize("name", GETS)
def test_nothing_is_read_without_the_token(stranger, name):
    assert stranger.get(f"/api/{name}").status_code == 403
    stranger.cookies.set("x-pzt-token", TOKEN)
    assert stranger.get(f"/api/{name}?token={TOKEN}").status_code == 403


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:8000", "127.0.0.1", "127.0.0.1:9", "127.0.0.1.evil.example:8000", ""]
)
@pytest.mark.parametrize("path", ["/", "/web/workbench.js", "/api/state"])
def test_a_foreign_host_is_refused(client, host, path):
    assert client.get(path, headers={"host": host}).status_code == 421


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "https://127.0.0.1:8000", "http://127.0.0.1:8001", "file://"]
)
def test_a_page_from_elsewhere_is_refused_even_with_the_token(client, origin):
    assert client.post("/api/run", json={}, headers={"origin": origin}).status_code == 403
    assert client.get("/api/state", headers={"origin": origin}).status_code == 403


def test_the_page_itself_is_served(client):
    assert client.get("/api/state", headers={"origin": f"http://{HOST}"}).status_code == 200
    for path in ("/", "/web/workbench.js", "/web/workbench.css"):
        answer = client.get(path)
        assert answer.status_code == 200
        assert answer.headers["content-security-policy"].startswith("default-src 'self';")
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert not [key for key in answer.headers if key.startswith("access-control")]


def test_no_other_origin_is_ever_let_in(client):
    answer = client.options(
        "/api/run", headers={"origin": "http://evil.example", "access-control-request-method": "POST"}
    )
    assert answer.status_code == 403
    assert not [key for key in answer.headers if key.startswith("access-control")]


@pytest.mark.parametrize(
    "path",
    [
        "/web/../cli.py",
        "/web/%2e%2e/cli.py",
        "/web/..%2fcli.py",
        "/web//etc/passwd",
        "/web/__init__.py",
        "/web/../page.css/../../cli.py",
        "/report/..%2f..%2fetc%2fpasswd",
        "/report/",
        "/etc/passwd",
    ],
)
def test_no_path_leads_out_of_the_page(client, path):
    assert client.get(path).status_code == 404


@pytest.mark.parametrize(
    "name",
    [
        "../secret.csv",
        "${HOME}/secret.csv",
        "/etc/passwd",
        "a/../../secret.csv",
        "..",
        ".",
        "",
        "link.csv",
        "linked/data.csv",
        "a\\b",
        "a\0b",
    ],
)
def test_no_file_outside_the_folder_is_read(client, session, tmp_path_factory, name):
    outside = tmp_path_factory.mktemp("outside")
    measured(outside / "data.csv")
    (session.root / "link.csv").symlink_to(outside / "data.csv")
    (session.root / "linked").symlink_to(outside, target_is_directory=True)
    measured(session.root.parent / "secret.csv")
    answer = client.post("/api/look", json={"files": [{"file": name}]})
    assert answer.status_code == 400 and "columns" not in answer.text
    measured(session.root / "data.csv")
    elsewhere = {"channels": {"x.response": {"file": name, "number": 3}}}
    for record in ({"file": name}, {"file": "data.csv"} | elsewhere):
        answer = client.post("/api/job", json=form(records=[record | {"use": "identify"}]))
        assert answer.status_code == 400
    assert not session.steps


def test_what_is_inside_is_read(client, session):
    (session.root / "deep").mkdir()
    measured(session.root / "deep" / "data.csv")
    assert inside(session.root, "deep/data.csv") == session.root / "deep" / "data.csv"
    found = client.post("/api/look", json={"files": [{"file": "deep/data.csv"}]}).json()
    assert [column["role"] for column in found["columns"]] == ["time", "x.drive", "x.response"]
    with pytest.raises(InputError):
        inside(session.root, "deep/../deep/data.csv")


@pytest.mark.parametrize("name", ["../a.csv", "a/b.csv", ".hidden", "", "a\\b.csv", "a\0.csv", "con\n.csv", "x" * 300])
def test_an_upload_cannot_choose_its_folder(client, session, name):
    answer = client.post("/api/upload", params={"name": name}, content=b"1,2\n3,4\n")
    assert answer.status_code == 400
    assert not session.folder.exists()


def test_an_upload_of_2_gb_is_refused_before_it_is_read(client, session):
    def body():
        yield b"1,2\n"
        raise AssertionError("the body was read on")

    answer = client.post("/api/upload?name=a.csv", content=body(), headers={"content-length": str(2 << 30)})
    assert answer.status_code == 413
    assert not list(session.folder.rglob("*.csv"))


def test_an_upload_that_lies_about_its_size_is_cut_off(client, session, monkeypatch):
    monkeypatch.setattr(uploads, "LARGEST_UPLOAD", 1000)
    answer = client.post("/api/upload?name=a.csv", content=itertools.repeat(b"1,2\n3,4\n" * 20, 50))
    assert answer.status_code == 413
    assert not [path for path in session.folder.rglob("*") if path.is_file()]


def test_nothing_uploaded_is_unpickled(client, tmp_path):
    import numpy as np

    class Trap:
        def __reduce__(self):
            return os.mkdir, (str(tmp_path / "trapped"),)

    np.save(tmp_path / "trap.npy", np.array([Trap()], dtype=object), allow_pickle=True)
    answer = client.post("/api/upload?name=trap.npy", content=(tmp_path / "trap.npy").read_bytes())
    assert answer.status_code == 400
    assert not (tmp_path / "trapped").exists()


def test_a_file_of_markup_comes_back_as_text(client):
    header = '<img src=x onerror=alert(1)> [V],"</script><script>alert(2)</script> [um]"'
    rows = "\n".join(f"{i},{i * i}" for i in range(50))
    answer = client.post("/api/upload?name=a.csv", content=f"{header}\n{rows}\n".encode())
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "application/json"
    assert answer.json()["columns"][0]["header"].startswith("<img")


def test_bad_forms_are_errors_not_failures(client, session):
    measured(session.root / "data.csv")
    for body in (
        b"",
        b"[]",
        b"{",
        b"\xff",
        b'{"records": 1}',
        json.dumps({"records": [{}]}).encode(),
        b"x" * (2 << 20),
    ):
        answer = client.post("/api/job", content=body)
        assert answer.status_code == 400, body[:40]
        assert answer.json()["error"]
    for name in ("add", "remove"):
        assert client.post(f"/api/{name}", json={"effect": "creep"}).status_code == 400


def test_words_of_a_form_cannot_write_other_keys_into_the_job(client, session):
    measured(session.root / "data.csv")
    answer = client.post("/api/job", json=form(name='x"\nseed: 99\nname: "y'))
    assert answer.status_code == 400 or "seed: 99" not in json.loads(answer.text)["job"]["text"].splitlines()


def test_hosts_of_the_network_need_a_second_flag(tmp_path, monkeypatch):
    from click.testing import CliRunner

    from pzt_ident.cli.commands import main

    monkeypatch.chdir(tmp_path)
    answer = CliRunner().invoke(main, ["workbench", "--host", "0.0.0.0", "--no-browser"])
    assert answer.exit_code == 2
    assert "--allow-network" in answer.stderr


def test_two_hosts_in_one_request_are_refused(app):
    client = TestClient(app, base_url=f"http://{HOST}")
    headers = [("host", HOST), ("host", "evil.example"), ("x-pzt-token", GOOD["x-pzt-token"])]
    assert client.get("/api/state", headers=headers).status_code == 421


def test_an_answer_does_not_wait_for_an_acknowledgement():
    """asyncio sets TCP_NODELAY where the protocol of a listener is named."""
    with bind("127.0.0.1", 0) as listener:
        assert listener.proto == socket.IPPROTO_TCP
