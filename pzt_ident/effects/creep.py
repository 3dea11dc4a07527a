"""Creep of the ceramic: slow domains follow the prompt ones."""

from pzt_ident.model.block import Bank, Place
from pzt_ident.model.first_order_hold import decay
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks

BRANCHES = 10


ELEMENTS = 3


class Creeping:
    """What all forms of creep declare."""

    form = Form("spread", ("spread", "voltage", "elements", "voltage_elements"), "Which time constants, and of what.")
    look_alikes = ("thermal_relaxation", "drift", "amplitude_gain", "sensor_lag", "delay")
    separate_by = "Step up and hold, step down and hold, back by 5 % and hold, then a null record at constant voltage."
    remedy = "Wait after large steps, or add the identified creep to the feedforward."

    def start(u, weight, keep, share):
        return 0.0, u, u

    def step(w, before, first, u, weight, keep, share):
        w = keep * w - share * (u - before)
        return w, u, first, weight * (u - first + w)

    def output(u, total, weight, keep, share):
        return u + total


@blocks.register
class Creep(Creeping, Bank):
    """Domains go on switching after a change: y = f + sum_i x_i,  tau_i dx_i/dt + x_i = ratio / 10 (f - f(0)).

    Croft, Shed & Devasia (2001), J. Dyn. Syst. Meas. Control 123, 35. The time constants are spaced evenly on a
    logarithmic scale over `decades` around tau: a single Kelvin-Voigt element for 0 decades, nearly a logarithm of time
    for many. Each of the ten elements has a tenth of `ratio`.
    """

    place = Place.CREEP
    branches = BRANCHES
    ratio = Parameter("1", (-0.1, 0.4), "Final creep over the prompt response.", null=0)
    tau = Parameter("s", (0.01, 1000), "Geometric centre of the time constants.", scale="log")
    decades = Parameter("1", (0, 7), "Decades over which the time constants are spread.", end=0)

    def prepare(ratio, tau, decades, branch, dt):
        branch_tau = tau * 10 ** (decades * ((branch + 0.5) / BRANCHES - 0.5))
        return ratio / BRANCHES, *decay(branch_tau, dt)


class OfVoltage(Creep):
    """The prompt part alone creeps, the hysteretic part does not: y = d (u + sum_i x_i) - h, tau_i dx_i/dt + x_i =
    ratio / 10 (u - u(0)).

    Croft, Shed & Devasia (2001), whose creep is a linear model of the voltage.
    """

    place = Place.READOUT


class Elements(Creeping, Bank):
    """Three Kelvin-Voigt elements, each with its own ratio and time constant: y = f + sum_i x_i,
    tau_i dx_i/dt + x_i = ratio_i (f - f(0)).

    Croft, Shed & Devasia (2001), J. Dyn. Syst. Meas. Control 123, 35.
    """

    place = Place.CREEP
    branches = ELEMENTS
    ratio = Parameter("1", (-0.1, 0.4), "Final creep of the i-th element over the response.", null=0, count=ELEMENTS)
    fastest = Parameter("s", (0.001, 100), "Shortest time constant.", scale="log")
    spacing = Parameter("1", (2, 100), "Ratio of successive time constants.", scale="log")
    trials = {"fastest": 8, "spacing": 2}

    def prepare(ratio, fastest, spacing, branch, dt):
        return ratio, *decay(fastest * spacing**branch, dt)


class ElementsOfVoltage(Elements):
    """Three Kelvin-Voigt elements of the prompt part alone: y = d (u + sum_i x_i) - h, tau_i dx_i/dt + x_i =
    ratio_i (u - u(0)).

    Croft, Shed & Devasia (2001).
    """

    place = Place.READOUT


Creep.forms = {"voltage": OfVoltage, "elements": Elements, "voltage_elements": ElementsOfVoltage}
