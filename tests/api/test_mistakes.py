"""A mistake is answered by one sentence that names the argument and the value, and a remedy."""

import warnings

import numpy as np
import pandas as pd
import pytest

import pzt_ident as pzt

N = 300
T = np.arange(N) / 100
U = 50 - 50 * np.cos(2 * T)
Y = 0.1 * U + np.random.default_rng(1).normal(0, 0.01, N)


def record(t=T, u=U, y=Y, **more):
    return pzt.Record(t, u, y, **more)


def identify(*records, model="bouc_wen", **more):
    return pzt.identify(model, list(records) or record(), **({"evaluations": 20, "polish": False} | more))


def changed(values, value, place=5):
    return np.where(np.arange(N) == place, value, values)


def frame(**more):
    return pzt.Record.from_frame(pd.DataFrame({"t [s]": T, "u [V]": U, "n": Y}), **more)


def bounded(value, name="bouc_wen.alpha"):
    return lambda: identify(bounds={name: value})


RECORDS = {
    "y: axis x has the shape (299,), not (300,)": lambda: record(y=Y[1:]),
    "u: axis x has the shape (299,), not (300,)": lambda: record(u=U[1:]),
    "y: an array of shape (300, 2) for the drive of x": lambda: record(y=np.array([Y, Y]).T),
    "y: axis 'y' has no drive": lambda: record(u={"x": U}, y={"y": Y}),
    "u: is missing": lambda: record(u=None),
    "u: holds no axis": lambda: record(u={}, y=None),
    "u: holds something that is no number": lambda: record(u=["a"] * N),
    "y: holds something that is no number": lambda: record(y=Y + 1j),
    "t: '1 ms' is no sample rate": lambda: record(t="1 ms"),
    "t: '1.2.3 Hz' is no sample rate": lambda: record(t="1.2.3 Hz"),
    "t: None is no sample rate": lambda: record(t=None),
    "t: the sample rate 0 Hz is not positive": lambda: record(t=0),
    "t: an array of shape (2, 150)": lambda: record(t=T.reshape(2, -1)),
    "drive: unknown unit 'v'": lambda: record(drive="v"),
    "response: unknown unit 'mikron'": lambda: record(response="mikron"),
    "drive: None is no unit": lambda: record(drive=None),
    "drive: no unit of axis x": lambda: record(drive={"y": "V"}),
    "settle: '5 V' is no time": lambda: record(settle="5 V"),
    "settle: -1 is no time": lambda: record(settle=-1),
    "name: 3 is no text": lambda: record(name=3),
    "has 2 samples, at least 3 are needed": lambda: record(T[:2], U[:2], Y[:2]),
    "frame: has no column 'time'": lambda: frame(time="time", drive="u [V]"),
    "frame: column 'n' has no unit": lambda: frame(time=100, drive="u [V]", response="n"),
    "frame: time: V is no unit of time": lambda: frame(time="u [V]", drive="u [V]"),
    "frame: NoneType is no frame": lambda: pzt.Record.from_frame(None, time=1, drive="u"),
    "no/such.csv: no such file": lambda: pzt.Record.read("no/such.csv", drive="u"),
    "read: ['u'] is no channel": lambda: pzt.Record.read("a.csv", drive=["u"]),
    "rows: 5 is no pair of rows": lambda: pzt.Record.read("a.csv", drive="u", rows=5),
}
IDENTIFY = {
    "train: y: axis x: 1 value is missing: row 5": lambda: identify(record(y=changed(Y, np.nan))),
    "train: u: axis x: 1 value is infinite: row 5": lambda: identify(record(u=changed(U, np.inf))),
    "train: t: 1 value is missing: row 5": lambda: identify(record(t=changed(T, np.nan))),
    "train: y: axis x: the response is constant": lambda: identify(record(y=0 * Y)),
    "train: the drive of axis x is constant": lambda: identify(record(u=0 * U)),
    "train: t: time is not uniform": lambda: identify(record(t=T**1.1)),
    "train: t: time runs backward": lambda: identify(record(t=T[::-1])),
    "train: settle 99 s leaves nothing": lambda: identify(record(settle=99)),
    "record: rest_at: 'low' is no drive in V": lambda: record(rest_at="low"),
    "record: rest_at: '3 um' is no drive in V": lambda: record(rest_at="3 um"),
    "record: rest_at: inf is no drive in V": lambda: record(rest_at=np.inf),
    "record: rest_at: axis 'z' has no drive": lambda: record(rest_at={"z": 0}),
    "record: rest_at: a record of a steady state": lambda: record(rest_at=0, run_in=1),
    "run_in: 2.5 is not a whole number": lambda: identify(record(run_in=2.5)),
    "train: y: no axis has a response": lambda: identify(record(y=None)),
    "train: no record to identify from": lambda: pzt.identify("bouc_wen", []),
    "train: ndarray is no Record": lambda: identify(T, U, Y),
    "train: two records are named 'a'": lambda: identify(record(name="a"), record(name="a")),
    "validate: str is no Record": lambda: identify(validate="test.csv"),
    "validate: a record has the axes y, not x": lambda: identify(validate=record(u={"y": U}, y={"y": Y})),
    "test: axis x is in V": lambda: identify(validate=record(response="V")),
    "model: no block": lambda: pzt.Model(),
    "model: unknown block 'boucwen'": lambda: identify(model="boucwen"),
    "model: list is no Model": lambda: identify(model=["bouc_wen"]),
    "rod: unknown setting 'elemnts'": lambda: pzt.Model("bouc_wen", {"name": "rod", "elemnts": 3}),
    "effects: unknown effect 'crep'": lambda: pzt.Model("bouc_wen", effects="crep"),
    "effects: 'creep' occurs twice": lambda: pzt.Model("bouc_wen", effects=["creep", "creep"]),
    "effects: 'cross_coupling' needs a second axis": lambda: identify(
        model=pzt.Model("bouc_wen", effects="cross_coupling")
    ),
    "unknown parameter 'bouc_wen.alfa'": lambda: identify(model=pzt.Model("bouc_wen", shared="bouc_wen.alfa")),
    "bouc_wen.alfa: 'bouc_wen' has no parameter 'alfa'": bounded((0, 1), "bouc_wen.alfa"),
    "lumped.mass: 'lumped' is not in this model": bounded((0, 1), "lumped.mass"),
    "y.bouc_wen.alpha: there is no axis 'y'": bounded((0, 1), "y.bouc_wen.alpha"),
    "bounds: bouc_wen.alpha: bounds reversed, 1 is not below 0": bounded((1, 0)),
    "bounds: bouc_wen.alpha: .inf is not a finite number": bounded((0, np.inf)),
    "bounds: bouc_wen.alpha: 1 is no pair": bounded(1),
    "bounds: list is no Mapping": lambda: identify(bounds=["bouc_wen.alpha"]),
    "fixed: bouc_wen.alpha: 'a' is not a number": lambda: identify(fixed={"bouc_wen.alpha": "a"}),
    "fixed: bouc_wen.alpha: None is no value": lambda: identify(fixed={"bouc_wen.alpha": None}),
    "fixed: 'bouc_wen.alpha' has bounds and a value": lambda: identify(
        bounds={"bouc_wen.alpha": (0, 1)}, fixed={"bouc_wen.alpha": 0.5}
    ),
    "optimizer.name: unknown optimizer 'psoo'": lambda: identify(optimizer="psoo"),
    "optimizer.popul: unknown setting 'popul'": lambda: identify(optimizer={"name": "pso", "popul": 40}),
    "optimizer: int is no Mapping": lambda: identify(optimizer=3),
    "seed: Generator is no plain value": lambda: identify(seed=np.random.default_rng(1)),
    "seed: '7' is not a whole number": lambda: identify(seed="7"),
    "evaluations: 0 is not at least 1": lambda: identify(evaluations=0),
    "repeats: 0 is not at least 1": lambda: identify(repeats=0),
    "name: 'a/b' is not a name for a folder": lambda: identify(name="a/b"),
}
OF_A_FIT = {
    "add: unknown effect 'crep'": lambda fit, _: fit.add("crep"),
    "add: unknown effect None": lambda fit, _: fit.add(None),
    "add: 'creep' is in the model already": lambda fit, _: fit.add("creep"),
    "this folder is not empty": lambda fit, folder: fit.save(folder),
    "save: None is no path": lambda fit, _: fit.save(None),
    "cannot be written": lambda fit, folder: fit.report(folder),
    "result.json: file is missing": lambda _, folder: pzt.load(folder),
    "load: 3 is no path": lambda *_: pzt.load(3),
    "simulate: u: drives x, y, the model has x": lambda fit, _: fit.simulate(T, [U, U]),
    "simulate: u: drives y, the model has x": lambda fit, _: fit.simulate(T, {"y": U}),
    "simulate: u: axis x is in um, the model takes V": lambda fit, _: fit.simulate(record(drive="um")),
    "drive: u: is missing": lambda fit, _: fit.simulate(T),
    "drive: u: axis x has the shape (299,)": lambda fit, _: fit.simulate(T, U[1:]),
    "drive: u: axis x: 1 value is missing": lambda fit, _: fit.simulate(T, changed(U, np.nan)),
    "drive: t: time is not uniform": lambda fit, _: fit.simulate(T**1.1, U),
    "plot: there is no record 'fast'": lambda fit, _: fit.plot("fast"),
    "plot: there is no axis 'y'": lambda fit, _: fit.plot(axis="y"),
    "plot: -1 is no width": lambda fit, _: fit.plot(width=-1),
    "parameters: unknown parameter 'alpha'": lambda fit, _: fit.parameters["alpha"],
    "fit: str is no Fit": lambda *_: pzt.diagnose("fit"),
    "fit: Record is no Fit": lambda *_: pzt.improve(record()),
}


def assert_one_sentence(start, act, *arguments):
    with warnings.catch_warnings(), pytest.raises(pzt.InputError) as raised:
        warnings.simplefilter("error")
        act(*arguments)
    problem, _, remedy = str(raised.value).partition("\n")
    assert start in problem
    assert remedy.strip()
    assert not any(word in str(raised.value) for word in ("data/", "sample_rate", "--out", "parameters.", "records["))


@pytest.mark.parametrize("start", RECORDS)
def test_of_a_record(start):
    assert_one_sentence(start, RECORDS[start])


@pytest.mark.parametrize("start", IDENTIFY)
def test_of_an_identification(start):
    assert_one_sentence(start, IDENTIFY[start])


@pytest.fixture(scope="module")
def with_creep():
    return identify(model=pzt.Model("bouc_wen", effects="creep"))


@pytest.mark.parametrize("start", OF_A_FIT)
def test_of_what_is_done_with_a_fit(start, with_creep, tmp_path):
    (tmp_path / "notes.txt").write_text("mine", encoding="utf-8")
    assert_one_sentence(start, OF_A_FIT[start], with_creep, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


@pytest.mark.parametrize(
    "file", ["environment.json", "job.yaml", "history.csv", "result.json", "signals.nc", "runs/pso-0.json"]
)
@pytest.mark.parametrize("content", [None, b"\xff\x00"])
def test_of_a_damaged_folder(file, content, with_creep, tmp_path):
    path = with_creep.save(tmp_path / "run") / file
    path.unlink() if content is None else path.write_bytes(content)
    with pytest.raises(pzt.InputError, match="run"):
        pzt.load(tmp_path / "run")


def test_of_a_folder_whose_data_have_changed(with_creep, tmp_path):
    data = with_creep.save(tmp_path / "run") / "data" / "train.csv"
    data.write_text(data.read_text(encoding="utf-8").replace("0.01,", "0.010,"), encoding="utf-8")
    with pytest.raises(pzt.InputError, match="has changed since this run began"):
        pzt.load(tmp_path / "run")
