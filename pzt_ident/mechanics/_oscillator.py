"""One degree of freedom."""

from math import sqrt

from pzt_ident.model.block import Place
from pzt_ident.model.first_order_hold import oscillator
from pzt_ident.model.second_order import SecondOrder


class Oscillator(SecondOrder):
    """Of second order, in the place of the mechanics."""

    place = Place.MECHANICS


def mode(mass, damping, stiffness, dt):
    """Coefficients of a mass on a spring and damper for first_order_hold.oscillate."""
    return oscillator(sqrt(stiffness / mass), damping / (2 * sqrt(stiffness * mass)), dt)
