"""The work of simulations, which a budget is spent by, is counted from what is simulated and from nothing else."""

import numpy as np
import pytest

import stage
from pzt_ident.engine import work
from pzt_ident.engine.lanes import Variant, layout_of
from pzt_ident.model.registry import blocks


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


def test_branches_that_are_read_by_series_are_a_third_of_the_work():
    """Those of a free energy, as ferroelectric models time them (`experiments/performance`); not a sample a call."""
    block = blocks["homogenized_energy"]
    whole, single = layout_of(block, Variant()), layout_of(block, Variant(single=True))
    assert whole.idle == 2 * (whole.first_given + whole.copies * whole.given) // 3 and single.idle == 0
    case = stage.case({}).with_words(("homogenized_energy",))
    problem = case.problem(())
    points = np.random.default_rng(0).uniform(size=(24, problem.dimensions))
    steps = 24 * sum(record.samples for record in problem.records if record.use == "identify")
    counted = (done_by(problem.loss, points) - work.CALL) / steps - work.LANE
    assert counted == pytest.approx(work.ROW * (whole.rows - whole.idle), rel=0.05)


def test_more_candidates_samples_and_blocks_are_more_work(problem):
    def seconds(candidates, problem):
        return done_by(problem.loss, np.random.default_rng(0).uniform(size=(candidates, problem.dimensions)))

    few = seconds(10, problem)
    drives = [np.tile(record.drive[0], 4) for record in problem.records]
    longer = stage.case({}, drives=drives, dt=problem.records[0].dt)
    assert seconds(100, problem) > few > seconds(10, stage.case({}).problem(()))
    assert seconds(10, longer.problem(("creep",))) > few
