"""A job file is read as it is written, and every fault in it is reported with its place, value and remedy."""

from __future__ import annotations

import pickle
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pzt_ident.data.record import Axis, Channel, Level, Source
from pzt_ident.errors import InputError
from pzt_ident.job.schema import Job, load_job
from pzt_ident.job.sections import Choice, Quantity, Setting
from pzt_ident.model.optimizer import Generational, setting
from pzt_ident.model.registry import blocks, optimizers

GOOD = """\
name: stage
records:
  - {file: a.csv, use: identify, sample_rate: 0.2 kHz, settle: 500 ms}
  - {file: "${DATA}/b.mat", use: validate, rows: [10, 200], time: [0 s, 2], index: [":", 0]}
channels:
  time: "time [s]"
  axes:
    x: {drive: "u_x [V]", response: {column: 5, unit: um}}
    y: {drive: "u_y [V]"}
model: [bouc_wen, lumped]
effects: [cross_coupling]
parameters:
  bouc_wen.alpha: {bounds: [1e-6, 1]}
  x.lumped.mass: {value: 0.1566}
optimizers:
  - {name: fake, population: 40, pull: 1.5}
repeats: 3
seed: 11
polish: false
stop: {target: 0.1 um, seconds: 2 min, evaluations: 900, stagnation: 8}
"""


@pytest.fixture(autouse=True)
def fake(monkeypatch):
    """An optimizer whose two numbers must agree."""

    @dataclass(frozen=True)
    class Fake(Generational):
        name = "fake"
        pull: float = setting(2.0, "1", (0, 10), "Pull.")
        push: float = setting(1.0, "1", (0, 10), "Push.")

        def __post_init__(self):
            super().__post_init__()
            if self.pull < self.push:
                raise InputError("pull is below push", where="fake", remedy="pull harder")

        def search(self, dimensions, rng):
            yield rng.random((self.population, dimensions))

    monkeypatch.setitem(optimizers._items, "fake", Fake)


def faults(text: str) -> str:
    with pytest.raises(InputError) as caught:
        Job.from_text(text, file="job.yaml")
    return str(caught.value)


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ("0 V", {"x": Level(0.0, "V"), "y": Level(0.0, "V")}),
        ("-5", {"x": Level(-5.0), "y": Level(-5.0)}),
        ("{y: 0.1 kV}", {"y": Level(0.1, "kV")}),
        ("null", None),
    ],
)
def test_a_drive_of_rest_is_one_of_all_axes_or_by_axis(written, read):
    job = Job.from_text(GOOD.replace("settle: 500 ms", f"rest_at: {written}"), Path())
    assert job.records[0].rest_at == read and job.records[1].rest_at is None


def test_every_key_is_read():
    job = Job.from_text(GOOD, Path("here"))
    assert job.name == "stage"
    assert job.records == (
        Source("a.csv", sample_rate=200.0, settle=0.5),
        Source("${DATA}/b.mat", "validate", rows=(10, 200), time=(0.0, 2.0), index=(":", 0)),
    )
    assert job.channels.time == Channel("time [s]")
    assert job.channels.axes == {
        "x": Axis(Channel("u_x [V]"), Channel(column=5, unit="um")),
        "y": Axis(Channel("u_y [V]")),
    }
    assert (job.model, job.effects) == (("bouc_wen", "lumped"), ("cross_coupling",))
    assert job.parameters == {"bouc_wen.alpha": Setting(bounds=(1e-6, 1)), "x.lumped.mass": Setting(value=0.1566)}
    assert job.optimizers == (Choice("fake", {"population": 40, "pull": 1.5}),)
    assert (job.repeats, job.seed, job.polish) == (3, 11, False)
    assert job.stop.target == Quantity(0.1, "um")
    assert (job.stop.seconds, job.stop.evaluations, job.stop.stagnation) == (120, 900, 8)
    assert (job.text, job.folder) == (GOOD, Path("here"))


def test_an_axis_without_a_response_may_have_bounds_for_what_a_coupling_shows_of_it():
    given = Job.from_text(GOOD.replace("bouc_wen.alpha", "y.bouc_wen.alpha")).parameters
    assert given["y.bouc_wen.alpha"].bounds == (1e-6, 1)


def test_short_job_has_defaults():
    text = 'records: [{file: a.csv}]\nchannels: {axes: {x: {drive: "u [V]", response: "x [um]"}}}\nmodel: [bouc_wen]\n'
    job = Job.from_text(text, file="folder/creep test.yaml")
    assert job.name == "creep test"
    assert job.records[0].use == "identify"
    assert job.optimizers == (Choice("pso"),)
    assert (job.repeats, job.seed, job.polish, job.effects, job.parameters) == (1, 0, True, (), {})


@pytest.mark.parametrize(
    ("file", "name"), [("a/x-axis.yaml", "x-axis"), ("Tisch (1).yml", "Tisch -1"), ("µ.yaml", "µ"), ("(!).yaml", "job")]
)
def test_a_job_without_a_name_has_that_of_its_file(file, name):
    assert Job.from_text(GOOD.replace("name: stage\n", ""), file=file).name == name


def test_hash_is_of_the_content():
    job = Job.from_text(GOOD)
    assert job.hash == Job.from_text("# a comment\n" + GOOD.replace("0.2 kHz", "200")).hash
    assert job.hash != Job.from_text(GOOD.replace("seed: 11", "seed: 12")).hash
    assert len(job.hash) == 8
    assert hash(job) == hash(pickle.loads(pickle.dumps(job)))


def test_job_is_frozen():
    with pytest.raises(ValueError, match="frozen"):
        Job.from_text(GOOD).seed = 3


def test_round_trip_keeps_text_and_folder():
    job = pickle.loads(pickle.dumps(Job.from_text(GOOD, Path("here"))))
    assert (job.text, job.folder) == (GOOD, Path("here"))


ONE_FAULT = [
    ("name: stage", "nmae: stage", "1:1: nmae: unknown key 'nmae'", "did you mean 'name'?"),
    ("name: stage", "name: a/b", "1:7: name: 'a/b' is not a name for a folder", "use letters"),
    ("name: stage", "name: 3", "1:7: name: 3 is not a text", "put it in quotes"),
    ("use: identify", "use: identfy", "3:24: records[0].use: 'identfy' is not 'identify' or 'validate'", "write"),
    ("use: identify", "use: validate", "3:3: records: no identification record", "use: identify"),
    ("file: a.csv, ", "", "3:5: records[0]: missing key 'file'", "add `file: ...`"),
    ("{name: fake", "{nmae: fake", "optimizers[0]: missing key 'name'", "or write it for 'nmae'"),
    ("file: a.csv", 'file: " "', "3:12: records[0].file: ' ' names no file", "relative to the job"),
    ("settle: 500 ms", "setle: 500 ms", "3:56: records[0].setle: unknown key 'setle'", "'settle'"),
    ("0.2 kHz", "5 ms", "3:47: records[0].sample_rate: '5 ms' is not in Hz", "a unit such as Hz"),
    ("0.2 kHz", "fast", "3:47: records[0].sample_rate: 'fast' is not a number with a unit", "such as `1 Hz`"),
    ("0.2 kHz", "0", "3:47: records[0].sample_rate: 0 Hz", "above 0 Hz"),
    ("0.2 kHz", "2 lightyears", "unknown unit 'lightyears'", "known"),
    ("0.2 kHz", "true", "3:47: records[0].sample_rate: true is not a number", "write a plain number"),
    ("500 ms", "-1", "3:64: records[0].settle: -1 is too small", "at least 0"),
    ("500 ms", ".nan", "3:64: records[0].settle: .nan is not a finite number", "plain number"),
    ("settle: 500 ms", "rest_at: true", "3:65: records[0].rest_at: true is not a number", "plain number"),
    ("settle: 500 ms", "rest_at: 0 mile", "3:65: records[0].rest_at: unknown unit 'mile'", "known"),
    ("settle: 500 ms", "rest_at: [0 V]", "3:65: records[0].rest_at: is a list", "such as `0 V`"),
    ("settle: 500 ms", "rest_at: {z: 0}", "3:66: records[0].rest_at.z: there is no axis 'z'", "x, y"),
    ("settle: 500 ms", "rest_at: {x: low}", "3:69: records[0].rest_at.x: 'low' is not a number", "such as `0 V`"),
    ("settle: 500 ms", "rest_at: 0, run_in: 1", "3:65: records[0].rest_at: a record of a steady", "keep one of"),
    ("settle: 500 ms", "rest_at: 0, decimate: 2", "3:65: records[0].rest_at: a step takes one", "keep one of"),
    ("settle: 500 ms", "decimate: 0", "records[0].decimate: 0 is too small", "at least 1"),
    ("settle: 500 ms", "steps: 0", "records[0].steps: 0 is too small", "at least 1"),
    ("settle: 500 ms", "steps: 101", "records[0].steps: 101 steps a sample", "at most 100"),
    ("settle: 500 ms", "decimate: 1.5", "records[0].decimate: 1.5 is not a whole number", "whole number"),
    ("[10, 200]", "[200, 10]", "4:50: records[1].rows: ends at 10, at or before its start", "earlier first"),
    ("[10, 200]", "[10]", "4:50: records[1].rows: a list of 1 is not [first, second]", "write both"),
    ("[10, 200]", "[1, 2, 3]", "4:50: records[1].rows: a list of 3 is not a list of 2", "give 2 values"),
    ("[10, 200]", "[-5, 10]", "4:51: records[1].rows[0]: -5 is before the start", "count from 0"),
    ('[":", 0]', "[1.5]", "records[1].index[0]: 1.5 is not a whole number or a text", "put it in quotes"),
    ("response:", "respnse:", "8:27: channels.axes.x.respnse: unknown key 'respnse'", "did you mean 'response'"),
    (', response: {column: 5, unit: um}', "", "channels.axes: no axis has a response", "give at least one axis"),
    ("repeats: 3", "repeats: 1000000000", "17:10: repeats: 1000000000 is not at most 1000", "give at most 1000"),
    ("seed: 11", "limits: {drive: [100, 0]}", "18:17: limits.drive: [100, 0] are no limits", "[lowest, highest]"),
    (
        '{drive: "u_y [V]"}',
        '{drive: "u_y [V]", response: {column: 5, unit: um}}',
        "9:37: channels.axes.y.response: is the same channel as that of axis x",
        "its own",
    ),
    ("{column: 5, unit: um}", '"u_x [V]"', "8:37: channels.axes.x.response: is the same channel as", "displacement"),
    ('{drive: "u_y [V]"}', "{}", "9:8: channels.axes.y: missing key 'drive'", "add `drive: ...`"),
    ("column: 5", "column: 0", "8:46: channels.axes.x.response.column: there is no column 0", "count from 1"),
    ("column: 5", 'column: "x"', "8:46: channels.axes.x.response.column: 'x' is not a whole number", "such as 5"),
    ("column: 5, ", "", "8:37: channels.axes.x.response: names no channel", "header"),
    ("unit: um", "unit: mu", "8:55: channels.axes.x.response.unit: unknown unit 'mu'", "did you mean"),
    ("    y:", "    bouc_wen:", "9:5: channels.axes.bouc_wen: 'bouc_wen' cannot name an axis", "such as x"),
    ("[bouc_wen, lumped]", "[bouc_wenn, lumped]", "10:9: model[0]: unknown block 'bouc_wenn'", "'bouc_wen'"),
    ("[bouc_wen, lumped]", "bouc_wen", "10:8: model: 'bouc_wen' is not a list", "[first, second]"),
    ('{drive: "u_y [V]"}', "5", "channels.axes.y: 5 is not a mapping", "with some of drive, response"),
    ("{name: fake, population: 40, pull: 1.5}", "5", "optimizers[0]: 5 is not a mapping", "some of name, its settings"),
    ("{value: 0.1566}", "0.1566", "x.lumped.mass: 0.1566 is not a mapping", "write it as {value: 0.1566}"),
    ("x.lumped.mass: {value: 0.1566}", "lumped.mass: {x: {value: 1}}", "unknown key 'x'", "is `x.lumped.mass`"),
    ("[bouc_wen, lumped]", "[preisach]", "10:9: model[0]: unknown block 'preisach'", "homogenized_energy speaks of it"),
    ("[1e-6, 1]", "[1, 1]", "13:28: parameters.bouc_wen.alpha.bounds: both bounds are 1", "`value: 1`"),
    ("repeats: 3", "noise_floor: 5 nm", "17:1: noise_floor: unknown key 'noise_floor'", "is taken from the data"),
    ("lumped]", "{name: lumpd}]", "10:26: model[1].name: unknown block 'lumpd'", "did you mean 'lumped'"),
    ("lumped]", "{name: lumped, size: 3}]", "10:34: model[1].size: unknown setting 'size'", "write just `lumped`"),
    ("lumped]", "{size: 3}]", "10:19: model[1]: missing key 'name'", "add `name: ...`"),
    ("lumped]", "3]", "10:19: model[1]: 3 is not a text", "put it in quotes"),
    (
        "[cross_coupling]",
        "[cross_coupling, cross_coupling.voltage]",
        "11:27: effects[1]: duplicate effect 'cross_coupling', of which a form is here already",
        "keep one of the two",
    ),
    (
        "effects: [cross_coupling]",
        "effects: [cross_coupling]\nrule_out: [creep.voltage]",
        "12:12: rule_out[0]: 'creep.voltage' is a form",
        "rule out the effect with all its forms: creep",
    ),
    ("[cross_coupling]", "[cros_coupling]", "11:11: effects[0]: unknown effect 'cros_coupling'", "'cross_coupling'"),
    ("[cross_coupling]", "[lumped]", "11:11: effects[0]: 'lumped' is not an effect", "move it to `model: [lumped]`"),
    ('    y: {drive: "u_y [V]"}\n', "", "10:11: effects[0]: 'cross_coupling' needs a second axis", "`drive`"),
    ("bouc_wen.alpha", "bouc_wen.alhpa", "13:3: parameters.bouc_wen.alhpa: 'bouc_wen' has no", "bouc_wen.alpha"),
    ("bouc_wen.alpha", "z.bouc_wen.alpha", "13:3: parameters.z.bouc_wen.alpha: there is no axis 'z'", "known: x, y"),
    ("bouc_wen.alpha", "alpha", "13:3: parameters.alpha: unknown parameter 'alpha'", "bouc_wen.alpha"),
    ("bouc_wen.alpha", "prandtl_ishlinskii.gain", "'prandtl_ishlinskii' is not in this model", "`model`"),
    ("repeats: 3", "shared: [lumped.mas]", "17:10: shared[0]: unknown parameter 'lumped.mas'", "'lumped.mass'"),
    ("[1e-6, 1]", "[1, 1e-6]", "13:28: parameters.bouc_wen.alpha.bounds: bounds reversed", "[low"),
    ("[1e-6, 1]", "[0, .inf]", "13:32: parameters.bouc_wen.alpha.bounds[1]: .inf is not a finite", "plain"),
    ("[1e-6, 1]}", "[0, 1], value: 2}", "13:43: parameters.bouc_wen.alpha.value: beside `bounds`", "keep one"),
    ("{bounds: [1e-6, 1]}", "{}", "13:19: parameters.bouc_wen.alpha: sets nothing", "bounds: [low, high]"),
    ("value: 0.1566", "value: -1", "14:18: parameters.x.lumped.mass: -1 is not above 0", "above 0"),
    ("name: fake", "name: fakee", "16:12: optimizers[0].name: unknown optimizer 'fakee'", "did you mean 'fake'"),
    ("name: fake, ", "", "16:5: optimizers[0]: missing key 'name'", "add `name: ...`"),
    ("pull: 1.5", "pul: 1.5", "16:34: optimizers[0].pul: unknown setting 'pul'", "did you mean 'pull'"),
    ("pull: 1.5", "pull: 0.5", "16:5: optimizers[0]: pull is below push", "pull harder"),
    ("pull: 1.5", "pull: 11", "16:40: optimizers[0].pull: 11 is out of bounds", "from 0 to 10"),
    ("population: 40", "population: 4.5", "16:30: optimizers[0].population: 4.5 is not a whole number", "from 4"),
    ("pull: 1.5}", "pull: 1.5}\n  - fake", "17:5: optimizers[1]: 'fake' twice", "keep one"),
    ("repeats: 3", "repeats: 0", "17:10: repeats: 0 is not at least 1", "give at least 1"),
    ("seed: 11", "seed: -1", "18:7: seed: -1 is not at least 0", "give at least 0"),
    ("seed: 11", "seed: [1]", "18:7: seed: a list of 1 is not a whole number", "such as 5"),
    ("polish: false", "polish: yes", "19:9: polish: 'yes' is not true or false", "write true or false"),
    ("polish: false", "polish: on", "19:9: polish: 'on' is not true or false", "write true or false"),
    ("polish: false", "polish:", "19:1: polish: nothing is not true or false", "write true or false"),
    ("polish: false", "seed: 3", "19:1: duplicate key 'seed'", "keep one of the two"),
    ("0.1 um", "0.1 parsec", "20:16: stop.target: unknown unit 'parsec'", "did you"),
    ("0.1 um", "0", "20:16: stop.target: 0 is not above 0", "above 0"),
    ("2 min", "2 um", "20:33: stop.seconds: '2 um' is not in s", "a unit such as s"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "expected", "remedy"), ONE_FAULT, ids=[expected for *_, expected, _ in ONE_FAULT]
)
def test_a_fault_is_told_with_place_value_and_remedy(old, new, expected, remedy):
    assert GOOD.count(old) == 1
    message = faults(GOOD.replace(old, new))
    first, advice = message.split("\n")
    assert first.startswith("job.yaml:")
    assert expected in first
    assert remedy in advice


@pytest.mark.parametrize(
    ("where", "shown"),
    [
        ("stop.target", "job.yaml:20:16: stop.target: does not fit"),
        ("x.lumped.mass", "job.yaml:14:18: parameters.x.lumped.mass: does not fit"),
        ("lumped.damping", "job.yaml: lumped.damping: does not fit"),
        ("a.csv", "a.csv: does not fit"),
    ],
)
def test_what_the_data_refuse_of_a_job_has_its_place_in_the_file(where, shown):
    with pytest.raises(InputError) as error, Job.from_text(GOOD).placed():
        raise InputError("does not fit", where=where, remedy="change it")
    assert str(error.value) == f"{shown}\n  change it"
    with pytest.raises(InputError, match=f"^{where}: does"), Job.from_text(GOOD, file="").placed():
        raise InputError("does not fit", where=where)


ROD = GOOD.replace("lumped]", "{name: rod, elements: 9, modes: 3}]").replace("x.lumped.mass", "x.rod.density")


def test_a_block_may_have_settings():
    job = Job.from_text(ROD)
    assert job.model == ("bouc_wen", Choice("rod", {"elements": 9, "modes": 3}))
    assert job == pickle.loads(pickle.dumps(job))
    assert [block.chosen_settings for block in blocks.chain(job.model)] == [{}, {"elements": 9, "modes": 3}]


@pytest.mark.parametrize(
    ("old", "new", "expected", "remedy"),
    [
        ("elements", "elemnts", "10:31: model[1].elemnts: unknown setting 'elemnts'", "did you mean 'elements'"),
        ("elements: 9", "elements: 2.5", "10:41: model[1].elements: 2.5 is not a whole number from 1 to 100", "give a"),
        ("elements: 9", "elements: 8", "10:19: model[1]: 8 elements are too few for mode 3", "`elements: 9`"),
    ],
)
def test_a_setting_that_does_not_fit_is_told(old, new, expected, remedy):
    first, advice = faults(ROD.replace(old, new)).split("\n")
    assert expected in first and remedy in advice


def test_two_operators_do_not_go_together():
    message = faults(GOOD.replace("[bouc_wen, lumped]", "[bouc_wen, lumped, prandtl_ishlinskii]"))
    assert "10:27: model[2]: 'prandtl_ishlinskii' beside 'bouc_wen': two blocks of hysteresis" in message


def test_what_was_before_a_record_is_no_model_by_itself():
    message = faults(GOOD.replace("[bouc_wen, lumped]", "[history]"))
    assert "10:8: model: nothing responds to the drive beside 'history'" in message


def test_a_form_that_a_block_does_not_have_is_told():
    message = faults(GOOD.replace("[bouc_wen, lumped]", "[history.tow, bouc_wen, lumped]"))
    assert "10:9: model[0]: history.form: 'tow' is no such form\n  did you mean 'two'?" in message


def test_something_must_be_left_to_identify():
    fixed = "".join(f"  bouc_wen.{word}: {{value: 0.5}}\n" for word in ("gain", "alpha", "beta", "gamma"))
    text = GOOD.replace(", lumped]", "]").replace("effects: [cross_coupling]\n", "")
    start, end = text.index("  bouc_wen.alpha"), text.index("optimizers:")
    message = faults(text[:start] + fixed + text[end:])
    assert message.startswith("job.yaml:12:3: parameters: every parameter is fixed\n  free at least one")


def test_an_effect_among_the_blocks_is_moved():
    message = faults(GOOD.replace("[bouc_wen, lumped]", "[bouc_wen, lumped, cross_coupling]"))
    assert "model[2]: 'cross_coupling' is an effect\n  move it to `effects: [cross_coupling]`" in message


def test_a_term_needs_its_block():
    message = faults(GOOD.replace("[cross_coupling]", "[load_mass]").replace("lumped]", "bouc_wen_oscillator]"))
    assert "11:11: effects[0]: no block of this model has a term for 'load_mass'\n" in message
    assert "put one of these into `model`: lumped" in message
    message = faults(GOOD.replace("[cross_coupling]", "[cubic_stiffness]").replace("lumped]", "rod]"))
    assert "put one of these into `model`: lumped, or write `cubic_stiffness.rest` here" in message


def test_a_mapping_in_the_place_of_a_list_is_put_in_brackets():
    message = faults(GOOD.replace("  - {name: fake, population: 40, pull: 1.5}", "  {name: fake, population: 40}"))
    assert "optimizers: a mapping is not a list\n  put it in brackets, [{...}]" in message


def test_a_parameter_of_a_term_needs_its_effect():
    text = GOOD.replace("x.lumped.mass: {value: 0.1566}", "lumped.load: {bounds: [0, 0.2]}")
    assert "'load_mass'\n  add `effects: [load_mass]`" in faults(text)
    Job.from_text(text.replace("[cross_coupling]", "[load_mass]"))


def test_all_faults_come_at_once_in_order():
    text = GOOD
    changes = {"use: identify": "use: identfy", "500 ms": "-1", "lumped]": "lumpd]", "[1e-6, 1]": "[2, 1]"}
    changes |= {"name: fake": "name: fakee", "seed: 11": "seed: x", "repeats: 3": "repats: 3"}
    for old, new in changes.items():
        text = text.replace(old, new)
    lines = faults(text).splitlines()
    assert lines[0] == "job.yaml has 7 faults"
    places = [line.split(":")[1] for line in lines if line.startswith("job.yaml:")]
    assert places == ["3", "3", "10", "13", "16", "17", "18"]


@pytest.mark.parametrize(
    ("text", "expected", "remedy"),
    [
        ("", "job.yaml:1:1: the job is empty", "records"),
        ("# only a comment\n", "job.yaml:1:1: the job is empty", "records"),
        ("- name: stage\n", "job.yaml:1:1: the job is a list", "records"),
        ("0.0,1.0\n0.1,2.0\n", "job.yaml:1:1: the job is one value", "records"),
        ("a:\n\tb: 1\n", "job.yaml:2:1: not YAML", "spaces, not tabs"),
        ("x: {drive: u_x [V]}\n", "job.yaml:1:16: not YAML", "in quotes"),
        ("file: {name: ${DATA}/a.csv}\n", "job.yaml:1:15: not YAML", "in quotes"),
        ("a: 1\n---\nb: 2\n", "job.yaml:2:1: not YAML", "remove the line ---"),
        ("a: *nothing\n", "job.yaml:1:4: not YAML", "init"),
        ("a: \x01\n", "job.yaml:1:1: not YAML", "init"),
        ("a: &loop [*loop]\n", "job.yaml:1:4: too many values", "without nested anchors"),
        ("[" * 1100, "job.yaml:1:1: nested too deeply", "a few levels"),
        ("a: 1\n" * 300_000, "job.yaml:1:1: 1500000 characters", "is this a data file?"),
        (GOOD + "? [a, b]\n: 1\n", "job.yaml:21:3: a key must be a word", "key: value"),
        (GOOD.replace("a.csv", '"a\\0"'), "job.yaml:3:12: 'a\\x00' has a character that is not allowed", "remove it"),
    ],
    ids=lambda value: value[:40],
)  # fmt: skip
def test_what_is_no_job(text, expected, remedy):
    first, advice = faults(text).split("\n")
    assert first.startswith(expected)
    assert remedy in advice


def test_anchors_cannot_explode():
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 12)]
    assert "too many values" in faults("\n".join(lines))


def test_an_alias_is_read():
    text = GOOD.replace("file: a.csv", "file: &file a.csv").replace('"${DATA}/b.mat"', "*file")
    assert Job.from_text(text).records[1].file == "a.csv"


@pytest.mark.parametrize("tag", ["!!python/object/apply:os.system", "!!python/name:os.system", "!local", "!!binary"])
@pytest.mark.parametrize("value", ["[touch hacked]", "touch", "{a: 1}"])
def test_a_tag_names_no_code(tag, value, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    message = faults(GOOD + f"note: {tag} {value}\n")
    assert f"job.yaml:21:7: the tag {tag!r} is not allowed" in message
    assert "a job file can name no code" in message
    assert not list(tmp_path.iterdir())


def test_words_stay_words_under_an_old_directive():
    assert "polish: yes is not true or false" in faults("%YAML 1.1\n---\n" + GOOD.replace("false", "yes"))


def test_axis_names_may_look_like_yaml():
    text = GOOD.replace("    x:", "    n:").replace("x.lumped", "n.lumped")
    assert list(Job.from_text(text).channels.axes) == ["n", "y"]


@pytest.mark.parametrize("number", ["1e-6", "1E-6", "1.e-6", "0.000001", "+1e-06"])
def test_numbers_are_numbers(number):
    assert Job.from_text(GOOD.replace("1e-6", number)).parameters["bouc_wen.alpha"].bounds == (1e-6, 1)


class TestFile:
    def test_is_read_with_its_folder(self, tmp_path):
        path = tmp_path / "job.yaml"
        path.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
        job = load_job(path)
        assert (job.name, job.folder) == ("stage", tmp_path)

    def test_missing(self, tmp_path):
        (tmp_path / "job.yaml").touch()
        with pytest.raises(InputError, match=r"jbo.yaml: no such file\n  did you mean 'job.yaml'\?"):
            load_job(tmp_path / "jbo.yaml")

    def test_in_no_folder(self, tmp_path):
        with pytest.raises(InputError, match="no such file\n  `pzt-ident init DIR`"):
            load_job(tmp_path / "none" / "job.yaml")

    def test_folder(self, tmp_path):
        with pytest.raises(InputError, match="is a folder\n  give the job file"):
            load_job(tmp_path)

    def test_not_utf8(self, tmp_path):
        path = tmp_path / "job.yaml"
        path.write_bytes("name: stage\n# für\n".encode("latin-1"))
        with pytest.raises(InputError, match=r"job.yaml:2:4: byte 0xfc is not UTF-8\n  save the file as UTF-8"):
            load_job(path)

    def test_utf16(self, tmp_path):
        path = tmp_path / "job.yaml"
        path.write_text(GOOD, encoding="utf-16")
        with pytest.raises(InputError, match=r"job.yaml:1:1: byte 0xff is not UTF-8"):
            load_job(path)


EDITS = st.tuples(
    st.integers(0, len(GOOD)), st.integers(0, 12), st.text("[]{}:,-#&*!|>'\"%@\n\t 09.eyn\\\x00é") | st.text(max_size=5)
)


@settings(max_examples=60, deadline=None)
@given(st.lists(EDITS, min_size=1, max_size=6))
def test_mangled_text_is_a_job_or_an_input_error(edits):
    text = GOOD
    for place, length, insert in edits:
        text = text[:place] + insert + text[place + length :]
    try:
        assert isinstance(Job.from_text(text), Job)
    except InputError as error:
        assert "job.yaml" in str(error)


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=8,
)
KEYS = ("name", "records", "channels", "model", "effects", "parameters", "optimizers", "repeats", "seed", "stop")


@settings(max_examples=60, deadline=None)
@given(st.dictionaries(st.sampled_from(KEYS), VALUES, min_size=1, max_size=4))
def test_any_value_at_any_key_is_a_job_or_an_input_error(replaced):
    import io

    from ruamel.yaml import YAML

    yaml = YAML(typ="safe", pure=True)
    out = io.StringIO()
    yaml.dump(yaml.load(GOOD) | replaced, out)
    try:
        assert isinstance(Job.from_text(out.getvalue()), Job)
    except InputError as error:
        assert "job.yaml" in str(error)
