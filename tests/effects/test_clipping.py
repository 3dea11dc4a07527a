"""An amplifier whose supply ends before the command."""

import numpy as np

from rig import path, response

SUPPLY = 88.0  # V, of drives up to 100 V


def test_the_output_stays_within_the_supply_at_both_ends():
    u = path(0, 100, -100, 30, points=40)
    np.testing.assert_allclose(response(["clipping"], {"clipping.rail": 1 / SUPPLY}, u), np.clip(u, -SUPPLY, SUPPLY))
