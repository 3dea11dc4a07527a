"""What is wrong with a form is said in the words of the page."""

import ast
import re
from pathlib import Path

import numpy as np
import pytest

import pzt_ident
from pzt_ident.errors import InputError
from pzt_ident.workbench.edits import search, set_parameter
from pzt_ident.workbench.wording import in_page_words

from .conftest import form, measured

FOREIGN = re.compile(
    r"`|(?<!\S)--\w|\.ya?ml|\.\./|\w\[\d|channels\.|records\.|parameters\.|optimizers\[|\brows:|\bsettle:"
)
RAISING = ("data", "job", "search", "run", "control", "engine", "model", "api/drive.py", "api/reference.py")
N = np.arange(400.0)
GAIN = 0.1 * (50 - np.abs(50 - N % 100))


def record(**facts):
    return {"records": [{"file": "data.csv", "use": "identify", "rows": 400} | facts]}


def axes(drive="V", response="um", name="u_x [V]"):
    columns = {"drive": (name, 2, drive), "response": ("x [um]", 3, response)}
    return {"axes": {"x": {k: dict(zip(("header", "number", "unit"), v, strict=True)) for k, v in columns.items()}}}


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        (record(crop=[390, 100]), "“From” and “to”: ends at 100"),
        (record(crop=[0, 9999]), "data.csv: drive of x: rows"),
        (record(crop=[0, 4]), "data.csv: 4 scored samples"),
        (record(settle="abc"), "“not scored for”: 'abc' is not"),
        (record(settle="99 s"), "data.csv: settle 99 s leaves nothing"),
        (record(use="validate"), "no identification record"),
        (record(file="no.csv"), "no.csv: no such file"),
        (axes(drive="abc"), "unit of the drive of x: unknown unit 'abc'"),
        (axes(response="1e400"), "unit of the response of x: the unit '1e400' is infinite"),
        (axes(drive="0 V"), "unit of the drive of x: the unit '0 V' is zero"),
        (axes(response="kg"), "data.csv: response of x: a response cannot have"),
        (axes(name="nothing"), "data.csv: drive of x: has no column 'nothing'"),
        ({"name": "../../x"}, "name of the job: '../../x' is not a name"),
        ({"name": "a/b"}, "name of the job: 'a/b' is not a name"),
        ({"time": None, "sample_rate": "abc"}, "sample rate: 'abc' is not"),
        ({"model": []}, "model: the model has no block"),
    ],
)
def test_a_fault_of_the_form(session, fault, said):
    measured(session.root / "data.csv")
    with pytest.raises(InputError) as raised:
        session.begin(form(**fault))
    message = session.readable(str(raised.value))
    assert message.startswith(said) or (said in message and "no identification" in said)
    assert not FOREIGN.search(message.replace("'../../x'", ""))


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"x": np.where(N == 7, np.nan, GAIN)}, "faulty.csv: response of x: 1 value is missing"),
        ({"u": 0 * N + 50}, "faulty.csv: the drive of axis x is constant"),
        ({"x": 0 * N}, "faulty.csv: response of x: the response is constant"),
        ({"t": N / 100 + 5 * (N > 200)}, "faulty.csv: time is not uniform"),
        ({"t": np.minimum(N, 300) / 100}, "faulty.csv: time repeats at row 301"),
        ({"x": 1e30 * GAIN}, "faulty.csv: response of x: row"),
    ],
)
def test_a_fault_of_a_dropped_file(session, columns, said):
    signals = {"t": N / 100, "u": 10 * GAIN, "x": GAIN} | columns
    rows = [",".join("" if np.isnan(v) else f"{v:.6g}" for v in row) for row in zip(*signals.values(), strict=True)]
    session.data.mkdir(parents=True)
    (session.data / "faulty.csv").write_text("\n".join(["time [s],u_x [V],x [um]", *rows]) + "\n")
    with pytest.raises(InputError) as raised:
        session.begin(form(**record(file="workbench/data/faulty.csv")))
    message = session.readable(str(raised.value))
    assert message.startswith(said) and not FOREIGN.search(message)


def test_faults_of_settings(session):
    measured(session.root / "data.csv")
    session.begin(form())
    with pytest.raises(InputError) as raised:
        set_parameter(session, {"parameter": "bouc_wen.alpha", "bounds": [2, 1]})
    message = session.readable(str(raised.value))
    assert message.startswith("bounds of bouc_wen.alpha: bounds reversed") and "the lower one first" in message
    with pytest.raises(InputError) as raised:
        set_parameter(session, {"parameter": "bouc_wen.alpha", "bounds": [1, 1]})
    message = session.readable(str(raised.value))
    assert message == "bounds of bouc_wen.alpha: both bounds are 1\n  fix the parameter at 1"
    with pytest.raises(InputError) as raised:
        search(session, {"optimizers": [{"name": "pso", "population": 0}], "repeats": 0})
    message = session.readable(str(raised.value))
    assert message.startswith("2 entries have to be corrected:\npopulation of the optimizer: 0 is out of bounds")
    assert not FOREIGN.search(message)


def sentences():
    """Every text in the package that a command may raise, with a word in the place of what is filled in."""
    root = Path(pzt_ident.__file__).parent
    for name in RAISING:
        path = root / name
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "InputError":
                    for text in [*node.args, *(keyword.value for keyword in node.keywords)]:
                        if isinstance(text, ast.Constant | ast.JoinedStr):
                            pieces = text.values if isinstance(text, ast.JoinedStr) else [text]
                            yield "".join(str(p.value) if isinstance(p, ast.Constant) else "3" for p in pieces)


def test_no_sentence_keeps_a_key_or_an_option():
    found = list(sentences())
    assert len(found) > 150
    foreign = [text for text in found if re.search(r"`|(?<!\S)--\w", in_page_words(text))]
    assert foreign == []
