"""The atlas beside a session: drawn when it is asked for, once, and again for other words."""

from pathlib import Path

import pytest

from pzt_ident.errors import RunError
from pzt_ident.model.registry import blocks
from pzt_ident.workbench.atlas import Atlas

from .conftest import HOST, alone


@pytest.fixture
def asked(monkeypatch):
    """Instead of processes: the arguments of each, and a page that says how many there were."""
    made = []

    async def run(self, name, arguments):
        made.append(arguments)
        if len(made) > 2:
            raise RunError("the disk is full")
        Path(arguments[arguments.index("-o") + 1]).write_text(f"atlas {len(made)}", encoding="utf-8")

    monkeypatch.setattr(Atlas, "run", run)
    return made


def test_it_is_drawn_once_and_again_for_other_words(session, asked, monkeypatch):
    async def story():
        atlas = Atlas(session)
        assert asked == []
        for drawn in ("atlas 1", "atlas 2"):
            assert (atlas.page(), atlas.page()) == ("", "")
            await atlas.task
            assert atlas.page() == atlas.page() == drawn
            monkeypatch.setattr(blocks, "words", lambda more=drawn: ["creep", more])
        assert len(asked) == 2 and not session.folder.exists()
        atlas.page()
        await atlas.task
        for _ in range(2):
            with pytest.raises(RunError, match="disk is full"):
                atlas.page()
        assert len(asked) == 3

    alone(story())


def test_the_words_of_a_job_are_in_it(session, asked):
    async def story():
        session.plugins, session.at = True, 1
        atlas = Atlas(session)
        atlas.page()
        await atlas.task

    session.steps = [{"number": 1}]
    alone(story())
    assert asked[0][3:] == ["--plugins", str(session.step(1) / "job.yaml")]


def test_the_page_waits_for_it_and_then_is_the_atlas(app, asked):
    from starlette.testclient import TestClient

    with TestClient(app, base_url=f"http://{HOST}") as stranger:
        waiting = stranger.get("/atlas")
        assert waiting.status_code == 202 and "being drawn" in waiting.text
        while (answer := stranger.head("/atlas")).status_code == 202:
            pass
        assert answer.status_code == 200 and stranger.get("/atlas").text == "atlas 1"
        assert stranger.get("/atlas", headers={"host": "evil.example"}).status_code == 421


def test_what_the_page_shows_has_its_place_in_the_atlas(client):
    state = client.get("/api/state").json()
    places = {item["name"]: item["about"] for item in state["blocks"] + state["effects"]}
    assert places["lumped"] == "/atlas#word-lumped" and places["creep"] == "/atlas#word-creep"
    forms = {form: place for item in state["effects"] for form, place in item["forms"].items()}
    assert forms["creep.voltage"] == "/atlas#word-creep.voltage" and "creep" not in forms
