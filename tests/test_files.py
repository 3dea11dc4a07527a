"""Files are whole or not there, whatever happens meanwhile."""

import errno
import json
import os

import numpy as np
import pytest

from pzt_ident.files import cache_folder, replaced, write_json, write_text


def test_a_file_takes_its_place_whole(tmp_path):
    write_text(tmp_path / "new" / "a.txt", "old")
    with replaced(tmp_path / "new" / "a.txt") as beside:
        beside.write_text("new")
        assert (tmp_path / "new" / "a.txt").read_text() == "old"
    assert (tmp_path / "new" / "a.txt").read_text() == "new"
    assert os.listdir(tmp_path / "new") == ["a.txt"]


def test_a_full_disk_leaves_the_old_file_and_is_named(tmp_path):
    write_text(tmp_path / "a.txt", "old")
    with pytest.raises(OSError) as caught, replaced(tmp_path / "a.txt") as beside:
        beside.write_text("half")
        raise OSError(errno.ENOSPC, "No space left on device")
    assert caught.value.filename == str(tmp_path / "a.txt")
    assert os.listdir(tmp_path) == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "old"


def test_json_has_no_word_for_what_is_no_number(tmp_path):
    write_json(tmp_path / "a.json", {1: (np.float64(1.5), float("nan")), "b": np.array([np.inf, 2])})
    assert json.loads((tmp_path / "a.json").read_text()) == {"1": [1.5, None], "b": [None, 2]}


@pytest.mark.parametrize("variable", ["PZT_IDENT_CACHE", "XDG_CACHE_HOME"])
def test_a_cache_folder_that_cannot_be_written_is_replaced(variable, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("PZT_IDENT_CACHE", "")  # which the function sets, and the next tests must not have
    monkeypatch.setenv("NUMBA_CACHE_DIR", "chosen by the user")
    monkeypatch.setenv("MPLCONFIGDIR", "likewise")
    monkeypatch.setenv(variable, str(tmp_path / "file"))
    found = cache_folder.__wrapped__()
    assert found.is_dir()
    assert tmp_path not in found.parents
    assert cache_folder.__wrapped__() == found  # in a process started from here
    assert (os.environ["NUMBA_CACHE_DIR"], os.environ["MPLCONFIGDIR"]) == ("chosen by the user", "likewise")


def test_the_variable_wins_over_the_users_cache_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    monkeypatch.delenv("PZT_IDENT_CACHE", raising=False)
    assert cache_folder.__wrapped__() == tmp_path / "user/pzt_ident"
    monkeypatch.setenv("PZT_IDENT_CACHE", str(tmp_path / "chosen"))
    assert cache_folder.__wrapped__() == tmp_path / "chosen/pzt_ident"


def test_what_is_lasting_is_on_the_disk_before_it_takes_its_place(tmp_path, monkeypatch):
    done, synced, renamed = [], os.fsync, os.replace
    monkeypatch.setattr(os, "fsync", lambda file: done.append("fsync") or synced(file))
    monkeypatch.setattr(os, "replace", lambda *paths: done.append("replace") or renamed(*paths))
    write_text(tmp_path / "a", "a")
    write_text(tmp_path / "b", "b", lasting=True)
    assert done == ["replace", "fsync", "replace"]
