"""Commands as processes: the next one waits, and one that has ended is replaced."""

import asyncio

import pytest

from pzt_ident.errors import RunError
from pzt_ident.workbench.runner import STOPPED, Runner

from .conftest import alone


def test_the_waiting_process_takes_the_command_and_a_dead_one_is_replaced(tmp_path):
    async def story():
        runner = Runner(tmp_path, lambda: None)
        runner.warm()
        waiting = await runner.waiting
        await runner.run("init", ["init", "there"])
        assert runner.process is waiting and (tmp_path / "there" / "job.yaml").exists()
        dead = await runner.waiting
        dead.kill()
        await dead.wait()
        with pytest.raises(RunError, match="no such file"):
            await runner.run("check", ["check", "nothing.yaml"])
        assert runner.process is not dead
        await runner.close()
        assert (await runner.waiting).returncode is not None

    alone(story())


def test_a_command_that_is_being_started_is_stopped_and_the_next_one_takes_its_process(tmp_path):
    async def story():
        runner = Runner(tmp_path, lambda: None)
        runner.start(runner.run("init", ["init", "there"]))
        await asyncio.sleep(0)
        assert runner.running and runner.process is None
        await runner.stop()
        assert (runner.running, runner.stage, runner.failure) == (False, "", STOPPED)
        waiting = await runner.waiting
        await runner.run("init", ["init", "elsewhere"])
        assert runner.process is waiting
        assert (tmp_path / "elsewhere").exists() and not (tmp_path / "there").exists()
        await runner.close()

    alone(story())


def test_a_runner_that_keeps_no_process_waiting_runs_its_command(tmp_path):
    class Single(Runner):
        def warm(self):
            """None waits."""

    async def story():
        runner = Single(tmp_path, lambda: None)
        await runner.run("init", ["init", "there"])
        assert runner.waiting is None and (tmp_path / "there").exists()
        await runner.close()

    alone(story())


def test_a_fault_of_the_workbench_itself_is_shown_and_ends_the_command(tmp_path):
    async def faulty():
        raise KeyError("parameters")

    async def story():
        runner = Runner(tmp_path, lambda: None)
        runner.start(faulty())
        with pytest.raises(KeyError):
            await runner.task
        assert not runner.running and runner.failure == "The workbench failed: KeyError: 'parameters'"

    alone(story())
