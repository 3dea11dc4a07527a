"""Weighted plays: their twin, and the memory that tells them from Bouc-Wen."""

from math import log

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pzt_ident.hysteresis.prandtl_ishlinskii import PLAYS
from rig import path, response
from twins import prandtl_ishlinskii_twin

WEIGHTS = np.array([0.02, 0.015, 0.01, 0.012, 0.004, 0.006, 0.003, 0.002])
HALF_WIDTHS = 60 * np.arange(1, PLAYS + 1) / PLAYS
levels = st.lists(st.floats(-20, 150), min_size=2, max_size=12)
quick = settings(deadline=None, max_examples=30, derandomize=True)


def displacement(drive, weights=WEIGHTS, gain=0.05, dt=1e-3, **effects):
    names = [f"prandtl_ishlinskii.weight_{i + 1}" for i in range(PLAYS)]
    known = dict(zip(names, weights, strict=True))
    known |= {"prandtl_ishlinskii.gain": gain, "prandtl_ishlinskii.reach": HALF_WIDTHS[-1]}
    known |= {f"prandtl_ishlinskii.{word}": value for word, value in effects.items()}
    return response(["prandtl_ishlinskii"], known, np.asarray(drive, float), dt=dt)


@given(levels=levels, points=st.integers(1, 30))
@quick
def test_plays_in_a_loop(levels, points):
    drive = path(*levels, points=points)
    expected = prandtl_ishlinskii_twin.prandtl_ishlinskii(drive, 0.05, WEIGHTS, HALF_WIDTHS)
    np.testing.assert_allclose(displacement(drive), expected, rtol=0, atol=1e-13)


def test_virgin_curve():
    """A drive that only rises moves each play once it has taken up its half-width."""
    drive = np.linspace(0, 150, 301)
    expected = 0.05 * drive + np.maximum(drive[:, None] - HALF_WIDTHS, 0) @ WEIGHTS
    np.testing.assert_allclose(displacement(drive), expected, rtol=0, atol=1e-13)


def test_one_play_makes_a_parallelogram():
    """Width 2 r w all along the settled loop, but for the 2 r after a reversal."""
    drive = path(0, *[100, 0] * 2, points=100)
    y = displacement(drive, weights=np.eye(PLAYS)[1], gain=0.0)
    rising, falling = y[200:301], y[300:][::-1]
    assert HALF_WIDTHS[1] == 15
    np.testing.assert_allclose((falling - rising)[30:71], 30, atol=1e-12)
    assert falling[0] - rising[0] == falling[-1] - rising[-1] == 0


def test_nested_loops_close_exactly():
    visits = displacement(path(0, 130, 60, 80, *[60, 80] * 4))[::100][3::2]
    assert np.all(np.diff(visits) == 0)
    rising = displacement(path(0, 130, 0, 100, *[90, 100] * 6))[::100]
    assert rising[-1] == rising[3]


@given(levels=levels, inner=st.lists(st.floats(0, 1), min_size=1, max_size=6))
@quick
def test_a_closed_excursion_is_forgotten(levels, inner):
    """Return-point memory: what happens between a turning point and the way back to it leaves no trace."""
    low, high = sorted(levels[-2:])
    excursion = [low + share * (high - low) for share in inner]
    found = displacement([*levels, *excursion, levels[-2], levels[-1], 150, -20])
    np.testing.assert_array_equal(found[-3:], displacement([*levels, 150, -20])[-3:])


@given(levels=levels)
@quick
def test_the_largest_drive_wipes_out_what_was_before(levels):
    np.testing.assert_array_equal(displacement([*levels, 300, 20, 90])[-3:], displacement([0, 300, 20, 90])[-3:])


def test_equal_loops_at_every_bias_are_congruent():
    loops = [displacement(path(0, *[bias + 40, bias] * 2))[-201:] for bias in (0, 20, 90)]
    for loop in loops:
        np.testing.assert_allclose(loop - loop[0], loops[0] - loops[0][0], rtol=0, atol=1e-13)


def test_linear_in_the_weights():
    drive, other = path(0, 130, 20, 90, -20, 5), WEIGHTS[::-1]
    together = displacement(drive, 2 * WEIGHTS - other, 0.0)
    apart = 2 * displacement(drive, gain=0.0) - displacement(drive, other, 0.0)
    np.testing.assert_allclose(together, apart, rtol=0, atol=1e-13)


def test_rate_does_not_matter_and_the_sign_changes_all():
    drive = path(0, 130, 20, 90, -20, 5)
    np.testing.assert_array_equal(displacement(drive.repeat(3))[2::3], displacement(drive))
    np.testing.assert_allclose(displacement(-drive), -displacement(drive), rtol=0, atol=1e-13)


@pytest.mark.parametrize("start", [0.0, 5.0, 40.0, -40.0])
def test_starts_virgin_under_the_first_sample(start):
    first = start * 0.05 + np.sign(start) * (np.maximum(abs(start) - HALF_WIDTHS, 0) @ WEIGHTS)
    assert displacement([start, start]) == pytest.approx([first, first], abs=1e-14)


@pytest.mark.parametrize("speed", [5.0, 100.0, 4000.0])
@pytest.mark.parametrize(
    ("effects", "wider"),
    [
        ({"rate": 0.1}, lambda v: 0.1 * np.log10((v + 0.01) / 100.01)),
        ({"rate": 0.1, "onset": 30.0}, lambda v: 0.1 * np.log10(1 + v / 30)),
        ({"rate": 0.1, "exponent": 1.0}, lambda v: 0.1 * v / (100.01 * log(10))),
        ({"rate": -0.2, "onset": 30.0}, lambda v: max(-0.2 * np.log10(1 + v / 30), -0.99)),
    ],
)
def test_half_widths_grow_with_the_rate(speed, effects, wider):
    """At one rate of the drive the plays are those of other half-widths: Al Janaideh & Krejci (2013)."""
    levels = [0, 130, 20, 90, -20, 5]
    drive = np.interp(np.arange(0, 445.5, 0.5), np.cumsum(np.abs(np.diff(levels, prepend=0))), levels)
    found = displacement(drive, dt=0.5 / speed, **effects)
    expected = prandtl_ishlinskii_twin.prandtl_ishlinskii(drive, 0.05, WEIGHTS, HALF_WIDTHS * (1 + wider(speed)))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10)
