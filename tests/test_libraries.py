"""Modules of other libraries without their packages, which are there as ever for whom needs them."""

import sys
from types import ModuleType

import numpy as np
import pytest

from pzt_ident.libraries import extension, modules


@pytest.fixture
def package(tmp_path, monkeypatch):
    (tmp_path / "heavy").mkdir()
    (tmp_path / "heavy/__init__.py").write_text("from heavy import part\nloaded = True\n")
    (tmp_path / "heavy/part.py").write_text("from heavy.other import answer\n")
    (tmp_path / "heavy/other.py").write_text("answer = 42\n")
    monkeypatch.syspath_prepend(tmp_path)
    yield "heavy"
    for name in ("heavy", "heavy.part", "heavy.other"):
        sys.modules.pop(name, None)


def test_a_module_is_there_and_its_package_is_as_it_was(package):
    part, other = modules("heavy.part", "heavy.other")
    assert (part.answer, other.answer) == (42, 42)
    assert not any(name.startswith("heavy") for name in sys.modules)
    import heavy

    assert heavy.loaded
    assert heavy.part.answer == 42


def test_a_package_that_was_imported_stays_and_a_module_stands_in_for_another(package):
    import heavy

    other = ModuleType("heavy.other")
    other.answer = 43
    (part,) = modules("heavy.part", beside=other)
    assert part.answer == 43
    assert sys.modules["heavy"] is heavy
    assert sys.modules["heavy.part"].answer == heavy.part.answer == 42


def test_an_extension_is_there_without_its_package():
    lapack = extension("scipy.linalg", "_flapack")
    triangle, *_, failed = lapack.dtpqrt(0, 1, np.eye(2, order="F"), np.ones((3, 2), order="F"))
    assert not failed
    np.testing.assert_allclose(np.abs(np.triu(triangle).T @ np.triu(triangle)), np.eye(2) + 3)
    assert extension("scipy.linalg", "_flapack") is lapack
    from scipy.linalg.lapack import dtpqrt

    assert dtpqrt(0, 1, np.eye(2, order="F"), np.ones((3, 2), order="F"))[0].tolist() == triangle.tolist()
