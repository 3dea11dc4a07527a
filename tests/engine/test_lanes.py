"""Where compiled blocks are kept, and that a stale or half-written one is never used."""

import importlib.util
import os
import subprocess
import sys

import numpy as np
import pytest

from pzt_ident.engine import kernel, lanes, native
from pzt_ident.engine.simulator import simulate
from pzt_ident.files import cache_folder
from pzt_ident.hysteresis.bouc_wen import BoucWen
from pzt_ident.mechanics.lumped import Lumped
from pzt_ident.model.block import Bank
from pzt_ident.model.registry import blocks
from rig import candidates, model, path, record

BANKS = [word for word in blocks.words() if issubclass(blocks[word], Bank)]
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
    for module in (lanes, native):
        monkeypatch.setattr(module, "cache_folder", cache_folder.__wrapped__)
    return tmp_path / "pzt_ident"


@pytest.fixture
def uncompiled(monkeypatch):
    """Names and writes kernels, without the seconds of compiling them."""
    monkeypatch.setattr(lanes, "load", lambda path, block: type("Module", (), {"tile": None}))
    monkeypatch.setattr(native, "stands_alone", lambda function: True)
    monkeypatch.setattr(native, "emitted", lambda function: ("tile", b"code"))
    monkeypatch.setattr(native, "load", lambda symbol, code: 0)


def kernels(cache):
    return sorted(path.name for path in cache.glob("*.o"))


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
    assert len([name for name in kernels(cache) if name.startswith("times_plain_")]) == 2


def test_a_kernel_is_written_once(cache, uncompiled):
    compile_again()
    (name,) = kernels(cache)
    os.utime(cache / name, (1, 1))
    compile_again()
    assert kernels(cache) == [name]
    assert (cache / name).stat().st_mtime == 1


def test_a_damaged_kernel_is_written_again(cache, uncompiled):
    compile_again()
    (path,) = cache.glob("*.o")
    whole = path.read_bytes()
    for damaged in (whole[:-1], whole[:20], b""):
        path.write_bytes(damaged)
        compile_again()
        assert path.read_bytes() == whole


def test_name_holds_all_that_a_kernel_is_made_of(cache, uncompiled, monkeypatch, tmp_path):
    compile_again(BoucWen, driven=True)
    compile_again(BoucWen, driven=False)
    compile_again()
    monkeypatch.setattr(kernel, "VERSION", "another numba")
    compile_again()
    monkeypatch.setattr(kernel, "sources", lambda *modules: [f"{module}, edited" for module in modules])
    compile_again()
    monkeypatch.setenv("NUMBA_CPU_NAME", "another processor")
    compile_again()
    (tmp_path / "plain.jinja").write_text((lanes.TEMPLATES / "plain.jinja").read_text() + "# edited")
    monkeypatch.setattr(lanes, "TEMPLATES", tmp_path)
    compile_again()
    kinds = [name.rsplit("_", 1)[0] for name in kernels(cache)]
    assert kinds == ["boucwen_driven_operator", "boucwen_operator", *["lumped_plain"] * 5]


def test_a_write_that_fails_leaves_no_kernel(cache, uncompiled, monkeypatch):
    def fail(*names):
        raise OSError(28, "disk full")

    with monkeypatch.context() as broken:
        broken.setattr(os, "replace", fail)
        with pytest.raises(OSError, match="disk full"):
            compile_again()
    assert kernels(cache) == []
    compile_again()
    assert len(kernels(cache)) == 1


def test_kept_kernels_need_no_compiler():
    """numba takes longer to import than a short search."""
    code = "import sys, numpy as np; from rig import model, record; from pzt_ident.engine.simulator import simulate;"
    code += "from pzt_ident.mechanics.lumped import Lumped;"
    code += "simulate(model(Lumped), record(np.arange(5.0)), np.ones((1, 3))); print('numba' in sys.modules)"
    here = {"PYTHONPATH": os.pathsep.join(sys.path)}
    for _ in range(2):  # the first one compiles what is not there
        ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=os.environ | here)
    assert ran.stdout == "False\n"


@pytest.mark.parametrize("word", BANKS)
def test_a_candidate_of_a_bank_does_not_depend_on_how_many_are_beside_it(word):
    """Lanes without a candidate are left out, a vector at a time."""
    drive, made = path(0, 80, 20, 60, 0, points=40), model(word)
    theta = candidates(made, drive, kernel.WIDTH + 9, seed=0)
    together = simulate(made, record(drive), theta)
    for count in (1, 8, 9, 16, 17, kernel.WIDTH, kernel.WIDTH + 1):
        alone = simulate(made, record(drive), theta[:count])
        np.testing.assert_allclose(alone, together[:count], rtol=0, atol=1e-13 * np.abs(together).max())


def test_physics_is_declared_without_a_compiler():
    """numba and scipy take seconds to import; declarations must not need them."""
    code = "import sys, pzt_ident.model.chain; from pzt_ident.model.registry import blocks; list(blocks);"
    code += "print({'numba', 'scipy', 'jinja2', 'matplotlib'} & set(sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "set()"
