"""Commands as processes: the next one waits, and one that has ended is replaced."""

import pytest

from pzt_ident.errors import RunError
from pzt_ident.workbench.runner import Runner

from .conftest import alone


@pytest.mark.parametrize("killed", [False, True])
def test_the_waiting_process_takes_the_command_and_a_dead_one_is_replaced(tmp_path, killed):
    async def story():
        runner = Runner(tmp_path, lambda: None)
        runner.warm()
        waiting = await runner.waiting
        if killed:
            waiting.kill()
            await waiting.wait()
        await runner.run("init", ["init", "there"])
        assert (runner.process is waiting) != killed and (tmp_path / "there" / "job.yaml").exists()
        with pytest.raises(RunError, match="no such file"):
            await runner.run("check", ["check", "nothing.yaml"])
        await runner.close()
        assert (await runner.waiting).returncode is not None

    alone(story())
