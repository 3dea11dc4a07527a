"""Case III on the stage: the bands that were published and derived, and the README that shows them."""

from pathlib import Path

import numpy as np
import pytest

from experiments.case_3 import tracking
from experiments.case_3.loop import facts

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def bands():
    return {name: tracking.band(run.error) for name, run in tracking.runs().items()}


def test_open_loop_is_that_of_table_7(bands):
    assert bands["open loop"] == pytest.approx(np.array([[-1.10, 0.64], [-0.28, 0.77]]), abs=0.01)


def test_eq_23_leaves_the_coupling(bands):
    assert bands["feedforward, eq. 23"] == pytest.approx(np.array([[-0.47, 0.01], [-0.01, 0.55]]), abs=0.01)
    assert bands["feedforward, eq. 23"] == pytest.approx(tracking.band(tracking.uncompensated()), abs=0.015)


def test_decoupling_and_pi_leave_a_hundredth_and_three_of_a_micrometre(bands):
    assert np.abs(bands["feedforward with decoupling"]).max() < 0.014
    assert np.abs(bands["feedforward and PI"]).max() < 0.03


def test_published_gains_on_the_published_stage():
    assert facts("x") == ["5.78", "27.1", "22.4", "0.975", "1.2e-09", "8e+09"]
    assert facts("y")[:4] == ["3.09", "20.4", "13.6", "0.950"]


@pytest.mark.parametrize("name", ["case_3", "case_4"])
def test_the_readme_shows_the_tables(name):
    printed = (ROOT / "results" / "reference" / name / "tracking.md").read_text(encoding="utf-8").strip()
    assert printed in (ROOT / "experiments" / name / "README.md").read_text(encoding="utf-8")
