"""Long records: which samples are left out, and that a verdict on fewer samples is one on all."""

from dataclasses import replace

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis import proof, thinning
from pzt_ident.diagnosis import staircase as stairs
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.paths import PROVEN
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.step import Step
from pzt_ident.diagnosis.thinning import enough, keeps_all, most_of, situations, thin_record, thinned
from rig import record

TIMES = 3


def noisy(drive, noise=1e-2, **more):
    response = drive + np.random.default_rng(0).normal(0, noise, drive.size)
    return record(drive, response=[response], **more)


SINE = noisy(50 - 50 * np.cos(2 * np.pi * np.arange(20_000) / 2000))


def test_samples_between_which_nothing_happens_may_go():
    """A line over n samples of a sine of amplitude A and period N misses it by A (pi n / N)^2 / 2 sqrt(4 / 15), root
    mean square: a tenth of the noise for n = 5.6."""
    assert keeps_all(SINE, 5, [1e-2]) and not keeps_all(SINE, 6, [1e-2])
    jump = noisy(np.repeat([0.0, 1.0, 0.0], 4000))
    assert not keeps_all(jump, 3, [1e-2])
    rings = noisy(np.zeros(4000))
    ringing = replace(rings, response=rings.response + 0.03 * np.sin(2.0 * np.arange(4000)))
    assert keeps_all(rings, 8, [1e-2]) and not keeps_all(ringing, 8, [1e-2])


def test_a_periodic_record_keeps_its_period():
    assert keeps_all(SINE, 3, [1e-2]) and not keeps_all(replace(SINE, run_in=1), 3, [1e-2])
    assert thin_record(replace(SINE, run_in=1), 300, [1e-2]).samples == 20_000 // 4


@pytest.mark.parametrize(
    ("drives", "share"), [(["small", "small"], 1), (["small", "large"], 2), (["large", "slow"], 2)]
)
def test_a_record_is_cut_where_the_rest_only_repeats(drives, share):
    wave = np.sin(2 * np.pi * np.arange(1000) / 100)
    words = {"small": 0.5 * wave, "large": wave, "slow": np.sin(2 * np.pi * np.arange(1000) / 1000)}
    drive = np.concatenate([words[word] for word in drives])[None]
    assert enough(drive, 1000) == 1000 * share


def test_a_situation_is_place_speed_and_how_long():
    rest, up, down = np.zeros(8), np.linspace(0, 1, 9)[1:], np.linspace(1, 0, 9)[1:]
    kinds = situations(np.concatenate([rest, up, down]))
    assert kinds[10] != kinds[-5]  # the same place, another way
    assert len(set(kinds[[1, 3, 7]])) == 3  # rested longer and longer


@pytest.mark.parametrize(("counts", "most"), [([50, 250, 1000], 75), ([10, 20, 30], 30), ([1000, 1000], 100)])
def test_short_records_stay_whole(counts, most, monkeypatch):
    monkeypatch.setattr(thinning, "LONG", 200)
    assert most_of(np.array(counts)) == most


def long_case(parameters):
    """A stage, sampled three times as fast as needed."""
    fine = [np.interp(np.arange(TIMES * u.size) / TIMES, np.arange(u.size), u) for u in stage.loops()]
    case = Case(("bouc_wen",), (), stage.records(parameters, fine, dt=5e-3 / TIMES, steps=2), {})
    return stage.considering(case, "quadratic_gain", "asymmetry", "saturation", "creep")


def test_a_verdict_on_fewer_samples_is_carried_to_all(monkeypatch):
    case = long_case(stage.EFFECTS["quadratic_gain"])
    records = [case.record_with_steps(i, 1) for i in range(2)]
    assert thinned(case) is None
    monkeypatch.setattr(thinning, "LONG", records[0].samples // TIMES)
    fewer = thinned(case)
    assert fewer.records[0].dt >= 5e-3 and fewer.floor == case.floor
    assert fewer.records[1] is case.records[1] and case.records[1].use == "validate"
    staircase = thinning.improve(case, lambda case: first_fit(case, 0))
    assert (staircase.last.verdict, staircase.steps[-1].added) == ("adequate", "quadratic_gain")
    assert "what was found holds on all" in staircase.last.reason
    for step in staircase.steps:
        assert list(step.fit.problem.records) == records


def test_what_does_not_hold_on_all_samples_is_sought_on_all(monkeypatch):
    case, asked = long_case({}), []
    monkeypatch.setattr(thinning, "LONG", 700)
    monkeypatch.setattr(thinning, "holds", lambda case, fit, whole: False)

    def first(case):
        asked.append(case)
        return first_fit(case, 0)

    staircase = thinning.improve(case, first)
    assert len(asked) == 2 and asked[1] is case
    assert "Effects were sought on" not in staircase.last.reason


def test_what_is_doubted_on_fewer_samples_and_proven_on_all_is_sought_on_all(monkeypatch):
    case = long_case(stage.EFFECTS["quadratic_gain"])
    monkeypatch.setattr(thinning, "LONG", 700)
    dt, beyond_form = case.records[0].dt, proof.beyond_form
    monkeypatch.setattr(proof, "beyond_form", lambda at, *fits: at.records[0].dt == dt and beyond_form(at, *fits))
    staircase = thinning.improve(case, lambda case: first_fit(case, 0))
    assert (staircase.last.verdict, staircase.steps[-1].added) == ("adequate", "quadratic_gain")
    assert "Effects were sought on" not in staircase.last.reason


def test_an_earlier_model_that_is_proven_on_fewer_samples_is_carried_to_all(monkeypatch):
    """What was added after it is a suspect, and no step takes it out."""
    case = long_case(stage.EFFECTS["quadratic_gain"])
    monkeypatch.setattr(thinning, "LONG", 700)

    def back(*given):
        found = improve(*given)
        proven = found.steps[-1].fit
        suspect = proof.Suspect("drift", 0.1, 0.1, proven)
        steps = [*found.steps, Step(proven, "drift"), Step(proven, change=PROVEN)]
        return replace(found, steps=steps, suspects=[suspect])

    improve = stairs.improve
    monkeypatch.setattr(stairs, "improve", back)
    staircase = thinning.improve(case, lambda case: first_fit(case, 0))
    assert staircase.steps[-1].change == PROVEN
    assert [suspect.effect for suspect in staircase.suspects] == ["drift"]
    assert "what was found holds on all" in staircase.last.reason


def test_what_is_sought_on_all_samples_has_all_of_the_budget(monkeypatch):
    case, searches = long_case({}), []
    case.budget = Budget(100.0)

    def search(at, *more):
        searches.append((at is case, at.budget.seconds, list(case.budget.untried)))
        assert not at.budget.allows("pairs", share=0.0)

    monkeypatch.setattr(thinning, "LONG", 700)
    monkeypatch.setattr(thinning, "on_all_samples", lambda *given: None)
    monkeypatch.setattr(thinning.stairs, "improve", search)
    monkeypatch.setattr(thinning, "without_outdone", lambda case, found: found)
    thinning.improve(case, lambda case: None)
    assert searches == [(False, 50.0, []), (True, 100.0, [])]
