"""Modes of a stage that all its axes drive and that move all its axes."""

from math import pi

from pzt_ident.mechanics._oscillator import Oscillator
from pzt_ident.model.block import Modes
from pzt_ident.model.first_order_hold import oscillator
from pzt_ident.model.parameter import Parameter, Setting
from pzt_ident.model.registry import blocks


@blocks.register
class Modal(Oscillator, Modes):
    """y_a = sum_i shape_ai q_i,  q_i'' / w_i^2 + 2 damping_i q_i' / w_i + q_i = sum_b push_bi f_b.

    Several inputs and outputs (Preumont 2011, Vibration Control of Active Structures, ch. 2); exact for f linear on
    each step. Sensors and actuators may be at different places. Modes are scaled so that the first axis drives each of
    them with its f. The shapes contain the static gains, so the gain of the operator must be
    fixed: beside a gain of 1 um/V a shape of 0.08 moves the axis by 0.08 um/V. Fix it near the gain of the stage, so
    that the shapes are near 1: with readings in nm at 100 nm/V, say.
    """

    modes = Setting(2, (1, 100), "Modes of the stage.")
    weights = ("push", "shape")
    frequency = Parameter("Hz", (10, 2e4), "Natural frequency of the mode.", scale="log", count="modes", per="stage")
    damping = Parameter("1", (1e-3, 0.5), "Damping ratio of the mode.", scale="log", count="modes", per="stage")
    push = Parameter("1", (-5, 5), "Force on the mode over that of the first axis.", count="modes", per="later axis")
    shape = Parameter("1", (-5, 5), "Displacement of the axis over that of the mode.", count="modes")

    def prepare(frequency, damping, dt):
        return oscillator(2 * pi * frequency, damping, dt)
