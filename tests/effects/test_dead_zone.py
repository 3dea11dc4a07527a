"""An amplifier with a dead zone."""

import numpy as np

from rig import path, response

WIDTH, CENTRE = 1.5, 42.0  # V


def dead(u):
    return np.where(u > CENTRE, np.maximum(u - WIDTH, CENTRE), np.minimum(u + WIDTH, CENTRE))


def test_the_output_stands_still_in_the_zone_and_follows_beside_it():
    u = path(0, 100, -100, 60, points=77)
    known = {"dead_zone.width": WIDTH, "dead_zone.centre": CENTRE}
    np.testing.assert_allclose(response(["dead_zone"], known, u), dead(u), rtol=0, atol=1e-12)
