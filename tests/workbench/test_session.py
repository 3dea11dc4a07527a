"""The steps of a session and what is kept of them on the disk."""

import asyncio
import json
import subprocess
import sys
from shlex import split

import pytest
from click.testing import CliRunner

from pzt_ident.cli.commands import main
from pzt_ident.errors import InputError
from pzt_ident.job.schema import Job, load_job
from pzt_ident.model.registry import blocks
from pzt_ident.workbench.bench import Bench
from pzt_ident.workbench.job_form import job_text
from pzt_ident.workbench.page_state import state
from pzt_ident.workbench.runner import RESUME, command_line
from pzt_ident.workbench.session import INTERRUPTED, Session
from pzt_ident.workbench.step_commands import Command

from .conftest import alone, form, measured

ENDLESS = """\
name: endless
records: [{file: data.csv, use: identify}]
channels: {time: "time [s]", axes: {x: {drive: "u_x [V]", response: "x [um]"}}}
model: [bouc_wen]
optimizers: [{name: pso, population: 250, generations: 1000000}]
"""


@pytest.fixture
def begun(session):
    measured(session.root / "data.csv")
    session.begin(form())
    return session


def test_a_step_is_a_job_that_the_command_line_reads(begun):
    job = load_job(begun.step() / "job.yaml")
    assert (job.name, job.effects) == ("small", ())
    assert (begun.step() / job.records[0].file).resolve() == begun.root / "data.csv"


def test_add_take_off_and_undo(begun):
    begun.add("creep")
    begun.add("drift")
    assert begun.job().effects == ("creep", "drift")
    begun.remove("creep")
    assert [step["change"] for step in begun.chain()] == ["as given", "+ creep", "+ drift", "− creep"]
    assert begun.job().effects == ("drift",)
    begun.undo()
    assert begun.job().effects == ("creep", "drift")
    begun.add("saturation")
    assert [step["change"] for step in begun.chain()] == ["as given", "+ creep", "+ drift", "+ saturation"]
    begun.go_to(4)
    assert begun.job().effects == ("drift",)
    for _ in range(9):
        begun.undo()
    assert begun.at == 0 and begun.chain() == [] and begun.logs() == []
    with pytest.raises(InputError, match="no step 6"):
        begun.go_to(6)


def test_from_the_measurement_begins_another_chain(begun):
    begun.undo()
    begun.begin(form(name="other"))
    assert [step["number"] for step in begun.chain()] == [2] and begun.job().name == "other"


@pytest.mark.parametrize(
    "act", [lambda b: b.add("crep"), lambda b: b.remove("creep"), lambda b: b.set_model(["nothing"])]
)
def test_what_cannot_be_changes_nothing(begun, act):
    before = (begun.folder / "state.json").read_text()
    with pytest.raises(InputError):
        act(begun)
    assert (begun.folder / "state.json").read_text() == before


def test_a_session_is_taken_up_again(begun):
    begun.add("creep")
    again = Session(begun.root, begun.folder)
    assert again.chain() == begun.chain() and again.job().effects == ("creep",)


def test_comments_of_the_users_job_are_kept(session):
    measured(session.root / "data.csv")
    (session.root / "job.yaml").write_text(
        "# mine\nname: small\nrecords: [{file: data.csv, use: identify}]  # loops\nchannels:\n  time: 'time [s]'\n"
        "  axes: {x: {drive: 'u_x [V]', response: 'x [um]'}}\nmodel: [bouc_wen]\n"
    )
    session.open(session.root / "job.yaml")
    session.add("creep")
    session.open(session.root / "job.yaml")
    assert session.at == 2
    text = session.job().text
    assert text.startswith("# mine\n") and "# loops" in text and session.job().effects == ("creep",)


def test_a_block_keeps_its_settings(client, session):
    measured(session.root / "data.csv")
    text = job_text(form()).replace('"bouc_wen"]', '"bouc_wen", {name: rod_reduced, elements: 4}]')
    (session.root / "job.yaml").write_text(text, encoding="utf-8")
    session.open(session.root / "job.yaml")
    assert client.get("/api/state").json()["job"]["model"] == ["bouc_wen", "rod_reduced"]
    session.set_model(["prandtl_ishlinskii", "rod_reduced"])
    assert "elements: 4" in session.job().text


OWN = """
from pzt_ident.effects.creep import Creep
from pzt_ident.model.registry import blocks
@blocks.register
class Slow(Creep):
    "Mine."
"""


@pytest.fixture
def own(session):
    """A job with an effect of the user's in it, that cannot be read without its file."""
    measured(session.root / "data.csv")
    (session.root / "slow.py").write_text(OWN)
    (session.root / "job.yaml").write_text(
        "plugins: [slow.py]\n" + job_text(form()).replace("effects: []", "effects: [slow]")
    )
    yield session.root / "job.yaml"
    blocks._items.pop("slow", None)
    sys.modules.pop("pzt_ident_plugins.slow", None)


def test_a_file_of_code_waits_to_be_asked_for(session, own):
    with pytest.raises(InputError, match=r"slow\.py would run as code\n  read it, then add --plugins"):
        session.open(own)
    result = CliRunner().invoke(main, ["workbench", "job.yaml", "--no-browser"])
    assert result.exit_code == 2 and "would run as code" in result.stderr and session.chain() == []


def test_the_users_own_effects_are_listed_and_handed_on(session, own):
    trusting = Session(session.root, session.folder, plugins=True)
    trusting.open(own)
    trusting.remove("slow")
    assert "slow" in {item["name"] for item in state(trusting)["effects"]}
    assert "slow" not in {item["name"] for item in state(trusting)["blocks"]}
    assert all(line[-1] == "--plugins" for _, _, line in trusting.commands(trusting.step()))
    assert trusting.logged_commands()[-1].endswith("--plugins")
    assert trusting.job().plugins == ("../../../slow.py",)


def test_a_session_is_of_one_job(begun):
    path = begun.root / "other.yaml"
    path.write_text((begun.step() / "job.yaml").read_text().replace("small", "other").replace("../../../", ""))
    with pytest.raises(InputError, match="began with another job"):
        begun.open(path)


def test_the_log_repeats_the_session(begun):
    begun.add("creep")
    begun.remove("creep")
    begun.set_model(["bouc_wen", "lumped"])
    assert (begun.folder / "commands.txt").read_text().splitlines() == [
        "pzt-ident add workbench/steps/1/job.yaml creep -o workbench/again/2/job.yaml",
        "pzt-ident remove workbench/again/2/job.yaml creep -o workbench/again/3/job.yaml",
        "pzt-ident model workbench/again/3/job.yaml bouc_wen lumped -o workbench/again/4/job.yaml",
    ]


def test_what_is_done_again_is_logged_once(begun):
    for _ in range(2):
        begun.log(["pzt-ident", "run", "here/job.yaml"])
    assert begun.logged_commands() == ["pzt-ident run here/job.yaml"]


def test_in_a_terminal_the_log_makes_the_same_jobs(begun):
    begun.add("creep")
    begun.set_model(["bouc_wen", "lumped"])
    begun.remove("creep")
    for line in (begun.folder / "commands.txt").read_text().splitlines():
        assert CliRunner().invoke(main, split(line)[1:]).exit_code == 0
    for number in (2, 3, 4):
        again = begun.folder / "again" / str(number) / "job.yaml"
        assert again.read_text() == (begun.step(number) / "job.yaml").read_text()


def test_a_run_that_was_cut_off_goes_on(begun):
    names = [arguments[0] for _, _, arguments in begun.commands(begun.step())]
    assert names == ["run", "diagnose"]
    (begun.step() / "run").mkdir()
    (begun.step() / "run" / "environment.json").write_text("{}")
    assert begun.commands(begun.step())[0][2][:2] == ["resume", "workbench/steps/1/run"]


def test_a_command_that_fails_says_why_and_one_that_is_stopped_says_so(begun, monkeypatch):
    async def story():
        bench = Bench(begun)
        job = (begun.step() / "job.yaml").read_text()
        (begun.step() / "job.yaml").write_text("name: broken\n")
        bench.fill()
        await bench.runner.task
        assert "missing key 'records'" in bench.runner.failure and "Traceback" not in bench.runner.failure
        (begun.step() / "job.yaml").write_text(job)
        shown = bench.state()
        assert "missing key" in shown["error"] and shown["headline"]["verdict"] == "The last command failed."
        endless = begun.root / "endless.yaml"
        endless.write_text(ENDLESS)
        command = Command("run", begun.step() / "never", ["run", str(endless), "--out", str(begun.root / "endless")])
        monkeypatch.setattr(begun, "commands", lambda step: [command])
        bench.fill()
        task = bench.runner.task
        bench.fill()
        assert bench.runner.task is task
        while bench.runner.process is None:
            assert bench.runner.running, bench.runner.failure
            await asyncio.sleep(0.02)
        await bench.runner.stop()
        assert bench.runner.failure.startswith("Stopped")
        shown = bench.state()
        assert (shown["headline"]["verdict"], shown["headline"]["next"], shown["error"]) == ("Stopped.", RESUME, "")
        assert not bench.runner.running and bench.runner.stage == ""
        await bench.close()

    alone(story())


def test_the_page_learns_of_every_change(client, session):
    measured(session.root / "data.csv")
    found = client.post("/api/job", json=form()).json()
    assert found["job"]["model"] == ["bouc_wen"] and found["result"] is None
    (step,) = found["steps"]
    assert step.items() >= {"number": 1, "parent": 0, "change": "as given", "identify": None, "validate": None}.items()
    assert {"bouc_wen", "lumped"} <= {block["name"] for block in found["blocks"]}
    assert "creep" in {effect["name"] for effect in found["effects"]}
    assert found["files"] == ["data.csv"]
    saved = Job.from_text(client.get("/api/job").text, session.root)
    assert saved.text.startswith("# Made in the workbench.") and saved.records[0].file == "data.csv"
    assert client.get("/api/drive").status_code == 400


def test_events_are_the_lines_of_the_run(session, monkeypatch):
    from pzt_ident.workbench.app import event_stream

    measured(session.root / "data.csv")
    session.begin(form())
    (session.step() / "run").mkdir()
    lines = [{"event": "start", "runs": []}, {"event": "done"}]
    (session.step() / "run" / "events.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines) + '{"torn')

    class Listening:
        async def is_disconnected(self):
            return False

    async def first(count):
        stream, found = event_stream(Bench(session), Listening()), []
        async for message in stream:
            found.append(json.loads(message.removeprefix("data: ")))
            if len(found) == count:
                return found

    found = alone(first(4))
    assert found == [{"event": "step", "step": 1}, *lines, {"event": "changed", "version": session.version}]


def test_a_log_that_begins_anew_is_sent_from_its_first_line(tmp_path):
    from pzt_ident.workbench.app import new_lines

    log, offsets = tmp_path / "events.jsonl", {}
    assert new_lines(log, offsets) == []
    log.write_bytes(b"one\ntwo\nthr")
    assert new_lines(log, offsets) == [b"one", b"two"]
    log.write_bytes(b"one\ntwo\nthree\n")
    assert new_lines(log, offsets) == [b"three"] and new_lines(log, offsets) == []
    log.write_bytes(b"new\n")
    assert new_lines(log, offsets) == [b"new"]


def test_a_session_that_was_cut_off_says_so(begun):
    def failure():
        return Bench(Session(begun.root, begun.folder)).runner.failure

    assert failure() == ""
    (begun.step() / "run").mkdir()
    (begun.step() / "run" / "environment.json").write_text("{}")
    assert failure() == INTERRUPTED
    for _, last, _ in begun.commands(begun.step()):
        last.parent.mkdir(exist_ok=True)
        last.write_text("{}")
    assert failure() == ""


def test_a_command_ends_with_what_started_it(tmp_path):
    process = subprocess.Popen(command_line(), cwd=tmp_path, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    process.stdin.write(b'["workbench", "--no-browser"]\n')
    process.stdin.flush()
    assert process.stdout.readline().startswith(b"workbench: ")
    process.stdin.close()
    assert process.wait(20) != 0


def test_a_file_that_cannot_be_read_may_be_dropped_again(client, session):
    assert client.post("/api/upload?name=a.csv", content=b"no numbers").status_code == 400
    assert not list(session.data.iterdir())
    measured(session.root / "data.csv")
    content = (session.root / "data.csv").read_bytes()
    assert client.post("/api/upload?name=a.csv", content=content).json()["rows"] == 400
    assert "dropped before" in client.post("/api/upload?name=a.csv", content=b"other").json()["error"]
    assert client.get("/api/state").json()["files"] == ["data.csv", "workbench/data/a.csv"]
