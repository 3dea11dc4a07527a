"""What a bench says of itself."""

import pytest

from pzt_ident.workbench import bench, page_state
from pzt_ident.workbench.bench import Bench


@pytest.mark.parametrize("late", [False, True])
def test_what_changes_while_the_state_is_gathered_has_a_later_version(session, monkeypatch, late):
    made, gather = Bench(session), page_state.state

    def meanwhile(session):
        content = gather(session) if late else None
        made.runner.stage = "run"
        made.changed()
        return content or gather(session)

    monkeypatch.setattr(bench.page_state, "state", meanwhile)
    state = made.state()
    assert state["stage"] == "" and state["version"] < session.version
