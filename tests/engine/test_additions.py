"""Sums of squares with additions, gathered tile by tile, against the errors that are left."""

import numpy as np
import pytest

from pzt_ident.engine.simulator import Simulator
from rig import model, record

BLOCKS = ("prandtl_ishlinskii", "drift", "periodic_disturbance.harmonics")
rng = np.random.default_rng(4)


def waves(samples=333, axes=1):
    return [np.sin(np.arange(samples) * (0.1 + 0.03 * axis)) for axis in range(axes)]


def candidates(made, count=30):
    low = {"tau": 0.01, "frequency": 5.0}
    return np.array([[low.get(entry.word, 0.1) * rng.uniform(1, 9) for entry in made.entries] for _ in range(count)])


def summed(simulator, theta):
    return np.square(simulator.errors(theta)[:, :, simulator.record.settle :]).sum(axis=2)


@pytest.mark.parametrize(
    ("axes", "more"), [(1, {}), (1, {"settle": 70, "run_in": 2}), (2, {"settle": 3}), (1, {"start": 5})]
)
def test_squares_are_those_of_the_errors(axes, more):
    made = model(*BLOCKS, axes=axes)
    measured = record(*waves(axes=axes), response=rng.normal(size=(axes, 333)), **more)
    simulator, theta = Simulator(made, measured), candidates(made)
    np.testing.assert_allclose(simulator.squares(theta), summed(simulator, theta), rtol=1e-9)


def test_a_fit_to_the_last_digits_has_these():
    """Rounding would leave none of them in a difference of sums."""
    made = model(*BLOCKS)
    theta, t = candidates(made, 3), 1e-3 * np.arange(333)
    clean = Simulator(made, record(*waves())).simulate(theta[1])[0]
    added = 7 + 3 * np.exp(-t / theta[1][made.names.index("drift.tau")]) + 1e-8 * rng.normal(size=333)
    simulator = Simulator(made, record(*waves(), response=clean + added))
    found = simulator.squares(theta)
    np.testing.assert_allclose(found, summed(simulator, theta), rtol=1e-7)
    assert found[1, 0] < 1e-15 * found[0, 0]


def test_a_signal_that_is_nearly_the_offset_takes_part():
    """A drift that is over after the first samples."""
    made = model("prandtl_ishlinskii", "drift")
    simulator = Simulator(made, record(*waves(), response=rng.normal(size=(1, 333)), settle=1))
    theta = candidates(made)
    theta[:, made.names.index("drift.tau")] = 10.0 ** rng.uniform(-5, -3, 30)
    np.testing.assert_allclose(simulator.squares(theta), summed(simulator, theta), rtol=1e-7)


def test_a_candidate_that_fails_has_no_sum():
    made = model(*BLOCKS)
    theta = candidates(made)
    theta[4, made.names.index("drift.tau")] = np.nan
    found = Simulator(made, record(*waves())).squares(theta)
    assert np.isnan(found).ravel().tolist() == [i == 4 for i in range(30)]
