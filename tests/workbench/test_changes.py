"""Changes of a session: one after the other, each once, and whatever order they come in it opens again."""

import asyncio
import json
import shutil
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pzt_ident.errors import InputError
from pzt_ident.job.schema import load_job
from pzt_ident.workbench.bench import Bench
from pzt_ident.workbench.page_state import state
from pzt_ident.workbench.posts import CHANGES, control_options
from pzt_ident.workbench.session import Session

from .conftest import alone, form, measured


@pytest.fixture
def bench(session):
    measured(session.root / "data.csv")
    return idle(Bench(session))


def idle(bench):
    """Steps are made, and nothing is run."""
    bench.runner.start = lambda commands: commands.close()
    bench.runner.warm = lambda: None
    return bench


def post(bench, *changes):
    """Ask for changes at the same time."""

    async def ask(name, body):
        try:
            await bench.change(name, CHANGES[name], body)
        except InputError as error:
            return error

    async def story():
        bench.lock = asyncio.Lock()  # that of this loop
        return await asyncio.gather(*(ask(name, body) for name, body in changes))

    return alone(story())


@pytest.mark.parametrize("at", [{"at": 0}, {}])
def test_a_double_click_on_confirm_makes_one_step(bench, at):
    assert post(bench, *[("job", form() | at)] * 2) == [None, None]
    assert [step["number"] for step in bench.session.steps] == [1] and bench.session.at == 1


@pytest.mark.parametrize("at", [{"at": 1}, {}])
def test_a_double_click_on_add_makes_one_step(bench, at):
    post(bench, ("job", form()))
    assert post(bench, *[("add", {"effect": "creep"} | at)] * 3) == [None] * 3
    assert bench.session.job().effects == ("creep",) and len(bench.session.steps) == 2


def test_what_was_asked_for_elsewhere_is_not_done(bench):
    post(bench, ("job", form()))
    post(bench, ("add", {"effect": "creep", "at": 1}))
    post(bench, ("add", {"effect": "drift", "at": 1}), ("undo", {"at": 1}), ("back", {"step": 0, "at": 1}))
    assert bench.session.at == 2 and bench.session.job().effects == ("creep",)


def test_a_double_click_on_run_starts_one(bench, monkeypatch):
    post(bench, ("job", form()))
    started = []

    def start(commands):
        commands.close()
        started.append(1)
        monkeypatch.setattr(type(bench.runner), "running", property(lambda runner: True))

    bench.runner.start = start
    post(bench, *[("run", {"at": 1})] * 2)
    assert len(started) == 1


def test_a_change_that_fails_leaves_all_as_it_was(bench):
    post(bench, ("job", form()))
    before = (bench.session.folder / "state.json").read_text()
    (fault,) = post(bench, ("add", {"effect": "crep", "at": 1}))
    assert "crep" in str(fault) and not bench.busy
    assert (bench.session.folder / "state.json").read_text() == before
    assert post(bench, ("add", {"effect": "creep", "at": 1})) == [None]


BODIES = st.one_of(
    st.sampled_from(["creep", "drift"]).map(lambda word: ("add", {"effect": word})),
    st.just(("remove", {"effect": "creep"})),
    st.just(("undo", {})),
    st.integers(0, 3).map(lambda number: ("back", {"step": number})),
    st.just(("settings", {"parameter": "bouc_wen.alpha", "bounds": [0.1, 0.9]})),
    st.just(("settings", {"parameter": "bouc_wen.alpha", "value": 0.4})),
    st.just(("note", {"step": 1, "text": "looked at"})),
    st.just(("run", {})),
)
CLICKS = st.tuples(BODIES, st.integers(0, 3) | st.none(), st.integers(1, 3))


@settings(max_examples=12, deadline=None)
@given(rounds=st.lists(st.lists(CLICKS, min_size=1, max_size=2), max_size=3))
def test_any_order_of_clicks_leaves_a_session_that_opens(rounds):
    with tempfile.TemporaryDirectory() as place:
        root = Path(place)
        measured(root / "data.csv", 60)
        bench = idle(Bench(Session(root, root / "workbench")))
        post(bench, ("job", form()))
        for clicks in rounds:
            asked = [(name, body | ({} if at is None else {"at": at})) for (name, body), at, _ in clicks]
            times = [count for *_, count in clicks]
            post(bench, *(item for item, count in zip(asked, times, strict=True) for _ in range(count)))
        assert not bench.busy
        again = Session(root, root / "workbench")
        assert (again.steps, again.at, again.warning) == (bench.session.steps, bench.session.at, "")
        for step in again.steps:
            assert load_job(again.step(step["number"]) / "job.yaml")
            assert 0 <= step["parent"] < step["number"]


def damage(session, kind):
    step = session.step(2)
    if kind == "folder":
        shutil.rmtree(step)
    elif kind == "job":
        (step / "job.yaml").write_text("name: [")
    else:
        (step / "run").mkdir()
        (step / "run" / "result.json").write_text('{"best": ')


@pytest.mark.parametrize("kind", ["folder", "job", "result"])
def test_a_session_whose_last_step_is_damaged_opens_at_the_one_before(bench, kind):
    post(bench, ("job", form()), ("add", {"effect": "creep"}))
    session = bench.session
    damage(session, kind)
    again = Session(session.root, session.folder)
    assert again.at == 1 and "Step 2 cannot be opened" in again.warning and "This is step 1" in again.warning
    shown = bench.state()
    assert (shown["at"], shown["job"]["effects"]) == (1, []) and "Step 2" in shown["warning"]
    with pytest.raises(InputError, match="step 2 cannot be opened"):
        session.go_to(2)


def test_a_damaged_list_of_steps_is_made_again(bench):
    post(bench, ("job", form()), ("add", {"effect": "creep"}))
    (bench.session.folder / "state.json").write_text('{"steps": [')
    again = Session(bench.session.root, bench.session.folder)
    assert again.at == 2 and again.job().effects == ("creep",) and "is damaged" in again.warning


def test_choices_at_the_columns_and_notes_are_kept(bench):
    choices = {"columns": {"x.drive": 2}, "crop": [0, 100]}
    post(bench, ("draft", choices | {"at": 0}))
    assert Session(bench.session.root, bench.session.folder).draft == choices
    post(bench, ("job", form()))
    post(bench, ("note", {"step": 1, "text": "tube 3, warm"}))
    again = state(Session(bench.session.root, bench.session.folder))
    assert again["draft"] == choices and again["steps"][0]["note"] == "tube 3, warm"


def test_parameters_are_fixed_freed_and_bounded_in_the_job(bench):
    post(bench, ("job", form()))
    name = "bouc_wen.alpha"
    post(bench, ("settings", {"parameter": name, "value": 0.4, "at": 1}))
    assert bench.session.job().parameters[name].value == 0.4
    post(bench, ("settings", {"parameter": name, "bounds": [0.1, 0.8], "at": 2}))
    assert bench.session.job().parameters[name].bounds == (0.1, 0.8)
    post(
        bench, ("settings", {"parameter": name, "value": 0.5, "at": 3}), ("settings", {"parameter": name, "free": True})
    )
    assert bench.session.job().parameters[name].bounds == (0, 1)
    (fault,) = post(bench, ("settings", {"parameter": "bouc_wen.alfa", "value": 1}))
    assert "bouc_wen.alpha" in str(fault)
    assert [step["change"] for step in bench.session.steps][1:3] == [f"{name} = 0.4000", f"{name} in 0.1000 to 0.8000"]


def test_other_optimizers_are_in_the_job_of_a_step(bench):
    post(bench, ("job", form()))
    chosen = [{"name": "cma_es"}, {"name": "pso", "population": 10, "generations": 5}]
    post(bench, ("search", {"optimizers": chosen, "repeats": 2, "seed": 3, "at": 1}))
    job = bench.session.job()
    assert [item.name for item in job.optimizers] == ["cma_es", "pso"] and (job.repeats, job.seed) == (2, 3)
    (command, _) = bench.session.commands(bench.session.step())
    assert "--no-search" not in command.arguments


def test_a_polish_starts_where_the_sliders_are(bench):
    post(bench, ("job", form()), ("polish", {"values": {"bouc_wen.alpha": 0.3}}))
    step = bench.session.step()
    start = json.loads((step / "start.json").read_text())["parameters"]
    assert start == {"bouc_wen.alpha": {"value": 0.3, "unit": "1"}}
    (command, _) = bench.session.commands(step)
    assert command.arguments[4:] == ["--from", "workbench/steps/2/start.json", "--no-search", "--no-report"]


def test_options_of_control_are_those_of_the_command():
    line = control_options({"limits": [-20, 150], "noise_gain": 5, "rate": None})
    assert line == ["--limits", "-20:150", "--noise-gain", "5"]
    with pytest.raises(InputError, match="unknown option 'out'"):
        control_options({"out": "/etc"})


@pytest.mark.parametrize("budget", ["-5", "abc", "1e400", "0s", "3V"])
def test_a_budget_that_is_no_time_starts_nothing(bench, budget):
    post(bench, ("job", form()))
    bench.runner.start = lambda commands: pytest.fail("started")
    (error,) = post(bench, ("improve", {"at": 1, "budget": budget}))
    assert "is no time above zero" in error.message
