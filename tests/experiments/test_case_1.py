"""What the search of Case I finds on the shipped records of the virtual stage."""

from pathlib import Path

import pytest

from pzt_ident.job.schema import load_job
from pzt_ident.model.registry import optimizers
from pzt_ident.run.statement import Statement
from pzt_ident.search.loop import Stop, optimize

QUANTISED = 0.02887e-6  # m, 0.1 um / sqrt(12)


@pytest.mark.parametrize("seed", range(5))
def test_the_swarm_with_constriction_comes_down_to_the_encoder(seed):
    job = load_job(Path(__file__).parents[2] / "configs" / "lin_lin_x.yaml")
    problem = Statement(job).problem
    swarm = next(each for each in job.optimizers if each.name == "pso")
    found = optimize(optimizers["pso"].make(**swarm.settings), problem.dimensions, problem.loss, seed, Stop(17_500))
    assert found.loss == pytest.approx(QUANTISED, rel=0.01)
