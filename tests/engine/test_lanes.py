"""Where compiled blocks are kept, and that a stale or half-written one is never used."""

import importlib.util
import inspect
import os
import subprocess
import sys

import numpy as np
import pytest

from pzt_ident.engine import kernel, lanes
from pzt_ident.engine.simulator import simulate
from pzt_ident.files import cache_folder
from pzt_ident.hysteresis.bouc_wen import BoucWen
from pzt_ident.mechanics.lumped import Lumped
from rig import model, record

AUTHOR = """
from pzt_ident.model.block import Block, Place


class Times(Block):
    name = "times"
    place = Place.CREEP

    def prepare():
        return ()

    def start(u):
        return ()

    def step(u):
        return scaled(u)


def scaled(u):
    return {factor} * u
"""


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty cache folder for the time of a test."""
    monkeypatch.setenv("PZT_IDENT_CACHE", str(tmp_path))
    monkeypatch.setattr(lanes, "cache_folder", cache_folder.__wrapped__)
    return tmp_path / "pzt_ident"


@pytest.fixture
def uncompiled(monkeypatch):
    """Names and writes kernels, without the seconds of compiling them."""
    tile = type("Tile", (), {"address": 0})
    monkeypatch.setattr(lanes, "load", lambda path, block: type("Module", (), {"tile": tile}))


def kernels(cache):
    return sorted(path.name for path in cache.glob("*.py"))


def compile_again(block=Lumped, **variant):
    return lanes.compile_block.__wrapped__(block, lanes.Variant(**variant))


def author(path, factor):
    """The block of an author's file, read afresh."""
    path.write_text(AUTHOR.format(factor=factor))
    spec = importlib.util.spec_from_file_location(f"author_{factor}", path)
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.Times


def test_an_edited_block_is_compiled_anew(cache, tmp_path):
    drive = np.arange(5.0)
    for factor in (2, 3):
        block = author(tmp_path / f"times_{factor}.py", factor)
        found = simulate(model(block), record(drive), np.zeros((1, 0)))
        assert found[0, 0].tolist() == (factor * drive).tolist()
    assert len(kernels(cache)) == 2
    assert all(name.startswith("times_plain_") for name in kernels(cache))


def test_a_kernel_is_written_once(cache, uncompiled):
    compile_again()
    (name,) = kernels(cache)
    os.utime(cache / name, (1, 1))
    compile_again()
    assert kernels(cache) == [name]
    assert (cache / name).stat().st_mtime == 1


def test_name_holds_all_that_a_kernel_is_made_of(cache, uncompiled, monkeypatch, tmp_path):
    compile_again(BoucWen, driven=True)
    compile_again(BoucWen, driven=False)
    compile_again()
    monkeypatch.setattr(kernel, "VERSION", "another numba")
    compile_again()
    edited = tmp_path / "kernel.py"
    edited.write_text(inspect.getsource(kernel) + "# edited")
    monkeypatch.setattr(kernel, "__file__", str(edited))
    compile_again()
    (tmp_path / "plain.jinja").write_text((lanes.TEMPLATES / "plain.jinja").read_text() + "# edited")
    monkeypatch.setattr(lanes, "TEMPLATES", tmp_path)
    compile_again()
    kinds = [name.rsplit("_", 1)[0] for name in kernels(cache)]
    assert kinds == ["boucwen_driven_operator", "boucwen_operator", *["lumped_plain"] * 4]


def test_a_write_that_fails_leaves_no_kernel(cache, uncompiled, monkeypatch):
    def fail(*names):
        raise OSError("disk full")

    with monkeypatch.context() as broken:
        broken.setattr(os, "replace", fail)
        with pytest.raises(OSError, match="disk full"):
            compile_again()
    assert kernels(cache) == []
    compile_again()
    assert len(kernels(cache)) == 1


def test_physics_is_declared_without_a_compiler():
    """numba and scipy take seconds to import; declarations must not need them."""
    code = "import sys, pzt_ident.model.chain; from pzt_ident.model.registry import blocks; list(blocks);"
    code += "print({'numba', 'scipy', 'jinja2', 'matplotlib'} & set(sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "set()"
