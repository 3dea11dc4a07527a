"""What an author of a model block writes: one sample of one candidate.

`prepare` turns parameters into coefficients, once per candidate. `start` gives the state at rest under the first
input, `step` one sample. All are scalars in, scalars out; `step` has conditional expressions instead of branches. The
functions are declared without self. The kernel compiles them and batches candidates as SIMD lanes (lanes/).
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from enum import IntEnum
from functools import cache
from typing import Any, ClassVar

from pzt_ident.errors import InputError, nearest
from pzt_ident.model.contract import called
from pzt_ident.model.parameter import Form, Parameter, Setting

TILES = 3  # signals that an axis carries: its own, what drives its operator's prompt response, and its mechanics


class Place(IntEnum):
    """Where a block stands in the signal chain, from the drive to the response."""

    DELAY = 0
    SLEW = 1
    AMPLIFIER = 2
    READOUT = 3
    OPERATOR = 4
    STATIC = 5
    CREEP = 6
    COUPLING = 7
    GUIDE = 8
    MECHANICS = 9
    MODE = 10
    OUTPUT = 11
    SENSOR = 12


def expm1(x: float) -> float:
    """exp(x) - 1 for blocks: the kernel puts a form in its place that runs in SIMD lanes."""
    return math.expm1(x)


def log1p(x: float) -> float:
    """log(1 + x) for blocks, likewise; where x <= -1 the value means nothing but raises nothing."""
    return math.log1p(x) if x > -1 else math.nan


def sin(x: float) -> float:
    """sin(x) for blocks, likewise; good to 1e-15 while |x| < 1e4."""
    return math.sin(x) if math.isfinite(x) else math.nan


def cos(x: float) -> float:
    """cos(x) for blocks, likewise; good to 1e-15 while |x| < 1e4."""
    return math.cos(x) if math.isfinite(x) else math.nan


def erf(x: float) -> float:
    """erf(x) for blocks, likewise; good to 1e-14."""
    return math.erf(x)


class Block:
    """One box of the signal chain, acting on each axis with that axis' own parameters.

    prepare(*parameters[, dt][, span][, peak][, settings]) -> coefficients; dt in s, span and peak the peak-to-peak
    drive of the axis and its largest magnitude.
    start(u, *coefficients) -> states.
    step(*states, u, *coefficients) -> (*states, y).

    refuse(least, most), where it is there, raises InputError for bounds between which no candidate can be simulated:
    two namespaces of parameters in SI units.

    What can be missing from a model is an effect and says more of itself: which effects leave the same trace, the
    experiment that tells them apart, and what to do about it on the rig.
    """

    kind: ClassVar[str] = "block"  # by which its functions are known, contract.KINDS
    name: ClassVar[str] = ""
    place: ClassVar[Place]
    oversample: ClassVar[int] = 1
    look_alikes: ClassVar[tuple[str, ...]] = ()
    separate_by: ClassVar[str] = ""
    remedy: ClassVar[str] = ""
    sizes: ClassVar[tuple[float, ...]] = (0.05,)  # of its range, at which its trace is looked for: one if it is linear
    seen: ClassVar[tuple[str, ...]] = ()  # parameters that a record shows only where its drive is of their size
    trials: ClassVar[Mapping[str, int]] = {}  # values over the range of a parameter that means nothing at the null
    chosen: ClassVar[dict[str, Any]] = {}
    forms: ClassVar[
        Mapping[str, type[Block]]
    ] = {}  # itself, by the word of an effect or a `Form` that changes its step
    watch: ClassVar[type[Block] | None] = None  # itself, giving what its equation wants above zero
    broken: ClassVar[str] = ""  # what is said where that is not

    def __init_subclass__(cls) -> None:
        for word, function in list(vars(cls).items()):
            if inspect.isfunction(function):
                setattr(cls, word, staticmethod(function))

    @classmethod
    def parameters(cls) -> dict[str, Parameter]:
        """Declared parameters by name, in the order of declaration; a counted one is its name with `_1`, `_2`, ..."""
        found = {}
        for owner in reversed(cls.__mro__):
            for word, declared in vars(owner).items():
                if isinstance(declared, Parameter):
                    count = cls.setting(declared.count) if isinstance(declared.count, str) else declared.count
                    names = [word] if count is None else [f"{word}_{k + 1}" for k in range(count)]
                    found.update(dict.fromkeys(names, declared))
        return found

    @classmethod
    def settings(cls) -> dict[str, Setting | Form]:
        """What a job may choose of how the block is built, by name."""
        owned = [item for owner in reversed(cls.__mro__) for item in vars(owner).items()]
        return {word: item for word, item in owned if isinstance(item, Setting | Form)}

    @classmethod
    def setting(cls, word: str) -> Any:
        return cls.chosen.get(word, cls.settings()[word].value)

    @classmethod
    def numbers(cls) -> dict[str, int]:
        """The whole numbers among the settings, as chosen; `prepare` may ask for them."""
        return {word: cls.setting(word) for word, item in cls.settings().items() if isinstance(item, Setting)}

    @classmethod
    def make(cls, **settings: Any) -> type[Block]:
        """The block with these settings. Raises InputError for an unknown one, or one that does not fit."""
        form = cls.formed(settings)
        known = form.settings()
        for word, value in settings.items():
            if word not in known:
                owners = [form for form, item in cls.forms.items() if word in item.settings()]
                remedy = nearest(word, known) if known else f"write just `{cls.name}`"
                remedy = f"only its form {' or '.join(owners)} has it" if owners else remedy
                raise InputError(f"unknown setting {word!r}", where=cls.name, remedy=remedy)
            known[word].check(value, f"{cls.name}.{word}")
        return _made(form, cls.name, tuple(sorted(settings.items())))  # type: ignore[arg-type]

    @classmethod
    def formed(cls, settings: Mapping[str, Any]) -> type[Block]:
        """The form that is chosen by the words among some settings, right or wrong as they are."""
        words = [settings.get(word) for word, item in cls.settings().items() if isinstance(item, Form)]
        return _made(next((cls.forms[str(word)] for word in words if str(word) in cls.forms), cls), cls.name, ())  # type: ignore[arg-type]

    @classmethod
    @cache
    def arguments(cls) -> tuple[str, ...]:
        """What `prepare` asks for."""
        return asked(cls.prepare)  # type: ignore[attr-defined]


@cache
def _made(block: type[Block], name: str, chosen: tuple[tuple[str, Any], ...]) -> type[Block]:
    """One class for the same choice, so that it is compiled once."""
    own: dict[str, Any] = {"__module__": block.__module__, "__doc__": block.__doc__, "name": name}
    own |= {"chosen": {**block.chosen, **dict(chosen)}}
    return type(block.__name__, (block,), own) if chosen or block.name != name else block


def asked(function: Callable[..., object]) -> tuple[str, ...]:
    return tuple(inspect.signature(function).parameters)


class Operator(Block):
    """A hysteresis operator in closed form on a monotone step of its drive.

    Its state, counted along the motion (q = h on a rising drive, -h on a falling one), follows an affine map
    q <- keep q + add in each of two regimes: `against` the motion, q < 0, and `along` it, q >= 0.

    prepare(*parameters) -> (shared, along, against), a tuple of coefficients each.
    travel(distance, *along or against) -> (keep, add) for a step of |dU| = distance.
    near(further, keep, add, *along or against) -> the same for distance + further, from those for distance, good to
    3e-13 while |rate further| <= 0.1, the rate being the first coefficient of a regime.
    exact(q, distance, along, against) -> q, through a sign change of q, for any q.
    output(h, u, *shared) -> y.

    Effects inside the operator's own equation are parameters that name them. They are asked for only where a job
    lists one: terms(*parameters[, dt][, span]) -> coefficients,
    lift(distance, u, sign, *coefficients) -> the factor on what drives q, u in the middle of the step, sign of du, and
    fade(*coefficients) -> the share of h that is left after a sample.
    """

    kind = "operator"


class Bank(Block):
    """Branches in parallel under one input: `step` is one branch and returns its contribution to the total.

    prepare may ask for `branch`, counted from 0, and is given each branch its own of a counted parameter.
    output(u, total, *coefficients of the first branch) -> y.
    stands(*parameters[, settings], branch), optional: the drive that a branch's own of a counted parameter stands for.
    rests(*states, low, high, *coefficients) -> whether no input between low and high moves the branch: optional, it
    saves the steps of a branch that holds still over a tile in every lane.

    What needs NumPy is done once per distinct candidate: solve(own) -> one array (branches,) for each word of `solved`,
    which `prepare` may ask for; own.word is a parameter (an array where it is counted), a setting or dt. Where a job
    chooses the size, count(*settings) -> branches; it raises InputError where settings do not go together.
    """

    kind = "bank"
    branches: ClassVar[int]
    solved: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        count = getattr(cls, "count", None)
        if inspect.isfunction(count) and set(asked(count)) <= set(cls.settings()):
            cls.branches = called(cls, "count", *(cls.setting(word) for word in asked(count)))


class Relays(Block):
    """Domains of `coercives` coercive fields, equally many of each, over `interactions` interaction fields that lie a
    spacing apart about 0. Of each kind a share x points up. Per second a share `rate` of them leaves the side that they
    are on, which depends on how much further its effective field is from where it would not hold without activation.
    x relaxes exactly over a step of the field in its middle. Where all domains of a kind are on one side and none
    leaves, to 1e-15, they are not stepped.

    prepare(*parameters) -> (shape, energy, shared), a tuple of coefficients each; shape[0] is the spacing.
    field(u, *shape) -> in the material. coercive_field(i, *shape) -> that of node i.
    mass(low, high, *shape) -> weight of the interaction fields between.
    start(field, coercive, low, high, *shape) -> the share that points up under the first one.
    leave(further, *energy) -> (rate, what is left on that side after a sample, response of a domain on it): tabulated
    once a candidate, `fine` points a spacing, and interpolated.
    output(u, total, *shared) -> y.
    """

    kind = "relays"
    coercives: ClassVar[int] = 64
    interactions: ClassVar[int] = 64
    columns: ClassVar[int] = 256  # spacings that the table of `leave` covers
    fine: ClassVar[int] = 32


class Term(Block):
    """An effect inside the equation of other blocks, which is written there: parameters of theirs name it."""

    kind = "term"


class Shift(Block):
    """A delay: y(t) = u(t - prepare(...)[0] samples) of the drive, which is linear between its samples."""

    kind = "shift"


class Beside(Block):
    """A path beside the mechanics: step(*states, x, f, *coefficients) -> (*states, y), from f, the force that the
    mechanics is driven by, and x, what comes out of it; start(f, *coefficients) is under the first force."""

    kind = "beside"


class Addition(Block):
    """What adds to the response of each record in amounts of that record's own: y = x + sum_i a_i b_i(t).

    basis(t, *parameters) -> (b_1, b_2, ...), arrays over t, s from the start of the record. The amounts, parameters
    of each record, are taken in closed form together with the offset, on any record.
    """

    kind = "addition"


class Modes(Block):
    """Mechanics of all axes together: each mode takes the force p = sum_a enters_a f_a, and its displacement q moves
    every axis, y_a = sum_modes leaves_a q.

    prepare(*parameters of a mode[, dt]) -> coefficients; start(p, *coefficients) -> states;
    step(*states, p, *coefficients) -> (*states, q). `weights` are the words of enters and leaves.
    """

    kind = "modes"
    branches: ClassVar[int]
    weights: ClassVar[tuple[str, str]]

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if "modes" in cls.settings():
            cls.branches = cls.setting("modes")


class Coupling(Block):
    """Acts across axes: step(y, other, *coefficients) -> y, once for each other axis; `other` and the first y are the
    inputs. Its parameters exist once for each ordered pair of axes."""

    kind = "coupling"
