"""What an author of a model block writes: one sample of one candidate.

`prepare` turns parameters into coefficients, once per candidate. `start` returns the state at rest under the first
input, `step` advances it by one sample. All take and return scalars; `step` has conditional expressions instead of
branches. The functions are declared without self. The engine compiles them and runs many candidates as SIMD lanes.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from enum import IntEnum
from functools import cache
from typing import Any, ClassVar

from pzt_ident.errors import InputError, nearest
from pzt_ident.model.contract import call_function
from pzt_ident.model.elementary import cos as cos
from pzt_ident.model.elementary import erf as erf
from pzt_ident.model.elementary import expm1 as expm1
from pzt_ident.model.elementary import log as log
from pzt_ident.model.elementary import log1p as log1p
from pzt_ident.model.elementary import rough_inverse_cube_root as rough_inverse_cube_root
from pzt_ident.model.elementary import rough_log as rough_log
from pzt_ident.model.elementary import sin as sin
from pzt_ident.model.parameter import Form, Parameter, Setting

TILES = 3  # signals of an axis: its own, the input of its operator's prompt response, the force on its mechanics

OTHER = "other_"  # before a word that a coupling asks of the other axis


class Place(IntEnum):
    """Position of a block in the signal chain, from the drive to the response."""

    DELAY = 0
    SLEW = 1
    AMPLIFIER = 2
    SUPPLY = 3
    READOUT = 4
    OPERATOR = 5
    STATIC = 6
    CREEP = 7
    COUPLING = 8
    GUIDE = 9
    FLEXURE = 10
    MECHANICS = 11
    MODE = 12
    OUTPUT = 13
    SENSOR = 14


class Block:
    """One box of the signal chain, acting on each axis with that axis' own parameters.

    prepare(*parameters[, dt][, span][, peak][, duration][, lead][, from_rest][, settings]) -> coefficients; dt: sample
    time in s; span, peak: the peak-to-peak drive of the axis and its largest magnitude; duration: of the record in s;
    lead: steps of the simulation ahead of the record;
    from_rest: 1 in a chain with a block that is `about_rest`, such as a spring that is not bent at rest, else 0: an
    operator then counts its response from that at rest, at zero drive. Parameters that
    are `per_record` follow from least squares on each record, and are at their null where nothing was measured.
    start(u, *coefficients) -> states.
    step(*states, u, *coefficients) -> (*states, y).

    refuse(least, most), optional, raises InputError for bounds between which no candidate can be simulated; least and
    most are namespaces of parameters in SI units.

    An effect, a block that may be missing from a model, also declares which effects leave the same trace
    (look_alikes), the experiment that tells them apart (separate_by), and the remedy on the rig; a form of it which
    look-alikes it is at the null of its own size (contains), and of which form of another effect it is the equation
    (equation_of), which is named where both fit.
    """

    kind: ClassVar[str] = "block"  # key of its functions in contract.kinds.KINDS
    name: ClassVar[str] = ""
    place: ClassVar[Place]
    oversample: ClassVar[int] = 1
    starts: ClassVar[Mapping[str, tuple[float, ...]]] = {}  # of amounts that are not found from zero: shares of a bound
    lead: ClassVar[int] = 0  # samples ahead of a record in which it acts on the memory, all else being at rest
    look_alikes: ClassVar[tuple[str, ...]] = ()
    contains: ClassVar[tuple[str, ...]] = ()
    equation_of: ClassVar[str] = ""
    leaves: ClassVar[tuple[str, ...]] = ()  # effects whose trace is left where its own form is another one
    separate_by: ClassVar[str] = ""
    remedy: ClassVar[str] = ""
    in_setup: ClassVar[bool] = False  # a fault of the set-up: mended, not modelled, so that no diagnosis adds it
    sizes: ClassVar[tuple[float, ...]] = (0.05,)  # shares of its range at which an effect is scored; one if linear
    compared_with_drive: ClassVar[tuple[str, ...]] = ()  # parameters that only a drive of their size can identify
    trials: ClassVar[Mapping[str, int]] = {}  # values tried of each parameter that has no influence at the null
    chosen_settings: ClassVar[dict[str, Any]] = {}
    forms: ClassVar[Mapping[str, type[Block]]] = {}  # variants, by the word of a `Form` or of an effect in their step
    joint: ClassVar[Mapping[str, type[Block]]] = {}  # of a form: those with the term of another effect, by its word
    wrong_way: ClassVar[str] = ""  # the condition under which the output first moves against its input
    ahead_of: ClassVar[Place | None] = None  # where a block must be for a form to be another one than the first
    about_rest: ClassVar[bool] = False  # whether it is nonlinear in the displacement from rest
    refines: ClassVar[tuple[str, ...]] = ()  # operators which with it are no more than finer
    alike: ClassVar[tuple[str, ...]] = ()  # parameters of each record that together are as large in all of them
    solving: ClassVar[float] = 0.0  # s of a core, in a step of a candidate: equations that it solves by iteration
    line: ClassVar[str] = ""  # its frequency or period, if it is a line of the spectrum over time or displacement
    flexible: ClassVar[bool] = False  # whether it follows a part of any slow misfit, in the records kept back as well
    loops: ClassVar[bool] = False  # whether it is a hysteresis operator of its own, beside the model's
    solvable: ClassVar[bool] = True  # whether `step` has a stable inverse, sample by sample (see control.inverse)
    margin: ClassVar[type[Block] | None] = None  # variant whose output must stay above zero for the equation to hold
    violation: ClassVar[str] = ""  # the sentence for a margin of zero or less

    def __init_subclass__(cls) -> None:
        for word, function in list(vars(cls).items()):
            if inspect.isfunction(function):
                setattr(cls, word, staticmethod(function))

    @classmethod
    @cache
    def parameters(cls) -> dict[str, Parameter]:
        """Declared parameters by name, in the order of declaration; a counted one appears as `name_1`, `name_2`, ..."""
        own, parameters = dict[str, Parameter](), dict[str, Parameter]()
        for owner in reversed(cls.__mro__):
            own |= {word: declared for word, declared in vars(owner).items() if isinstance(declared, Parameter)}
        for word, declared in own.items():
            count = cls.setting(declared.count) if isinstance(declared.count, str) else declared.count
            names = [word] if count is None else [f"{word}_{k + 1}" for k in range(count)]
            parameters.update(dict.fromkeys(names, declared))
        return parameters

    @classmethod
    def amounts(cls) -> int:
        """Number of parameters of which each record has its own, but for those of an effect in its equation."""
        return sum(declared.per_record and not declared.effects for declared in cls.parameters().values())

    @classmethod
    def effects(cls) -> set[str]:
        """The words of the effects that act inside the equation of the block."""
        return {declared.effect_word for declared in cls.parameters().values() if declared.effects}

    @classmethod
    def holds(cls, effect: type[Block]) -> bool:
        """Whether an effect, in its form, acts inside the equation of the block."""
        return not {effect.name, effect.item()}.isdisjoint(cls._items())

    @classmethod
    def distinguishes(cls, effect: type[Block]) -> bool:
        """Whether the form of an effect is another one in the equation of the block than its first form."""
        return effect.item() == effect.name or effect.item() in {*cls.forms, *cls._items()}

    @classmethod
    def _items(cls) -> set[str]:
        """The effects inside its equation, in each form that has parameters of its own."""
        return {item for declared in cls.parameters().values() for item in declared.effects}

    @classmethod
    @cache
    def settings(cls) -> dict[str, Setting | Form]:
        """The settings that a job may choose, by name."""
        attributes = [item for owner in reversed(cls.__mro__) for item in vars(owner).items()]
        return {word: value for word, value in attributes if isinstance(value, Setting | Form)}

    @classmethod
    def setting(cls, word: str) -> Any:
        """The value of a setting, as chosen or by default."""
        return cls.chosen_settings.get(word, cls.settings()[word].value)

    @classmethod
    def numbers(cls) -> dict[str, int]:
        """The settings that are whole numbers; `prepare` may ask for them."""
        return {word: cls.setting(word) for word, item in cls.settings().items() if isinstance(item, Setting)}

    @classmethod
    def make(cls, **settings: Any) -> type[Block]:
        """The block with these settings. Raises InputError for an unknown setting or value."""
        form = cls.form_of(settings)
        known = form.settings()
        for word, value in settings.items():
            if word not in known:
                owners = [form for form, item in cls.forms.items() if word in item.settings()]
                remedy = nearest(word, known) if known else f"write just `{cls.name}`"
                remedy = f"only its form {' or '.join(owners)} has it" if owners else remedy
                raise InputError(f"unknown setting {word!r}", where=cls.name, remedy=remedy)
            known[word].check(value, f"{cls.name}.{word}")
        return _configured(form, cls.name, tuple(sorted(settings.items())))  # type: ignore[arg-type]

    @classmethod
    def form_of(cls, settings: Mapping[str, Any]) -> type[Block]:
        """The form that the settings choose; the settings are not checked."""
        words = [settings.get(word) for word, item in cls.settings().items() if isinstance(item, Form)]
        form = next((cls.forms[str(word)] for word in words if str(word) in cls.forms), cls)
        return _configured(form, cls.name, ())  # type: ignore[arg-type]

    @classmethod
    def item(cls) -> str:
        """The word with the form, as in a job: `friction.dahl`; the word alone where there is only one form."""
        return f"{cls.name}.{cls.setting('form')}" if "form" in cls.settings() else cls.name

    @classmethod
    @cache
    def arguments(cls) -> tuple[str, ...]:
        """The arguments of `prepare`."""
        return argument_names(cls.prepare)  # type: ignore[attr-defined]


@cache
def _configured(block: type[Block], name: str, settings: tuple[tuple[str, Any], ...]) -> type[Block]:
    """One class for the same settings, so that it is compiled once."""
    attributes: dict[str, Any] = {"__module__": block.__module__, "__doc__": block.__doc__, "name": name}
    attributes["chosen_settings"] = {**block.chosen_settings, **dict(settings)}
    return type(block.__name__, (block,), attributes) if settings or block.name != name else block


@cache
def argument_names(function: Callable[..., object]) -> tuple[str, ...]:
    return tuple(inspect.signature(function).parameters)


class Operator(Block):
    """A hysteresis operator in closed form on a monotone step of its drive.

    Its state, counted along the motion (q = h on a rising drive, -h on a falling one), follows an affine map
    q <- keep q + add in each of two regimes: `against` the motion, q < 0, and `along` it, q >= 0.

    prepare(*parameters) -> (shared, along, against), a tuple of coefficients each.
    travel(distance, *along or against) -> (keep, add) for a step of |du| = distance.
    reach(q, *against) -> the distance after which q < 0 is zero; inf if it never is.
    output(h, u, *shared) -> y.
    quadrant(way, rate, distance, u, sign, *shared) -> the regime that takes the place of one with that rate on a step
    of du = sign distance about u; way: 1 along, -1 against. Optional, for regimes that differ by branch.

    Effects inside the operator's equation are parameters with an `effect`. Only where a job lists one of these, three
    more functions are called: terms(*parameters[, dt][, span]) -> coefficients,
    lift(distance, u, sign, *coefficients) -> factor on the drive of q, with u in the middle of the step and the sign of
    du, and fade(h, *coefficients) -> the share of h that is left after a sample.
    """

    kind = "operator"


class Bank(Block):
    """Parallel branches under one input: `step` is one branch and returns its contribution to the total.

    prepare may ask for `branch`, counted from 0; of a counted parameter, each branch is given its own value.
    output(u, total, *coefficients of the first branch) -> y.
    threshold(*parameters[, settings], branch) -> the drive at which a branch acts, such as the half-width of a play.
    Optional; the report states it beside the counted parameters.
    rests(*states, low, high, *coefficients) -> whether no input between low and high moves the branch. Optional; it
    saves the steps of a branch that holds still over a tile in every lane.

    A branch of one state with a response that is a smooth function of it is read by series, in a third of the time:
    read(state, *coefficients) -> its response, as smooth as erf(state).
    limits(state, low, high, *coefficients) -> (least, most): between which states it stays for inputs between these.
    rides(state, first, last, back, *coefficients) -> whether it depends alone on how far the input has come, which goes
    from first to last, and on the way back by `back` at most.
    bend(*coefficients) -> the change of the input that changes the state by one.

    What needs NumPy is computed once per distinct candidate: solve(values) -> one array (branches,) for each word of
    `solved`, which `prepare` may ask for; values.word is a parameter (an array if counted), a setting or dt. Where a
    job chooses the size, count(*settings) -> branches; it raises InputError for settings that exclude each other.
    """

    kind = "bank"
    branches: ClassVar[int]
    solved: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        count = getattr(cls, "count", None)
        if inspect.isfunction(count) and set(argument_names(count)) <= set(cls.settings()):
            cls.branches = call_function(cls, "count", *(cls.setting(word) for word in argument_names(count)))


class Relays(Block):
    """Relays with thermal activation: domains with `coercives` coercive fields, equally many of each, times
    `interactions` interaction fields at a constant spacing about 0. The state of each pair is the share x of its
    domains that point up.

    Domains leave the side that they are on at a rate (1/s) that depends on how far the effective field is beyond the
    field at which the side would be lost without thermal activation (`further`). Over a sample x relaxes exactly at
    the rates in the middle of the step of the field. Pairs of which all domains are on one side, and leave it at a
    rate below rounding (1e-15), are not stepped.

    prepare(*parameters) -> (shape, energy, shared), a tuple of coefficients each; shape[0] is the spacing.
    field(u, *shape) -> field in the material. coercive_field(i, *shape) -> coercive field of node i.
    mass(low, high, *shape) -> weight of the interaction fields between low and high.
    start(field, coercive, low, high, *shape) -> the share x under the first field.
    leave(further, *energy) -> (rate, share left on that side after a sample, response of a domain on that side);
    tabulated once per candidate, at `fine` points per spacing, and interpolated.
    output(u, total, *shared) -> y.
    """

    kind = "relays"
    coercives: ClassVar[int] = 64
    interactions: ClassVar[int] = 64
    columns: ClassVar[int] = 256  # width of the table of `leave`, in spacings
    fine: ClassVar[int] = 32  # points of the table per spacing


class Term(Block):
    """An effect inside the equation of other blocks, which have parameters with its name as their `effect`."""

    kind = "term"


class Shift(Block):
    """A delay of the drive: y(t) = u(t - prepare(...)[0] samples), u linear between its samples."""

    kind = "shift"


class Beside(Block):
    """A path beside the mechanics: step(*states, x, f, *coefficients) -> (*states, y), with f the force on the
    mechanics and x its displacement; start(f, *coefficients) -> states under the first force."""

    kind = "beside"


class Addition(Block):
    """A disturbance added to the response, with amounts of its own for each record: y = x + sum_i a_i b_i(t).

    basis(t, *parameters[, duration]) -> (b_1, b_2, ...) at the time t in s from the start of the record; duration: that
    of the record. The amounts a_i, the parameters that are `per_record`, are solved for in closed form together with
    the offset.
    """

    kind = "addition"

    @classmethod
    @cache
    def arguments(cls) -> tuple[str, ...]:
        """The arguments of `basis` behind t."""
        return argument_names(cls.basis)[1:]  # type: ignore[attr-defined]


class Modes(Block):
    """Mechanics of all axes together: each mode is driven by p = sum_a enters_a f_a, and its displacement q moves every
    axis, y_a = sum_modes leaves_a q.

    prepare(*parameters of a mode[, dt]) -> coefficients; start(p, *coefficients) -> states;
    step(*states, p, *coefficients) -> (*states, q). `weights` names the two parameters that are enters and leaves.
    """

    kind = "modes"
    branches: ClassVar[int]
    weights: ClassVar[tuple[str, str]]

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if "modes" in cls.settings():
            cls.branches = cls.setting("modes")


class Coupling(Block):
    """Acts across axes: step(*states, y, other, *coefficients) -> (*states, y), once for each other axis; `other` and
    the first y are the inputs of the block; start(y, other, *coefficients) -> states under the first inputs.
    There is one set of parameters for each ordered pair of axes.

    prepare may ask for the parameters of the mechanics ahead of it that are `of_mechanics`, and, with `other_` before
    the word, for those of the mechanics of the other axis and of the same pair the other way round."""

    kind = "coupling"
    of_mechanics: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def mechanics_in(cls, chain: Iterable[type[Block]]) -> type[Block] | None:
        """The block that has what this one asks of the mechanics; None where there is none."""
        wanted = set(cls.of_mechanics)
        return next((block for block in chain if wanted <= set(block.parameters())), None) if wanted else None

    @classmethod
    def lacks_mechanics(cls, chain: Iterable[type[Block]]) -> bool:
        """Whether a chain has no block for what this one asks of the mechanics."""
        return bool(cls.of_mechanics) and cls.mechanics_in(chain) is None

    @classmethod
    def asked_of_others(cls) -> set[str]:
        """The words that prepare may ask for beside the block's own."""
        return {*cls.of_mechanics, *(f"{OTHER}{word}" for word in (*cls.of_mechanics, *cls.parameters()))}
