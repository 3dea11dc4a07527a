"""A piezoceramic tube, stepped exactly."""

from pzt_ident.mechanics._shell import ShellSplines
from pzt_ident.model.registry import blocks


@blocks.register
class Shell(ShellSplines):
    """R rho h u_tt = R N_x,x + N_xt,t and likewise v and w (Donnell-Mushtari), clamped at x = 0, a mass at its end.

    Smith, Hatch, De, Salapaka, del Rosario & Raye, Model Development for Atomic Force Microscope Stage Mechanisms, eq.
    24 to 29 and 43 to 44: cos(m theta) and cubic splines, whose modes are solved exactly for a field that is linear on
    each step. The input f is the static displacement under the field: axial for a uniform field (m = 0), radial at
    theta = 0 for a field of cos(m theta), which bends the tube for m = 1. Donnell's curvature resists even a shift of
    the cross section, less so for a thin wall; a thick tube is too stiff for m = 1.
    """
