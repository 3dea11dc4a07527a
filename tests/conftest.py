"""Run folders that several tests read."""

import gc
import os
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy: on small matrices its threads wait for each other

import pytest

from run_folders import WEIRD, make_run


def pytest_collection_finish():
    """What 6,000 tests are made of is no garbage, and need not be looked through again and again; and who works on them
    has one core, on which threads wait for each other."""
    from pzt_ident.diagnosis import threads

    gc.freeze()
    gc.set_threshold(20_000)
    threads.THREADS = 1


@pytest.fixture(scope="session")
def plain(tmp_path_factory) -> Path:
    """One axis, two records, three optimizers."""
    return make_run(tmp_path_factory.mktemp("plain"))


@pytest.fixture(scope="session")
def weird(tmp_path_factory) -> Path:
    """Two axes, no validate record, one optimizer, one repeat, unknown noise, a failed run, markup in names."""
    return make_run(
        tmp_path_factory.mktemp("weird"),
        axes=("x", "y"),
        names=(WEIRD,),
        uses=("identify",),
        optimizers=("pso",),
        repeats=1,
        noise_floor=None,
        failed=(("rga-0", "worker killed by <signal> 9"),),
    )


@pytest.fixture(scope="session")
def long(tmp_path_factory) -> Path:
    """Two records of 20,000 samples, six optimizers."""
    optimizers = ("pso", "rga", "csa", "cma_es", "differential_evolution", "least_squares")
    return make_run(tmp_path_factory.mktemp("long"), samples=20_000, repeats=5, optimizers=optimizers)


@pytest.fixture(scope="session")
def atlas_page(tmp_path_factory):
    """The atlas of all words, as the command writes it: once for all workers, since it takes ten seconds."""
    from click.testing import CliRunner
    from locket import lock_file

    from pzt_ident.cli.commands import main

    folder = tmp_path_factory.getbasetemp()
    path = (folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder) / "atlas.html"
    with lock_file(str(path.with_suffix(".lock"))):
        if not path.exists():
            ran = CliRunner().invoke(main, ["atlas", "-o", str(path)])
            assert ran.output == f"atlas: {path}\n"
    return path
