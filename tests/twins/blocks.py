"""Blocks that only tests use."""

from pzt_ident.model.block import Block, Coupling, Place
from pzt_ident.model.parameter import Parameter


class Identity(Block):
    """y = u, without state or parameter."""

    name = "identity"
    place = Place.AMPLIFIER

    def prepare():
        return ()

    def start(u):
        return ()

    def step(u):
        return u


class Turn(Coupling):
    """y_a = u_a + sum_b size_ab u_a u_b: tells the order of its arguments and of the pairs."""

    name = "turn"
    place = Place.COUPLING
    size = Parameter("1/drive", (-1, 1), "Of the product with the other axis.", null=0)

    def prepare(size):
        return (size,)

    def start(y, other, size):
        return ()

    def step(y, other, size):
        return y + size * y * other


class Relative(Block):
    """y = u T / s, T the sample time and s the span of the axis' drive."""

    name = "relative"
    place = Place.AMPLIFIER

    def prepare(dt, span):
        return dt, span

    def start(u, dt, span):
        return ()

    def step(u, dt, span):
        return u * dt / span
