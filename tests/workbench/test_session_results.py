"""The report of a step has the diagnosis and the stairs that led to it."""

import json
from types import SimpleNamespace

import pytest

from pzt_ident.workbench import page_state
from pzt_ident.workbench.page_state import over_axes, step_state
from pzt_ident.workbench.session_results import gathered

from .conftest import form, measured

DIAGNOSIS = {"verdict": "adequate", "reason": "It is.", "candidates": [], "next_experiment": None}


def fill(session, identify, unit="um"):
    rmse = {"identify": identify, "validate": None}
    best = {"rmse": rmse, "parameters": {"bouc_wen.gain": {"value": 0.1, "unit": "um/V", "verdict": "determined"}}}
    floor = {"noise_floor": {"x": 0.3}, "noise_floor_source": {"x": "rest segments"}, "floor": 0.3}
    result = {"name": "small", "unit": unit, "units": {"x": unit}, **floor, "best": best}
    for name, content in (("run/result.json", result), ("diagnosis/diagnosis.json", DIAGNOSIS)):
        (session.step() / name).parent.mkdir()
        (session.step() / name).write_text(json.dumps(content))


@pytest.fixture
def begun(session):
    measured(session.root / "data.csv")
    session.begin(form())
    fill(session, 0.5)
    return session


def test_a_first_step_has_its_diagnosis_and_no_stairs(begun):
    assert gathered(begun) == begun.step() / "run"
    assert json.loads((begun.step() / "run" / "diagnosis.json").read_text()) == DIAGNOSIS
    assert not (begun.step() / "run" / "improvement.json").exists()


def test_later_ones_have_the_stairs(begun):
    for act, left in ((begun.add, 0.4), (begun.remove, 0.5)):
        act("creep")
        fill(begun, left)
    begun.add("drift")
    fill(begun, 0.3)
    found = json.loads((gathered(begun) / "improvement.json").read_text())
    assert [(step["added"], step["removed"]) for step in found["steps"]] == [
        (None, None),
        ("creep", None),
        (None, "creep"),
        ("drift", None),
    ]
    assert [step["explained"] for step in found["steps"]] == pytest.approx([0, 0.09 / 0.16, -0.09 / 0.07, 1])
    assert (found["effects"], found["floor"], found["reason"]) == (["drift"], pytest.approx(0.3), "It is.")


def test_errors_are_in_the_unit_of_the_newest_step_that_was_run(begun):
    assert over_axes(begun)["unit"] == "µm"
    begun.add("creep")
    fill(begun, 400.0, "nm")
    begun.add("drift")
    assert over_axes(begun) == {"unit": "nm", "together": "", "weighed": ""}
    assert [step_state(begun, entry)["identify"] for entry in begun.chain()] == [0.5, 400.0, None]


def test_the_signals_are_those_of_this_step_beside_the_one_before(begun, monkeypatch):
    for left in (0.4, 0.3):
        begun.add("creep" if left == 0.4 else "drift")
        fill(begun, left)
    monkeypatch.setattr(page_state, "read_results", lambda run: SimpleNamespace(traces=run.parent))
    monkeypatch.setattr(page_state, "packed", lambda models, most: models)
    shown = page_state.signals(begun)
    assert shown["records"] == {"now": begun.step(), "before": begun.step(begun.chain()[-2]["number"])}
    assert shown["floors"] == {"x": 0.3}
