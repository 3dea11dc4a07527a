"""One degree of freedom."""

from math import sqrt

from pzt_ident.model.block import Block, Place
from pzt_ident.model.first_order_hold import oscillate, oscillator


class Oscillator(Block):
    """Solved exactly for f linear on each step (first-order hold), at rest at the start; prepare returns the
    coefficients of first_order_hold.oscillate."""

    place = Place.MECHANICS

    def start(u, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, u

    def step(w, v, f, u, r11, r12, r21, r22, b1, b2):
        w, v = oscillate(w, v, u - f, r11, r12, r21, r22, b1, b2)
        return w, v, u, u + w


def mode(mass, damping, stiffness, dt):
    """Coefficients of a mass on a spring and damper for first_order_hold.oscillate."""
    return oscillator(sqrt(stiffness / mass), damping / (2 * sqrt(stiffness * mass)), dt)
