"""One degree of freedom."""

from pzt_ident.model.block import Place
from pzt_ident.model.second_order import SecondOrder


class Oscillator(SecondOrder):
    """Of second order, in the place of the mechanics."""

    place = Place.MECHANICS
