"""The steps of an improvement become steps of the session, and keep what was left undecided."""

import json

import pytest

from pzt_ident.files import read_sealed, write_sealed
from pzt_ident.job.edit import edited
from pzt_ident.workbench import adopt, page_state

from .conftest import form, measured


def stair(effects, added=None, removed=None, tied=(), steps=(1,), model=("bouc_wen",), bounds=None):
    value = {"value": 0.3, "unit": "1", "standard_error": 0.01}
    return {
        "added": added,
        "removed": removed,
        "form": None,
        "change": None,
        "class": list(tied),
        "model": list(model),
        "bounds": bounds or {},
        "effects": list(effects),
        "steps": list(steps),
        "rmse": {"identify": 0.5, "validate": None},
        "parameters": {"bouc_wen.alpha": value},
    }


@pytest.fixture
def improved(session):
    measured(session.root / "data.csv")
    session.begin(form())
    out = session.step() / "improved"
    out.mkdir()
    stairs = [
        stair([]),
        stair(["creep"], added="creep", tied=("creep", "drift"), steps=(2,)),
        stair(["creep", "friction"], added="friction"),
        stair(["creep"], removed="friction", steps=(2,)),
        stair(["creep", "saturation"], added="saturation"),
    ]
    (out / "improvement.json").write_text(
        json.dumps({"steps": stairs, "reason": "Nothing. The budget of 9 s did not suffice."})
    )
    job = session.job()
    (out / "improved.yaml").write_text(edited(job, ("creep", "saturation"), out, steps=[4]))
    return session


def test_each_step_has_its_job_and_starts_from_the_fit_that_was_found(improved):
    assert adopt.improvement(improved, improved.step()) == [2, 3]
    assert [entry["change"] for entry in improved.chain()] == ["as given", "+ creep", "+ saturation"]
    assert [improved.job(n).effects for n in (2, 3)] == [("creep",), ("creep", "saturation")]
    assert [improved.job(n).records[0].steps for n in (2, 3)] == [2, 4]
    assert [entry["tried"] for entry in improved.chain()] == [[], ["friction"], []]
    for entry in improved.chain()[1:]:
        start = json.loads((improved.folder / entry["from"]).read_text())
        assert start["parameters"]["bouc_wen.alpha"]["value"] == 0.3 and entry["promised"]["identify"] == 0.5
        (command, _) = improved.commands(improved.step(entry["number"]))
        assert "--no-search" in command.arguments


def test_a_step_without_mechanics_has_a_job_without_them(session):
    measured(session.root / "data.csv")
    session.begin(form(model=["bouc_wen", "lumped"]))
    out = session.step() / "improved"
    out.mkdir()
    stairs = [
        stair([], model=["bouc_wen", "lumped"]),
        stair([]) | {"change": "without lumped"},
        stair(["creep"], "creep"),
    ]
    (out / "improvement.json").write_text(json.dumps({"steps": stairs, "reason": "Said."}))
    job = session.job()
    (out / "improved.yaml").write_text(edited(job, ("creep",), out, ["bouc_wen"]))
    adopt.improvement(session, session.step())
    assert [session.job(n).model for n in (1, 2, 3)] == [("bouc_wen", "lumped"), ("bouc_wen",), ("bouc_wen",)]
    assert [entry["change"] for entry in session.chain()] == ["as given", "without lumped", "+ creep"]


def test_what_could_not_be_told_apart_is_said_while_it_is_in_the_model(improved):
    adopt.improvement(improved, improved.step())
    assert page_state.tied_sentences(improved) == [" These data cannot tell creep from drift."]
    improved.remove("creep")
    assert page_state.tied_sentences(improved) == []


def test_a_detour_leaves_the_fit_that_was_found_after_it():
    words = [[], ["a"], ["a", "b"], ["a", "b", "c"], ["b", "c", "a"], ["a", "c"], ["a"]]
    steps = [stair(effects, steps=(n,)) for n, effects in enumerate(words)]
    for place, added in (1, "a"), (2, "b"), (3, "c"):
        steps[place]["added"] = added
    steps[4]["change"] = "finer steps"
    steps[5]["removed"], steps[6]["removed"] = "b", "c"
    found = adopt.without_detours(steps)
    assert [item["effects"] for item in found] == [[], ["a"]]
    assert (found[1]["steps"], found[1]["tried"]) == ([6], ["b", "c"])
    assert [item["effects"] for item in adopt.without_detours(steps[:6])] == words[:6]


def test_the_last_step_has_the_diagnosis_of_the_improvement(improved):
    out = improved.step() / "improved"
    write_sealed(out / "diagnosis.json", {"verdict": "unexplained", "reason": "Nothing."})
    *_, last = adopt.improvement(improved, improved.step())
    adopt.diagnosis(improved, out.parent, last)
    folder = improved.step(last) / "diagnosis"
    found = read_sealed(folder / "diagnosis.json")  # whole, though its reason has changed
    assert (found["verdict"], found["reason"]) == ("unexplained", "Nothing. The budget of 9 s did not suffice.")
    assert improved.again(folder) == "workbench/again/1/improved"
    (_, diagnose) = improved.commands(improved.step(last))
    assert diagnose.last.exists()


def test_steps_that_come_are_shown(improved):
    log = improved.step() / "improved" / "events.jsonl"
    lines = [{"event": "scored"}, {"event": "stair", **stair([])}, {"event": "stair", **stair(["creep"], "creep")}]
    log.write_text("".join(json.dumps(line) + "\n" for line in lines) + '{"event": "st')
    shown = page_state.improving(improved.step())
    assert [step["effects"] for step in shown["steps"]] == [[], ["creep"]]
