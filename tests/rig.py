"""Records, drives and candidates made up for the tests of the physics."""

from itertools import pairwise

import numpy as np

from pzt_ident.control.stage import Stage
from pzt_ident.data.record import Record
from pzt_ident.engine.simulator import simulate
from pzt_ident.model.block import Coupling, Modes
from pzt_ident.model.chain import Chain
from pzt_ident.model.parameter import Setting
from pzt_ident.model.registry import blocks

AXES = "xyz"
CHAOTIC = 1e-7


def record(*drives, response=None, dt=1e-3, measured=None, **more):
    """One record over as many axes as drives; the response is zero unless given."""
    drive = np.array(drives, float)
    measured = range(len(drive)) if measured is None else measured
    return Record(
        name="made up",
        use="identify",
        dt=dt,
        drive=drive,
        response=np.zeros_like(drive) if response is None else np.array(response, float),
        axes=tuple(AXES[: len(drive)]),
        drive_units=("V",) * len(drive),
        response_units=tuple("m" if i in measured else None for i in range(len(drive))),
        **more,
    )


def model(*chain, axes=None, measured=None):
    """A model of blocks or their words, these as small as is worth a test; two axes where a block couples them, and the
    mechanics that it asks."""
    chain = [small(block_of(item)) if isinstance(item, str) else item for item in chain]
    if any(issubclass(block, Coupling) and block.lacks_mechanics(chain) for block in chain):
        chain.append(blocks["lumped"])
    axes = axes or (2 if any(issubclass(block, Coupling | Modes) for block in chain) else 1)
    return Chain(chain, AXES[:axes], range(axes) if measured is None else measured)


def block_of(word):
    """The block of a word, or one of its forms: `homogenized_energy:free`."""
    word, _, form = word.partition(":")
    named = [name for name, item in blocks[word].settings().items() if form in getattr(item, "words", ())]
    return blocks[word].make(**dict.fromkeys(named, form))


def small(block):
    numbers = {word: item for word, item in block.settings().items() if isinstance(item, Setting)}
    return block.make(**{word: min(item.value, item.bounds[0] + 1) for word, item in numbers.items()})


def response(chain, parameters, *drives, dt=1e-3, **more):
    """Response of one candidate, (axes, samples), or (samples,) for one axis. Parameters as named in `Model.names`;
    those that belong to an effect are at their null unless given."""
    chosen = [blocks[item] if isinstance(item, str) else item for item in chain]
    made = model(*chain, *effects_of(chosen, parameters), axes=len(drives))
    nulls = {entry.name: entry.parameter.null for entry in made.entries if entry.parameter.effects}
    theta = np.array([[(nulls | parameters)[name] for name in made.names]])
    found = simulate(made, record(*drives, dt=dt, **more), theta)[0]
    return found if len(drives) > 1 else found[0]


def effects_of(chosen, names):
    """The effects to which parameters of some blocks belong; of several forms that share them the first."""
    declared = [(f"{block.name}.{word}", item) for block in chosen for word, item in block.parameters().items()]
    owners = [item.effects for name, item in declared if name in names and item.effects]
    only = {items[0] for items in owners if len(items) == 1}
    shared = [items for items in owners if only.isdisjoint(items)]
    common = [item for item in shared[0] if all(item in items for items in shared)] if shared else []
    return only | {*common[:1]}


def stage_of(chain, measured, theta):
    """One candidate on the drives of a record, a sample at a time."""
    spans, peaks = np.ptp(measured.drive, axis=1), np.abs(measured.drive).max(axis=1)
    return Stage(chain, theta, measured.dt, spans, peaks)


def candidates(made, drive, count, seed, response=10.0):
    """Random theta within the declared bounds, for drives of that span and responses of the given one."""
    rng = np.random.default_rng(seed)
    columns = []
    for entry in made.entries:
        declared = entry.parameter
        low, high = np.array(declared.bounds) * size(declared.unit, np.ptp(drive), response)
        share = rng.uniform(0.02, 0.98, count)
        columns.append(low * (high / low) ** share if declared.scale == "log" else low + (high - low) * share)
    return np.array(columns).T.reshape(count, len(columns))


def size(unit, drive, response):
    """What the bounds of a parameter in `drive` or `response` units are multiples of."""
    spans = {"drive": drive, "response": response}
    top, _, bottom = unit.partition("/")
    below, _, power = bottom.partition("^")
    return spans.get(top, 1) / spans.get(below, 1) ** int(power or 1)


def path(*levels, points=100):
    """Straight legs from level to level, `points` samples each; every level is a sample."""
    legs = [np.linspace(a, b, points, endpoint=False) for a, b in pairwise(levels)]
    return np.append(np.concatenate(legs), float(levels[-1]))


def triangle(amplitude, cycles=3, points=500):
    return path(*[amplitude * (i % 2) for i in range(2 * cycles + 1)], points=points)


def rounding(made, measured, theta):
    """What a last digit of the parameters does to the response: much, where a candidate runs away."""
    return np.subtract(*np.split(simulate(made, measured, np.vstack([theta * (1 + 1e-14), theta])), 2))


def assert_close(found, expected, rounding=0.0, close=1e-12):
    """To 1e-12 of each largest value and what rounding may do. Where that is no sensible number, or a last digit has
    grown to more than CHAOTIC of it, nothing is compared: any two ways to compute it differ."""
    so_far = np.maximum.accumulate(np.abs(expected), axis=-1)
    grown = np.maximum.accumulate(np.abs(rounding + 0 * so_far), axis=-1)
    known = (so_far < 1e6) & (grown <= CHAOTIC * so_far)
    largest = np.where(known, so_far, 0).max(axis=-1, keepdims=True)
    assert np.all((np.abs(found - expected) <= close * largest + 100 * grown) | ~known)
