"""One degree of freedom under a force."""

from pzt_ident.model.block import Block
from pzt_ident.model.first_order_hold import oscillate


class SecondOrder(Block):
    """x'' / omega^2 + 2 zeta x' / omega + x = f, solved exactly for f linear on each step, at rest at the start.

    `prepare` returns the coefficients of first_order_hold.oscillate.
    """

    def start(u, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, u

    def step(w, v, f, u, r11, r12, r21, r22, b1, b2):
        w, v = oscillate(w, v, u - f, r11, r12, r21, r22, b1, b2)
        return w, v, u, u + w
