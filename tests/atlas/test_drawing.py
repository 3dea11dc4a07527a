"""Compact line drawings."""

import re

import numpy as np
import pytest

from pzt_ident.atlas.drawing import VISIBLE, Axis, Curve, Panel, drawing, path, thinned


def test_a_thinned_curve_is_nowhere_further_away_than_the_eye_can_see():
    x = np.linspace(0, 300, 3000)
    y = 50 * np.sin(x / 20) + 40 * np.abs((x / 30) % 2 - 1)
    kept = thinned(np.column_stack([x, y]))
    assert len(kept) < 300
    steepest = np.abs(np.gradient(y, x)).max()
    assert np.abs(np.interp(x, *kept.T) - y).max() < VISIBLE * np.hypot(1, steepest)


def test_a_path_leads_to_its_last_point():
    x, y = np.array([0.0, 10, 20, 30]), np.array([0.0, 7.3, -2.1, 4.4])
    numbers = [float(value) for value in re.findall(r"[-+]\d+\.?\d*", path(x, y))]
    assert np.cumsum(np.reshape(numbers, (-1, 2)), axis=0)[-1] == pytest.approx([30, 4.4])


def test_ticks_are_round_and_within_the_range():
    assert Axis([np.array([0.0, 7.7])], 0, 1, False).ticks(4) == [0, 2, 4, 6]
    assert Axis([np.array([100.0, 8000])], 0, 1, True).ticks(5) == [100, 1000]


def test_a_constant_curve_is_drawn_in_the_middle():
    axis = Axis([np.array([3.0, 3.0])], 0, 10, False)
    assert float(axis(np.array(3.0))) == 5


def test_a_drawing_says_what_it_shows():
    curve = Curve("with", np.array([0.0, 1]), np.array([0.0, 1]))
    svg = drawing([Panel([curve], "displacement, µm", 100)], "drive, V", "loop", "A <loop>")
    assert 'role="img"' in svg and 'aria-label="A &lt;loop&gt;"' in svg
    assert "drive, V" in svg and "displacement, µm" in svg and 'id="loop-with"' in svg
