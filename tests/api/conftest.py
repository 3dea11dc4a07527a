"""The measurement that ships, as a user of the library has it: arrays, and fits of them."""

from importlib.resources import files

import numpy as np
import pytest
from click.testing import CliRunner

import pzt_ident as pzt
from pzt_ident.cli.commands import main
from pzt_ident.job.demo import write_demo

DEMO = files("pzt_ident.job").joinpath("examples", "demo")
SMALL = {"name": "pso", "population": 20, "generations": 15}


def columns(name):
    """Time in s, drive in V and response in um of a record of the demo."""
    with DEMO.joinpath(f"{name}.csv").open() as file:
        return np.loadtxt(file, delimiter=",", skiprows=1, unpack=True)


@pytest.fixture(scope="session")
def demo():
    return columns("identify"), columns("validate")


@pytest.fixture(scope="session")
def part(demo):
    """A stretch of it that is fitted in a moment."""
    return tuple(column[:700] for column in demo[0])


@pytest.fixture(scope="session")
def fit(demo):
    train, test = (pzt.Record(*record) for record in demo)
    optimizer = {"name": "pso", "population": 70, "generations": 150}
    return pzt.identify("bouc_wen", train, validate=test, optimizer=optimizer, seed=7)


@pytest.fixture(scope="session")
def improvement(fit):
    return pzt.improve(fit)


@pytest.fixture(scope="session")
def commanded(tmp_path_factory):
    """The folder that the command makes of the job of the demo, which lies elsewhere."""
    home, out = tmp_path_factory.mktemp("demo") / "deep" / "in" / "a" / "folder", tmp_path_factory.mktemp("improved")
    line = ["improve", str(write_demo(home)), "--out", str(out), "--no-report", "--quiet"]
    answer = CliRunner().invoke(main, line)
    assert answer.exit_code == 0, answer.output
    return out


@pytest.fixture(scope="session")
def quick(part):
    """A fit of a record, or of what makes one."""

    def identified(*record, model="bouc_wen", seed=3, **units):
        given = record[0] if record and isinstance(record[0], pzt.Record) else pzt.Record(*(record or part), **units)
        return pzt.identify(model, given, optimizer=SMALL, seed=seed)

    return identified
