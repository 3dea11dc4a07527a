"""One sound class of each kind, as its author would write it, for tests to break."""

HEAD = """
from dataclasses import dataclass, field
from math import exp, pi
import numpy as np
from pzt_ident.model.block import Addition, Bank, Beside, Block, Coupling, Modes, Operator, Place
from pzt_ident.model.block import Relays, Shift, Term, sin
from pzt_ident.model.parameter import Form, Parameter, Setting
from pzt_ident.model.optimizer import Budgeted, Generational, Optimizer, choice, setting
"""
GAIN = '''
class Gain(Block):
    """y = u + bend (u^2 + w)."""

    place = Place.READOUT
    bend = Parameter("1/drive", (0, 1), "Growth of the gain.", null=0)
    tau = Parameter("s", (1e-3, 1), "Time constant.", scale="log")
    look_alikes = ("saturation",)
    separate_by = "Drive to both polarities."
    remedy = "Linearise the drive."

    def prepare(bend, tau, dt):
        return bend, dt / tau

    def start(u, bend, share):
        return 0.0, u

    def step(w, before, u, bend, share):
        w = w + share * (u - before)
        return w, u, u + bend * (u * u + w)
'''
OPERATOR = '''
class Memory(Operator):
    """y = gain u - h."""

    place = Place.OPERATOR
    gain = Parameter("response/drive", (0, 3), "Displacement per volt.")
    fast = Parameter("1/drive", (0.1, 60), "Forgetting per volt.")

    def prepare(gain, fast):
        return (gain,), (fast, 1 / fast), (fast, 1 / fast)

    def start(u):
        return (0.0,)

    def travel(distance, rate, length):
        return exp(-rate * distance), length

    def reach(q, rate, length):
        return -q * length

    def output(h, u, gain):
        return gain * u - h
'''
BANK = '''
class Plays(Bank):
    """y = u + sum_i w_i p_i."""

    place = Place.READOUT
    plays = Setting(4, (1, 10), "Plays.")
    weight = Parameter("1", (-1, 1), "Weight of a play.", count="plays")
    reach = Parameter("drive", (0, 1), "Of the widest play.")

    def count(plays):
        return plays

    def prepare(weight, reach, branch, plays):
        return weight, reach * branch / plays

    def start(u, weight, half):
        return (u,)

    def step(p, u, weight, half):
        p = max(u - half, min(u + half, p))
        return p, weight * p

    def output(u, total, weight, half):
        return u + total
'''
COUPLING = '''
class Pass(Coupling):
    """y = y + ratio x."""

    place = Place.COUPLING
    ratio = Parameter("1", (-1, 1), "Ratio.", null=0)
    look_alikes = ("saturation",)
    separate_by = "Drive to both polarities."
    remedy = "Linearise the drive."

    def prepare(ratio):
        return (ratio,)

    def start(y, other, ratio):
        return ()

    def step(y, other, ratio):
        return y + ratio * other
'''
SHIFT = '''
class Late(Shift):
    """y(t) = u(t - late)."""

    place = Place.DELAY
    late = Parameter("s", (0, 1), "Delay.", null=0)

    def prepare(late, dt):
        return (late / dt,)
'''
BESIDE = '''
class Path(Beside):
    """y = x + share f."""

    place = Place.MODE
    share = Parameter("1", (-1, 1), "Share.", null=0)
    look_alikes = ("saturation",)
    separate_by = "Drive to both polarities."
    remedy = "Linearise the drive."

    def prepare(share):
        return (share,)

    def start(f, share):
        return (f,)

    def step(w, x, f, share):
        return f, x + share * w
'''
ADDITION = '''
class Ramp(Addition):
    """y = x + size t / tau."""

    place = Place.OUTPUT
    size = Parameter("response", (-1, 1), "Size.", null=0, per_record=True)
    tau = Parameter("s", (1, 10), "Time.")

    def basis(t, tau):
        return (t / tau,)
'''
MODES = '''
class Two(Modes):
    """y = sum q."""

    place = Place.MECHANICS
    modes = Setting(2, (1, 9), "Modes.")
    weights = ("push", "shape")
    frequency = Parameter("Hz", (1, 10), "Frequency.", count="modes", per="stage")
    push = Parameter("1", (-5, 5), "Push.", count="modes", per="later axis")
    shape = Parameter("1", (-5, 5), "Shape.", count="modes")

    def prepare(frequency, dt):
        return (frequency * dt,)

    def start(p, slow):
        return (p,)

    def step(q, p, slow):
        q = q + slow * (p - q)
        return q, q
'''
RELAYS = '''
class Domains(Relays):
    """y = gain u + total."""

    place = Place.OPERATOR
    gain = Parameter("response/drive", (0, 3), "Gain.")
    wide = Parameter("drive", (0.1, 3), "Spacing.")

    def prepare(gain, wide, dt):
        return (wide,), (dt, wide), (gain,)

    def field(u, wide):
        return u

    def coercive_field(i, wide):
        return wide * i

    def mass(low, high, wide):
        return high - low

    def start(field, half, low, high, wide):
        return 0.5

    def leave(further, dt, wide):
        return 1.0, exp(-dt), wide

    def output(u, total, gain):
        return gain * u + total
'''
GOOD = (GAIN, OPERATOR, BANK, COUPLING, SHIFT, BESIDE, ADDITION, MODES, RELAYS)
WALK = '''
@dataclass(frozen=True)
class Walk(Generational):
    """Random walk."""

    reach: float = setting(0.1, "range", (0, 1), "Of a step.")

    def search(self, dimensions, rng):
        while True:
            yield rng.random((self.population, dimensions))
'''


def made(text):
    """The class that a text declares."""
    space = {"__name__": "own"}
    exec(HEAD + text, space)
    return next(item for item in reversed(space.values()) if isinstance(item, type) and item.__module__ == "own")
