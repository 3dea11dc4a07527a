"""The atlas is drawn once, and again for other words or other source."""

from pathlib import Path

import pytest

from pzt_ident.atlas import kept, page
from pzt_ident.model.registry import blocks


@pytest.fixture
def drawings(tmp_path, monkeypatch):
    """How often it was drawn, into a cache folder of its own."""
    made = []
    monkeypatch.setattr(kept, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(page, "atlas", lambda: f"atlas {len(made)}" if made.append(1) is None else "")
    return made


def test_it_is_drawn_once(tmp_path, drawings):
    written = [page.write_atlas(tmp_path / f"{name}.html").read_text() for name in "ab"]
    assert written == ["atlas 1", "atlas 1"] and len(drawings) == 1
    assert list(page.drawn()) == []


def test_it_is_drawn_again_where_the_package_has_changed(tmp_path, drawings, monkeypatch):
    page.write_atlas(tmp_path / "a.html")
    monkeypatch.setattr(Path, "read_bytes", lambda path: b"another source")
    assert page.write_atlas(tmp_path / "b.html").read_text() == "atlas 2"
    assert len(list(tmp_path.glob("atlas_*.html"))) == 1


def test_words_from_elsewhere_are_not_kept(tmp_path, drawings, monkeypatch):
    monkeypatch.setattr(blocks["creep"], "__module__", "lab.creep")
    for _ in range(2):
        page.write_atlas(tmp_path / "a.html")
    assert len(drawings) == 2 and not list(tmp_path.glob("atlas_*.html"))
