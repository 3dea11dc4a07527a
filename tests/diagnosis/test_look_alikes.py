"""Look-alikes are as far as the best effect led: by hand, the noise floor being 1."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from made_fits import CASE, fit
from pzt_ident.diagnosis import forms, look_alikes
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.forms import Candidate
from pzt_ident.diagnosis.score import Score


@pytest.mark.parametrize("own, led", [(6.0, 1.0), (6.0, 7.0)])
def test_a_look_alike_far_behind_is_tried_from_where_the_best_led(monkeypatch, own, led):
    monkeypatch.setattr(forms, "refit", lambda case, other, effects, guess, rival: fit(led, led, effects))
    best = Candidate.of([Score("amplifier_lag", guesses=[{"tau": 1.0}])])
    rival = Candidate.of([Score("sensor_lag", guesses=[{"tau": 1.0}])])
    stranger = Candidate.of([Score("saturation", guesses=[{"knee": 1.0}])])
    for item, left in ((best, 1.0), (rival, own), (stranger, own)):
        word = item.score.effect
        item.refits = {word: fit(left, left, [word])}
        item.take(word)
    look_alikes.restart_look_alikes(CASE, fit(9.0, 9.0), fit(9.0, 9.0), [best, rival, stranger])
    assert rival.fit.identify == rival.refits["sensor_lag"].identify == min(own, led)
    assert best.fit.identify == 1.0 and stranger.fit.identify == own


@pytest.mark.parametrize(("led", "form"), [(1.0, "amplifier_lag"), (3.0, "amplifier_lag.two_poles")])
def test_a_look_alike_is_in_its_first_form_where_that_is_as_good_from_where_the_best_led(monkeypatch, led, form):
    """One pole rested in a side minimum of its time constant, two did not."""
    monkeypatch.setattr(forms, "refit", lambda case, other, effects, guess, rival: fit(led, led, effects))
    best = Candidate.of([Score("slew_limit", guesses=[{"slowness": 1.0}])])
    best.refits = {"slew_limit": fit(1.0, 1.0, ["slew_limit"])}
    best.take("slew_limit")
    items = ["amplifier_lag", "amplifier_lag.two_poles"]
    rival = Candidate.of([Score(item, guesses=[{"tau": 1.0}]) for item in items])
    rival.refits = {item: fit(left, left, [item]) for item, left in zip(items, (11.6, 1.05), strict=True)}
    rival.take(items[1])
    look_alikes.restart_look_alikes(CASE, fit(14.0, 14.0), fit(14.0, 14.0), [best, rival])
    assert rival.score.effect == form and rival.fit is rival.refits[form]


@pytest.mark.parametrize(("led", "form"), [(1.0, "voltage"), (1.05, "linear_displacement")])
def test_the_best_is_in_the_form_of_fewest_parameters_that_is_the_same_model_from_where_it_led(monkeypatch, led, form):
    """A coupling by voltage rested in a side minimum, unlike one by a displacement that has a resonance beside it."""

    def refitted(case, other, effects, guess, rival):
        return fit(led if effects[-1] == "cross_coupling.voltage" else 2.3, 1.0, effects)

    monkeypatch.setattr(forms, "refit", refitted)
    monkeypatch.setattr(forms, "with_modes_exchanged", lambda fit: [])
    lefts = {
        "cross_coupling": (2.4, 4),
        "cross_coupling.voltage": (1.4, 4),
        "cross_coupling.linear_displacement": (1.0, 6),
    }
    best = Candidate.of([Score(item, guesses=[{"ratio": 1.0}]) for item in lefts])
    best.refits = {item: fit(left, left, [item], many) for item, (left, many) in lefts.items()}
    best.take("cross_coupling.linear_displacement")
    look_alikes.restart_look_alikes(CASE, fit(9.0, 9.0), fit(9.0, 9.0), [best])
    assert best.score.effect == f"cross_coupling.{form}" and best.fit is best.refits[best.score.effect]


def test_a_look_alike_in_another_form_is_started_anew_by_the_name_of_its_block(monkeypatch):
    def started(case, fit, block, starts):
        assert block == "sensor_lag"
        return replace(fit, identify=1.5)

    monkeypatch.setattr(look_alikes, "restart", started)
    monkeypatch.setattr(look_alikes, "from_where", lambda case, other, fit, guess: fit)
    best = Candidate.of([Score("amplifier_lag", guesses=[{"tau": 1.0}])])
    best.refits, item = {"amplifier_lag": fit(1.5, 1.5)}, "sensor_lag.second_order"
    rival = Candidate.of([Score(item, guesses=[{"one": 1.0, "two": 2.0}])])
    rival.refits = {item: fit(1.52, 9.0)}
    for candidate, word in ((best, "amplifier_lag"), (rival, item)):
        candidate.take(word)
    look_alikes.restart_look_alikes(CASE, fit(9.0, 9.0), fit(9.0, 9.0), [best, rival])
    assert rival.fit.identify == rival.refits[item].identify == 1.5


@pytest.mark.parametrize(("left", "bound", "refitted"), [(1.0, 0.5, ["load_mass"]), (4.0, 0.5, []), (1.0, 0.0, [])])
def test_a_look_alike_of_fewer_parameters_is_tried_at_the_noise_whatever_it_scored(monkeypatch, left, bound, refitted):
    """A side minimum of the base made up for a payload, which scored a tenth; a second mode then led to the noise."""
    sizes = {"resonance": 8, "load_mass": 6, "viscous_damping": 9, "creep": 6}
    case = SimpleNamespace(
        floor=1.0, budget=Budget(), problem=lambda e, steps: SimpleNamespace(dimensions=sizes[e[-1]])
    )
    monkeypatch.setattr(look_alikes, "refit_from", lambda case, before, effects, guesses, rival: fit(1.0, 1.0, effects))
    first, offered = fit(20.0, 20.0, own=[bound]), [Candidate.of([Score(word, explained=0.1)]) for word in sizes]
    first.problem.records = []
    best = fit(left, left, ("resonance",), dimensions=sizes["resonance"])
    offered[0].refits = {"resonance": best}
    offered[0].take("resonance")
    simpler = look_alikes.simpler_look_alikes(case, first, first, offered, offered[:1])
    assert [item.score.effect for item in simpler] == refitted
    assert all(item.fit is item.refits[item.score.effect] for item in simpler)
