"""A piezoceramic tube, stepped exactly."""

from pzt_ident.mechanics._shell import ShellSplines
from pzt_ident.model.registry import blocks


@blocks.register
class Shell(ShellSplines):
    """R rho h u_tt = R N_x,x + N_xt,t and likewise v and w (Donnell-Mushtari), clamped at x = 0, a mass at its end.

    Smith, Hatch, De, Salapaka, del Rosario & Raye, Model Development for Atomic Force Microscope Stage Mechanisms, eq.
    24 to 29 and 43 to 44: cos(m theta) and cubic splines, whose modes are solved exactly for a field that is linear on
    each step. The field is given as the displacement that it holds at rest: along the axis for a field that is the same
    all around (m = 0), radial at theta = 0 for one as cos(m theta), which bends the tube for m = 1. Donnell's curvature
    resists even a shift of the section: the less, the thinner the wall; too stiff for m = 1 of a thick tube.
    """
