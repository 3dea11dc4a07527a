"""Free weights of the plays against the density that made the data."""

import numpy as np
import pytest

import smith
from pzt_ident.densities import density_of, plays
from pzt_ident.errors import InputError
from rig import path, record, response
from twins.homogenized_energy_twin import quantiles
from twins.prandtl_ishlinskii_twin import play

FIELD = path(0, 8000, 0, 6000, 1000, 5000, 2000, 4000, 0, 3000, points=60)
NOISE = 1e-7
NODES = np.sort(2400 * np.exp(0.887 * quantiles(64)))


@pytest.fixture(scope="module")
def measured():
    y = response(["homogenized_energy"], smith.A, FIELD)
    return record(FIELD, response=[y + np.random.default_rng(4).normal(0, NOISE, y.size)])


def test_plays_of_all_nodes():
    found = plays(FIELD, NODES, 3000.0)
    expected = np.array([play([3000.0, *FIELD], half)[1:] for half in NODES]).T
    np.testing.assert_array_equal(found, expected)


def test_the_residual_is_the_noise_at_the_true_interaction(measured):
    found = density_of([measured], NODES, (2000, 20000), poled=1e6)
    assert found.interaction == pytest.approx(6120, rel=0.05)
    assert found.rmse == pytest.approx(NOISE, rel=0.06)
    wrong = [density_of([measured], NODES, (width, 1.001 * width), poled=1e6).rmse for width in (3000, 12000)]
    assert min(wrong) > 1.3 * NOISE


def test_nodes_that_no_record_moved_are_said_to_be(measured):
    """From the poled state they move up to half the span of the field, 4 kV/m."""
    found = density_of([measured], NODES, (4000, 9000), poled=1e6)
    np.testing.assert_array_equal(found.unmoved, NODES[NODES >= 4000])
    assert np.isfinite(found.weights[NODES < 4000]).all()


def test_a_smooth_density_is_the_true_one_on_average(measured):
    """Single weights scatter; with the prior the mass of the moved nodes is right to some percent, and smooth."""
    rough, smooth = (density_of([measured], NODES, (6119, 6121), s, poled=1e6) for s in (0.0, 1e-3))
    true = smith.REMANENCE / 64
    assert np.nanmean(smooth.weights) == pytest.approx(true, rel=0.1)
    assert np.nanstd(smooth.weights) < 0.5 * np.nanstd(rough.weights)
    assert smooth.rmse < 1.3 * NOISE
    assert smooth.gain == pytest.approx(1 / smith.ETA, rel=0.05)


def test_a_drive_in_the_linear_range_is_refused(measured):
    with pytest.raises(InputError, match="moves no play"):
        density_of([measured], 1e3 * NODES, (4000, 9000), poled=1e9)
