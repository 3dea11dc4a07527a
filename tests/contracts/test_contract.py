"""A block or optimizer that breaks its contract is told so, in its author's words, when it is registered."""

import re
import subprocess
import sys

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from authors import ADDITION, BANK, BESIDE, COUPLING, GAIN, GOOD, HEAD, MODES, OPERATOR, RELAYS, SHIFT, WALK, made
from pzt_ident.errors import InputError
from pzt_ident.model.contract import check, check_loaded
from pzt_ident.model.registry import blocks, optimizers


@pytest.mark.parametrize("text", [*GOOD, WALK])
def test_a_sound_class_passes(text):
    check(made(text))


@pytest.mark.parametrize("item", [*blocks, *optimizers], ids=lambda item: item.name)
def test_every_class_of_the_package_passes(item):
    check(item)


@pytest.mark.parametrize("block", list(blocks), ids=lambda block: block.name)
def test_every_block_passes_in_all_its_forms(block):
    for form in (
        block,
        *block.forms.values(),
        *(form.margin for form in (block, *block.forms.values()) if form.margin),
    ):
        check_loaded(form, blocks)


FUNCTIONS = [
    (GAIN, "(bend, tau, dt)", "(bend, dt)", r"Gain.prepare: does not ask for the parameter 'tau'\n  name it among"),
    (ADDITION, "(t, tau)", "(t)", "Ramp.basis: does not ask for the parameter 'tau'"),
    (GAIN, "(bend, tau, dt)", "(bend, tua, dt)", r"Gain.prepare: asks for 'tua'.*\n.*'tau'"),
    (GAIN, "(bend, tau, dt)", "(bend, tau, dt, branch)", "Gain.prepare: asks for 'branch'"),
    (GAIN, "def prepare", "def prepair", r"Gain.prepare: has no function `prepare`\n.*did you mean 'prepair'"),
    (GAIN, "def step", "def stop", r"Gain.step: has no function `step`\n  write step\(states, u, coefficients\)"),
    (GAIN, "start(u, bend, share)", "start(u, bend)", r"Gain.start: takes \(u, bend\), .*'share' missing"),
    (GAIN, "start(u, bend, share)", "start(u, bend, share, more)", "Gain.start: .*'more' too many"),
    (GAIN, "step(w, before, u, bend", "step(self, w, before, u, bend", r"Gain.step: .*'self' too many\n.* no self"),
    (GAIN, "step(w, before, u,", "step(w, u,", "Gain.step: takes .*'state 2' missing"),
    (GAIN, "return w, u, u + bend * (u * u + w)", "return w, u", "Gain.step: gives 2 values, where 3 values should be"),
    (GAIN, "return w, u, u + bend * (u * u + w)", "return u", "Gain.step: gives 0.5, where a tuple should be"),
    (GAIN, "return bend, dt / tau", "pass", "Gain.prepare: gives None, where a tuple should be"),
    (GAIN, "return bend, dt / tau", "return [bend, dt / tau]", r"Gain.prepare: gives \[.*, where a tuple should be"),
    (GAIN, "return bend, dt / tau", "return bend, 'a'", "Gain.prepare: gives 2 values, where numbers should be"),
    (GAIN, "return bend, dt / tau", "return bend, 1 / 0", "Gain.prepare: raises ZeroDivisionError in line"),
    (
        GAIN,
        "u + bend * (u * u + w)",
        "u + bend * (u * u + w) + 1e-9",
        "Gain.step: gives 0.2500.* for 0.25 with bend = 0: an",
    ),
    (
        COUPLING,
        "return y + ratio * other",
        "return 1.01 * y + ratio * other",
        "Pass.step: gives 0.2525 for 0.25 with ratio",
    ),
    (BESIDE, "x + share * w", "x + 1 + share * w", "Path.step: gives 1.25 for 0.25"),
    (GAIN, "w + share", "w + shear", "Gain.step: raises NameError in line .*'shear'"),
    (GAIN, "def start(u, bend, share)", "def start(*given)", "Gain.start: takes arguments of any number"),
    (GAIN, "    def start(u, bend, share)", "    start = 3\n    def begin(u, bend, share)", "Gain.start: is int"),
    (OPERATOR, "return (0.0,)", "return 0.0", "Memory.start: gives 0.0, where a tuple should be"),
    (OPERATOR, "return -q * length", "return q, length", "Memory.reach: .*one number, bare should be"),
    (OPERATOR, "(fast, 1 / fast), (fast, 1 / fast)", "(fast, 1 / fast), (fast,)", "Memory.prepare: gives 2 and 1"),
    (OPERATOR, "return (gain,),", "return (),", "Memory.prepare: .*a tuple of one or more for shared"),
    (OPERATOR, "(q, rate, length)", "(rate, length)", "Memory.reach: .*'q'.* missing"),
    (OPERATOR, "travel(distance, rate, length)", "travel(distance, rate)", "Memory.travel: .*'along 2' missing"),
    (OPERATOR, "reach(q, rate, length)", "reach(q, rate)", "Memory.reach: .*'against 2' missing"),
    (GAIN, "return bend, dt / tau", "return bend, 1.0, 2.0", r"Gain.start: .*\(u, bend, share, coefficient 3\)"),
    (OPERATOR, '"Forgetting per volt."', '"Forgetting.", 0.1, effect="creep"', "Memory.terms: has no function `terms`"),
    (BANK, "def output", "def out", "Plays.output: has no function `output`"),
    (BANK, "(plays)", "(players)", r"Plays.count: asks for 'players'.*\n.*'plays'"),
    (BANK, "return plays", "return 1 / 0", "Plays.count: raises ZeroDivisionError"),
    (COUPLING, "return y + ratio * other", "return y, ratio", "Pass.step: gives 2 values, where one number, bare"),
    (SHIFT, "(late / dt,)", "late / dt, 0.0", "Late.prepare: gives 2 values, where one value should be"),
    (BESIDE, "(w, x, f, share)", "(w, f, share)", "Path.step: .*'x' missing"),
    (ADDITION, "(t, tau)", "(t, tau, dt)", "Ramp.basis: asks for 'dt'"),
    (ADDITION, "(t / tau,)", "(t / tau, t)", "Ramp.basis: gives 2 values, where one value should be"),
    (ADDITION, "(t / tau,)", "('t',)", "Ramp.basis: .*numbers should be"),
    (MODES, "(frequency, dt)", "(frequency, push, dt)", "Two.prepare: asks for 'push'"),
    (MODES, "return (p,)", "return ()", "Two.start: .*one value or more"),
    (RELAYS, "return 1.0, exp(-dt), wide", "return 1.0, wide", "Domains.leave: gives 2 values, where 3"),
    (RELAYS, "def mass", "def mess", "Domains.mass: has no function `mass`.*\n.*'mess'"),
]
DECLARED = [
    (GAIN, "place = Place.READOUT", "", "Gain.place: has no `place`"),
    (GAIN, "Place.READOUT", "'readout'", "Gain.place: has 'readout' for its `place`"),
    (GAIN, '"""y = u + bend (u^2 + w)."""', "", "Gain: has no docstring"),
    (GAIN, "(0, 1)", "(1, 0)", r"Gain.bend: bounds \(1, 0\) are no range"),
    (GAIN, "(0, 1)", "5", "Gain.bend: bounds 5 are no range"),
    (GAIN, "null=0", "null=-1", "Gain.bend: null -1 is out of its bounds"),
    (GAIN, "null=0", "null=0, value=2", "Gain.bend: value 2 is out of its bounds"),
    (GAIN, "1/drive", "1/dirve", "Gain.bend: unknown unit 'dirve'"),
    (GAIN, '"1/drive"', "1", "Gain.bend: unit 1 is no such thing"),
    (GAIN, "(1e-3, 1)", "(0, 1)", "Gain.tau: a log scale from 0"),
    (GAIN, '"log"', '"logarithmic"', r"Gain.tau: unknown scale 'logarithmic'\n.*linear, log"),
    (GAIN, 'scale="log"', 'effect="creep"', "Gain.tau: belongs to an effect, but has no null"),
    (GAIN, 'scale="log"', "count=3", "Gain.tau: there are 3 of it for no branches"),
    (GAIN, 'scale="log"', 'count="branches"', "Gain.tau: is counted by the unknown setting 'branches'"),
    (GAIN, 'scale="log"', 'smooth="bent"', r"Gain.tau: unknown parameter 'bent'\n.*'bend'"),
    (GAIN, 'scale="log"', 'adds_to="bent"', r"Gain.tau: unknown parameter 'bent'\n.*'bend'"),
    (GAIN, "tau = ", "trials = {'bent': 3}\n    tau = ", r"Gain.trials: unknown parameter 'bent'\n.*'bend'"),
    (GAIN, "tau = ", "place = ", "Gain.place: 'place' is a word of every block"),
    (GAIN, "tau = ", "tau = other = ", "Gain.tau: is the same object as the parameter 'other'"),
    (GAIN, '("saturation",)', '("saturation")', "Gain.look_alikes: 'saturation' is not a tuple of words"),
    (GAIN, 'look_alikes = ("saturation",)', "", "Gain.look_alikes: is an effect without look-alikes"),
    (GAIN, 'separate_by = "Drive to both polarities."', "", "Gain.separate_by: is an effect without"),
    (GAIN, 'remedy = "Linearise the drive."', "", "Gain.remedy: is an effect without `remedy`"),
    (GAIN, ", null=0", "", "Gain: is an effect without a null"),
    (GAIN, "null=0", "null=0, effect=3", "Gain.bend: effect 3 is no such thing"),
    (GAIN, "null=0", 'null=0, effect=("creep", 3)', r"Gain.bend: effect \('creep', 3\) is not a tuple of words"),
    (GAIN, '("saturation",)', "None", "Gain.look_alikes: None is not a tuple of words"),
    (GAIN, "tau = ", "forms = {'creep': 3}\n    tau = ", "Gain.forms: .* is not a table of blocks"),
    (GAIN, "tau = ", "trials = None\n    tau = ", "Gain.trials: None is not a table"),
    (GAIN, "tau = ", "oversample = 0.5\n    tau = ", "Gain.oversample: 0.5 is not a whole number"),
    (MODES, 'weights = ("push", "shape")', "", "Two.weights: does not name two"),
    (MODES, '("push",', '("pushh",', r"Two.weights: unknown parameter 'pushh'\n.*'push'"),
    (BANK, "4, (1, 10)", "4, None", "Plays.plays: bounds None are no range"),
    (
        BANK,
        "def output",
        "def read(p, weight, half):\n        return weight * p\n\n    def output",
        "Plays.rests: has no",
    ),
    (BANK, "plays = ", "solved = ('omega',)\n    plays = ", "Plays.solve: has no function `solve`"),
    (BANK, "4, (1, 10)", "40, (1, 10)", "Plays.plays: 40 is not a whole number from 1 to 10"),
    (BANK, 'count="plays"', "count=3", "Plays.weight: there are 3 of it for 4 branches"),
    (BANK, "def count", "def number", "Plays.branches: has no `branches`"),
    (MODES, "modes = Setting", "number = Setting", "Two.frequency: is counted by the unknown setting 'modes'"),
]


@pytest.mark.parametrize(("good", "old", "new", "expected"), FUNCTIONS + DECLARED)
def test_a_broken_block_says_what_is_wrong(good, old, new, expected):
    assert old in good
    with pytest.raises(InputError, match=expected):
        check(made(good.replace(old, new, 1)))


OPTIMIZERS = [
    ("@dataclass(frozen=True)\n", "", "Walk: is no frozen dataclass"),
    ('"""Random walk."""', "", "Walk: has no docstring"),
    ('setting(0.1, "range", (0, 1), "Of a step.")', "0.1", "Walk.reach: is made by neither"),
    ("setting(0.1,", "setting(2.0,", "Walk.reach: 2.0 is out of bounds"),
    ("(0, 1)", "None", "Walk.reach: None is no range"),
    ("setting(0.1,", "setting('a',", "Walk.reach: 'a' is not a number"),
    ("def search", "def serch", "Walk.search: has no `search`"),
    ("yield rng", "return rng", "Walk.search: gives ndarray, no generator"),
    ("(self, dimensions, rng)", "(self, rng)", "Walk.search: raises TypeError"),
    ("    reach: ", '    wants = "residual"\n    reach: ', r"Walk.wants: unknown 'residual'\n.*'residuals'"),
    ("    reach: ", "    convergent = 1\n    reach: ", "Walk.convergent: 1 is no yes or no"),
    ("Generational", "Optimizer", "Walk.evaluations: has no `evaluations`"),
    (
        "    def search",
        "    def with_budget(self, n):\n        return n\n\n    def search",
        "Walk.with_budget: gives 1000",
    ),
    ("    def search", "    evaluations = None\n\n    def search", "Walk.evaluations: is None"),
    ("(Generational)", "", "Walk: is no optimizer"),
]


@pytest.mark.parametrize(("old", "new", "expected"), OPTIMIZERS)
def test_a_broken_optimizer_says_what_is_wrong(old, new, expected):
    assert old in WALK
    with pytest.raises(InputError, match=expected):
        optimizers.register(made(WALK.replace(old, new, 1)))
    assert "own" not in optimizers


def test_what_is_no_block_is_not_registered():
    for item in (made("class Nothing:\n    pass"), made(WALK), 3):
        with pytest.raises(InputError, match=r"is no (block|class)"):
            blocks.register(item)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('("saturation",)', '("saturaton",)', r"look_alikes: unknown effect 'saturaton'\n.*'saturation'"),
        ('("saturation",)', '("lumped",)', "look_alikes: 'lumped' is a block, but no effect"),
        ("null=0", 'null=0, effect="crep"', r"bend: unknown effect 'crep'\n.*'creep'"),
    ],
)
def test_effects_that_are_named_are_there_once_all_are_loaded(old, new, expected):
    block = made(GAIN.replace(old, new, 1))
    check(block)
    with pytest.raises(InputError, match=expected):
        check_loaded(block, blocks)


def variants():
    """A function of a sound block with an argument dropped, renamed or added, and where it stands."""
    for good in GOOD:
        block = made(good)
        for word, function in ((word, getattr(block, word)) for word in vars(block) if f"def {word}(" in good):
            names = function.__code__.co_varnames[: function.__code__.co_argcount]
            yield from ((good, word, names, at) for at in range(len(names)))


@given(st.sampled_from(list(variants())), st.sampled_from(["drop", "rename", "add"]), st.text("xyz", min_size=2))
@settings(deadline=None, max_examples=200, derandomize=True)
def test_any_argument_that_is_wrong_is_named(one, how, strange):
    good, word, names, at = one
    ahead, behind = names[:at], names[at + 1 :]
    wrong = (*ahead, *{"drop": (), "rename": (strange,), "add": (names[at], strange)}[how], *behind)
    text = good.replace(f"def {word}({', '.join(names)})", f"def {word}({', '.join(wrong)})")
    assert text != good
    try:
        check(made(text))
    except InputError as error:
        assert error.where.split(".")[1] in (word, "branches") and error.remedy
        named = {strange, names[at]} if how == "rename" else {strange} if how == "add" else {names[at], "missing"}
        assert any(name in str(error) for name in named)
        return
    assert how == "rename" or (how == "drop" and names[at] not in made(good).parameters()), "nothing was said"
    assert not re.search(rf"\b{names[at]}\b", _body(good, word)), "is used, and nothing was said"


def _body(good, word):
    return good.split(f"def {word}(")[1].split(":\n", 1)[1].split("def ")[0]


def test_a_function_further_down_in_the_file_is_waited_for(tmp_path):
    text = GAIN.replace("class Gain", "@blocks.register\nclass Gain").replace("bend * (u * u + w)", "squared(u, bend)")
    own = tmp_path / "own_gain.py"
    own.write_text(
        HEAD + "from pzt_ident.model.registry import blocks\n" + text + "\n\ndef squared(u):\n    return u * u\n"
    )
    try:
        blocks.plug(own)
        with pytest.raises(InputError, match=r"Gain.step: raises TypeError in line \d+: squared"):
            check_loaded(blocks["own_gain"], blocks)
    finally:
        blocks._items.pop("own_gain", None)
        sys.modules.pop("pzt_ident_plugins.own_gain", None)


def test_the_command_line_begins_without_numpy():
    code = "import sys, pzt_ident.cli.commands, pzt_ident.model.contract; print({'numpy', 'numba'} & set(sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "set()"
