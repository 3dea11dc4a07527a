"""Every module of an experiment is one that the package of today can run."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parents[2] / "experiments"
MODULES = [path for path in sorted(HERE.glob("*/*.py")) if path.stem != "__main__"]


@pytest.fixture
def imported(monkeypatch):
    """Gives the module of a path, with those beside it under their own names, as where it is run."""
    folders = []

    def module(path):
        folders.append(path.parent)
        monkeypatch.syspath_prepend(path.parent)
        return importlib.import_module(f"experiments.{path.parent.name}.{path.stem}")

    yield module
    for path in (path for folder in folders for path in folder.glob("*.py")):
        if getattr(sys.modules.get(path.stem), "__file__", None) == str(path):
            del sys.modules[path.stem]


@pytest.mark.parametrize("path", MODULES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_it_is_imported(path, imported):
    assert imported(path).__doc__


def test_the_roof_is_measured_by_kernels_that_do_what_they_say(imported):
    roof = imported(HERE / "performance" / "roofline.py")
    scratch = np.repeat([0.5, 0.25], roof.WIDTH)
    tile = np.ones(roof.TILE * roof.WIDTH)
    roof.repeat(roof.memory.address, 3, scratch, tile)
    assert (tile == 4).all()
    roof.repeat(roof.arithmetic.address, 1, scratch, tile)  # a <- a / 2 + 1 / 4, which ends at 1 / 2
    np.testing.assert_allclose(tile[: roof.CHAINS * roof.WIDTH], 0.5, rtol=1e-12)
    assert (tile[roof.CHAINS * roof.WIDTH :] == 4).all()
