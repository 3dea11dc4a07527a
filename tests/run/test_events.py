"""What a diagnosis says while it is at work."""

import pytest

from pzt_ident.run.events import sentence, step_name

STEP = {"event": "stair", "added": None, "removed": None, "rmse": {"identify": 0.031}}


@pytest.mark.parametrize(("path", "said"), [(1, "as given"), (2, "as given again")])
def test_a_path_that_begins_again_is_said_to(path, said):
    assert sentence(STEP | {"path": path}, {"x": "um"}) == f"{said}: RMSE 0.03100\N{NO-BREAK SPACE}µm"


def test_other_steps_are_called_alike_on_any_path():
    step = STEP | {"path": 2, "added": "creep", "form": "voltage", "removed": "drift"}
    assert (
        sentence(step, {"x": "um"}).startswith(f"{step_name(step)}: ")
        and step_name(step) == "+ creep (voltage) - drift"
    )
