"""Run folders that several tests read."""

from pathlib import Path

import pytest

from run_folders import WEIRD, make_run


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
    """The atlas of all words, as the command writes it."""
    from click.testing import CliRunner

    from pzt_ident.cli.commands import main

    path = tmp_path_factory.mktemp("atlas") / "atlas.html"
    ran = CliRunner().invoke(main, ["atlas", "-o", str(path)])
    assert ran.output == f"atlas: {path}\n"
    return path
