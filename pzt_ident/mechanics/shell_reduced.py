"""A piezoceramic tube, reduced."""

from pzt_ident.mechanics._balanced import Balanced, balanced
from pzt_ident.mechanics._shell import ShellData, matrices
from pzt_ident.model.parameter import Setting
from pzt_ident.model.registry import blocks


@blocks.register
class ShellReduced(ShellData, Balanced):
    """`shell` by a few balanced sections: max |G - G_r| <= 2 sum sigma_i over the Hankel singular values left out.

    Glover (1984), Int. J. Control 39, 1115; Liu & Anderson (1989), Int. J. Control 50, 1379. Exact at rest. The
    balancing takes some ms per candidate if parameters of the shell are searched, and none if they are fixed.
    """

    elements = Setting(12, (4, 60), "Cubic spline elements along the shell that are reduced.")
    harmonic = Setting(0, (0, 20), "Waves of the field around the shell: 0 lengthens it, 1 bends it.")

    def solve(shell):
        return balanced(shell.order, *matrices(shell))[0]
