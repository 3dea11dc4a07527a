"""Two effects that make up for one give way to it, and two that are there do not."""

from types import SimpleNamespace

import pytest

import stage
from made_fits import CASE, fit
from pzt_ident.diagnosis import merging
from pzt_ident.diagnosis.merging import merge_effects
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.score import Score
from pzt_ident.diagnosis.starts import first_fit

BENT = stage.EFFECTS["quadratic_gain"]


def merged(parameters, *effects):
    """The effects in which a model of a stage that has some ends."""
    case = stage.considering(stage.case(parameters), "quadratic_gain", "delay", "sensor_lag", "amplifier_lag", "creep")
    steps = merge_effects(case, first := first_fit(case, 0), refit(case, first, effects, {}))
    return {*steps[-1].fit.effects} if steps else None


def test_one_effect_takes_the_place_of_two():
    """A lag of the reading was a delay and a lag of the amplifier."""
    lagging = BENT | stage.EFFECTS["sensor_lag"]
    assert merged(lagging, "quadratic_gain", "amplifier_lag", "delay") == {"quadratic_gain", "sensor_lag"}


def test_effects_that_are_there_stay():
    three = BENT | stage.EFFECTS["sensor_lag"] | stage.EFFECTS["creep"]
    assert merged(three, "quadratic_gain", "sensor_lag", "creep") is None


def test_two_effects_stay_as_they_are():
    assert merged(BENT | stage.EFFECTS["sensor_lag"], "quadratic_gain", "sensor_lag") is None


@pytest.mark.parametrize(("on_bounds", "anew"), [((), 0), (("bouc_wen.alpha",), 1)])
def test_beside_a_side_minimum_it_is_fitted_from_random_points_too(monkeypatch, on_bounds, anew):
    scorer = SimpleNamespace(scores=lambda word: [Score(word, 0.95 if word == "creep" else 0.1, guesses=[{}])])
    rough = SimpleNamespace(on_bounds=on_bounds)
    monkeypatch.setattr(merging, "scorer_of", lambda *_: scorer)
    monkeypatch.setattr(merging, "applicable", lambda *_: ["creep", "delay", "drift"])
    monkeypatch.setattr(merging, "refit_beside", lambda *_: rough)
    monkeypatch.setattr(merging, "first_fit", lambda *_, effects, rival: effects)
    tried = [*merging.in_place_of_two(CASE, fit(1.0, 1.0), fit(9.0, 9.0), ("drift", "delay"))]
    assert tried == [rough] + [("creep",)] * anew
