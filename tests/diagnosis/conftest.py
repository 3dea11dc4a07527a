"""Cases that several modules of tests fit; each module has its own, since a case remembers its refits."""

import pytest

import stage


@pytest.fixture(scope="module")
def plain():
    return stage.case()


@pytest.fixture(scope="module")
def creeping():
    return stage.case(stage.EFFECTS["creep"])
