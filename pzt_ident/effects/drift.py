"""Thermal drift of stage, frame and sensor."""

import numpy as np

from pzt_ident.model.block import Addition, Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class Drift(Addition):
    """Stage and frame warm up and expand, whatever the drive: y = x + size (1 - exp(-t / tau)), t from the start.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems. Nearly a ramp for a long tau.
    """

    place = Place.OUTPUT
    size = Parameter("response", (-1, 1), "Final drift of a record.", null=0, per_record=True)
    tau = Parameter("s", (10, 3000), "Thermal time constant.", scale="log")
    look_alikes = ("creep", "thermal_relaxation")
    separate_by = (
        "Record at a constant voltage that has rested for as long before: drift shows there too, creep and relaxation "
        "do not."
    )
    remedy = "Let the rig warm up, shield it from draughts, and re-zero it before and after each record."

    def basis(t, tau):
        return (-np.expm1(-t / tau),)
