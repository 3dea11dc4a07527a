"""A staircase is brought home to the bounds of the job with the blocks that each of its models has."""

import stage
from pzt_ident.diagnosis.climb import Staircase
from pzt_ident.diagnosis.least_bounds import with_least_bounds
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.step import Step
from pzt_ident.job.sections import Choice


def test_a_block_with_settings_is_left_out_like_any():
    case = stage.case().with_words(("bouc_wen", Choice("modal", {"modes": 2})))
    lean, first = case.with_words(("bouc_wen",)), first_fit(case, 0)
    end = refit(lean, first, (), {})
    found = with_least_bounds(case, Staircase([Step(first), Step(end, case=lean)], None, case=lean))
    assert [step.fit.problem.names for step in found.steps] == [first.problem.names, end.problem.names]
    assert found.case.words == found.steps[1].case.words == ("bouc_wen",)
