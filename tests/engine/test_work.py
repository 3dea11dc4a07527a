"""The work of simulations, which a budget is spent by, is counted from what is simulated and from nothing else."""

import numpy as np
import pytest

import stage
from pzt_ident.engine import work


def done_by(function, *arguments):
    before = work.done()
    function(*arguments)
    return work.done() - before


@pytest.fixture(scope="module")
def problem():
    return stage.case({}).problem(("creep",))


def test_the_same_simulation_is_the_same_work_however_often_it_was_done(problem):
    points = np.random.default_rng(0).uniform(size=(30, problem.dimensions))
    points[:, 1:] = 0.5
    assert np.ptp([done_by(problem.loss, points) for _ in range(4)]) == pytest.approx(0, abs=1e-12)


def test_what_a_block_solves_for_is_work():
    """A step of domain walls takes ten times as long as one of Bouc-Wen."""
    case = stage.case({})
    walls, loops = (case.with_words((word,)).problem(()) for word in ("domain_wall", "bouc_wen"))
    points = np.random.default_rng(0).uniform(size=(512, walls.dimensions))
    assert done_by(walls.loss, points) > 4 * done_by(loops.loss, points[:, : loops.dimensions])


def test_more_candidates_samples_and_blocks_are_more_work(problem):
    def seconds(candidates, problem):
        return done_by(problem.loss, np.random.default_rng(0).uniform(size=(candidates, problem.dimensions)))

    few = seconds(10, problem)
    drives = [np.tile(record.drive[0], 4) for record in problem.records]
    longer = stage.case({}, drives=drives, dt=problem.records[0].dt)
    assert seconds(100, problem) > few > seconds(10, stage.case({}).problem(()))
    assert seconds(10, longer.problem(("creep",))) > few
