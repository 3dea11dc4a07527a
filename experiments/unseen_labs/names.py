"""The names of all campaigns: each module enters its own when it is imported."""

from . import (
    nothing,
    outside_records,
    outside_stage,
    pairs,
    pairs_axes,
    singles_amplifier,
    singles_axes,
    singles_hysteresis,
    singles_mechanics,
    singles_memory,
    singles_sensor,
    singles_stroke,
)
from .campaign import CAMPAIGNS

MODULES = (
    singles_hysteresis,
    singles_memory,
    singles_stroke,
    singles_mechanics,
    singles_axes,
    singles_amplifier,
    singles_sensor,
    pairs,
    pairs_axes,
    nothing,
    outside_stage,
    outside_records,
)
NAMES = sorted(CAMPAIGNS)
