"""Which forms of an effect are refitted, and which is meant: by hand, the noise floor being 1."""

from types import SimpleNamespace

import numpy as np
import pytest

from made_fits import CASE, fit
from pzt_ident.diagnosis import forms
from pzt_ident.diagnosis.forms import Candidate, choose_forms, clearly_best
from pzt_ident.diagnosis.score import Score
from pzt_ident.model.registry import blocks


@pytest.mark.parametrize(
    ("usual", "other", "more", "rival", "taken"),
    [
        (5.0, 3.0, 1, 4.0, "friction"),
        (5.0, 3.0, 0, 4.0, "friction.coulomb"),
        (5.0, 4.997, 0, 4.0, "friction"),
        (5.0, 2.5, 1, 4.0, "friction.coulomb"),
        (5.0, 1.1, 1, 4.0, "friction.coulomb"),
        (1.1, 1.0, 1, 4.0, "friction.coulomb"),
        (1.1, 1.09, 1, 4.0, "friction"),
        (5.0, 3.0, 1, 1.1, "friction.coulomb"),
    ],
    ids=[
        "not enough",
        "as simple",
        "as simple and as good",
        "decisive",
        "enough",
        "better",
        "as good",
        "beside enough",
    ],
)
def test_a_form_of_more_parameters_is_meant_only_where_one_effect_is_enough(usual, other, more, rival, taken):
    """RMSE in noise floors, of a model that is adequate up to 1.17; forms are as good to a fifth of the noise."""
    friction = Candidate.of([Score("friction", explained=0.5), Score("friction.coulomb", explained=0.9)])
    friction.refits = {"friction": fit(usual, usual), "friction.coulomb": fit(other, other, dimensions=4 + more)}
    creep = Candidate.of([Score("creep", explained=0.5)])
    creep.refits = {"creep": fit(rival, rival)}
    choose_forms(CASE, fit(10.0, 10.0), [friction, creep])
    assert friction.score.effect == taken
    assert friction.fit is friction.refits[taken]
    assert creep.fit is creep.refits["creep"]


@pytest.mark.parametrize("plain, led, kept", [(8.0, 4.0, 4.0), (8.0, 9.0, 8.0), (3.9, 1.0, 3.9)])
def test_a_form_far_behind_another_one_is_tried_from_where_that_led(monkeypatch, plain, led, kept):
    """And no worse than from its own guess."""
    refits = {"creep": fit(plain, plain, ["creep"]), "creep.voltage": fit(3.0, 3.0, ["creep.voltage"])}

    def refit(case, other, effects, guess, rival):
        assert other is refits["creep.voltage"] and effects == ("creep",)
        return fit(led, led, effects)

    monkeypatch.setattr(forms, "refit", refit)
    monkeypatch.setattr(forms, "with_modes_exchanged", lambda fit: [])
    found = forms.from_each_other(CASE, refits)
    assert found["creep"].identify == kept and found["creep.voltage"] is refits["creep.voltage"]


@pytest.mark.parametrize(("rests", "left", "sought"), [(True, 4.0, True), (False, 4.0, False), (True, 1.0, False)])
def test_an_effect_that_drives_the_model_onto_bounds_is_fitted_from_random_points(monkeypatch, rests, left, sought):
    """In each of its forms, as long as it leaves more than the noise, and whatever it promised."""
    first, tried = fit(12.0, 12.0), []
    candidate = Candidate(Score("friction", 0.6), forms=[Score("friction", 0.6), Score("friction.commanded", 0.5)])
    candidate.refits = {"friction": fit(left, left, ["friction"])}

    def first_fit(case, seed, effects, rival):
        tried.append(effects[-1])
        assert rival == left
        return fit(1.0, 1.0, effects) if effects[-1] == "friction.commanded" else fit(5.0, 5.0, effects)

    monkeypatch.setattr(forms, "first_fit", first_fit)
    monkeypatch.setattr(forms, "refit_from", lambda case, before, effects, *_: fit(4.5, 4.5, effects))
    monkeypatch.setattr(forms, "rests_anew", lambda before, fit: rests)
    forms.refit_likely_forms(CASE, first, first, candidate)
    forms.refit_anew(CASE, first, candidate, ["friction", "friction.commanded"])
    assert tried == (["friction", "friction.commanded"] if sought else [])
    assert candidate.best.identify == (1.0 if sought else left)


@pytest.mark.parametrize("resting", ["friction", "friction.commanded"])
def test_the_form_that_is_closest_to_the_fitted_records_tells_whether_the_model_is_driven_onto_bounds(
    monkeypatch, resting
):
    """Though another form leaves less of all records: what rests in a side minimum predicts little."""
    refits = {"friction": fit(4.0, 6.2, ["friction"]), "friction.commanded": fit(3.0, 9.2, ["friction.commanded"])}
    monkeypatch.setattr(forms, "rests_anew", lambda before, fit: fit.effects[-1] == resting)
    candidate = Candidate(Score("friction", 0.5), refits=refits)
    assert candidate.best is refits["friction"]
    assert forms.drives_onto_bounds(CASE, fit(6.4, 9.0), candidate) == (resting == "friction.commanded")


@pytest.mark.parametrize("item", blocks.effects())
def test_only_a_density_takes_the_place_of_the_model_without_being_astray(monkeypatch, item):
    """A bank of many amounts has its own hysteresis: the one that the model had may well end on its bounds."""
    monkeypatch.setattr(forms, "rests_anew", lambda before, fit: True)
    candidate = Candidate(Score(item, 0.9), refits={item: fit(4.0, 4.0, [item])})
    assert forms.drives_onto_bounds(CASE, fit(12.0, 12.0), candidate) == (item != "distributed_memory")


@pytest.mark.parametrize(
    ("before", "after", "anew"),
    [
        ([], ["bouc_wen.alpha"], True),
        (["bouc_wen.alpha"], ["bouc_wen.alpha"], False),
        (["bouc_wen.alpha"], ["bouc_wen.beta"], True),
        ([], ["friction.reach"], False),
    ],
)
def test_only_parameters_of_the_model_itself_rest_anew(before, after, anew):
    problem = SimpleNamespace(names=["bouc_wen.alpha", "bouc_wen.beta"])
    bare, with_effect = SimpleNamespace(problem=problem, on_bounds=before), SimpleNamespace(on_bounds=after)
    assert forms.rests_anew(bare, with_effect) == anew


@pytest.mark.parametrize(
    ("given", "after", "left", "rests"),
    [
        (["gain"], ["gain"], 6.0, True),
        (["gain"], ["gain"], 4.0, False),
        (["gain"], [], 4.0, True),
        (["gain"], [], 1.0, False),
        ([], ["gain"], 6.0, False),
        (["gain"], ["knee"], 4.0, True),
    ],
)
def test_a_side_minimum_rests_on_the_same_bounds_far_from_the_noise_or_is_on_the_way_off_these(
    given, after, left, rests
):
    problem = SimpleNamespace(names=["gain"])
    first = SimpleNamespace(identify=20.0, validate=20.0, total=20.0, problem=problem, on_bounds=given)
    best = SimpleNamespace(identify=left, validate=left, total=left, on_bounds=after)
    assert forms.rests_on_bounds(CASE, first, best) == rests


@pytest.mark.parametrize(("ahead", "first"), [(0.001, "sensor_lag"), (0.1, "friction")])
def test_a_form_that_contains_another_effect_is_ranked_behind_it_where_it_explains_no_more(ahead, first):
    friction = Candidate.of([Score("friction", 0.1), Score("friction.lugre_viscous", 0.5 + ahead)])
    lag = Candidate.of([Score("sensor_lag", 0.5)])
    assert max(friction, lag, key=lambda item: item.rank).score.effect.startswith(first)


def test_no_form_is_tried_again_far_behind_another_effect_at_the_noise(monkeypatch):
    refits = {"creep": fit(8.0, 8.0, ["creep"]), "creep.voltage": fit(3.0, 3.0, ["creep.voltage"])}
    monkeypatch.setattr(forms, "refit", lambda case, other, effects, guess, rival: fit(2.9, 2.9, effects))
    monkeypatch.setattr(forms, "with_modes_exchanged", lambda fit: [])
    for rival, tried in ((1.0, False), (1.5, True), (np.inf, True)):
        assert (forms.from_each_other(CASE, refits, rival) != refits) == tried


def test_of_forms_that_cannot_be_simulated_the_usual_one_is_taken():
    """Their fits failed all: there is none that is hardly worse than the best."""
    refits = {item: fit(np.inf, np.inf, [item]) for item in ("creep", "creep.voltage")}
    assert clearly_best(CASE, refits, "creep") == "creep"


@pytest.mark.parametrize(("apart", "taken"), [(0.19, "cross_coupling.voltage"), (0.21, "cross_coupling.displacement")])
def test_of_forms_that_fit_as_well_the_one_of_fewest_parameters_is_meant(apart, taken):
    items = ["cross_coupling", "cross_coupling.voltage", "cross_coupling.displacement"]
    candidate = Candidate.of([Score(item, 0.9) for item in items])
    fits = fit(5.0, 5.0), fit(np.hypot(1.0, apart), np.hypot(1.0, apart)), fit(1.0, 1.0, dimensions=6)
    candidate.refits = dict(zip(items, fits, strict=True))
    choose_forms(CASE, fit(10.0, 10.0), [candidate])
    assert candidate.score.effect == taken


@pytest.mark.parametrize(("dimensions", "tried"), [(4, False), (6, True)])
def test_an_effect_at_the_noise_is_tried_in_its_other_forms_where_its_own_has_more_parameters(dimensions, tried):
    """One of them may be the model of a look-alike to the last digit."""
    own, alike = Candidate.of([Score("cross_coupling", 0.9)]), Candidate.of([Score("kinematic_coupling", 0.8)])
    own.refits = {"cross_coupling": fit(5.0, 5.0)}
    best = fit(1.0, 1.0, ["cross_coupling.displacement"], dimensions=dimensions)
    assert forms.alternatives(CASE, best, [own, alike]) == ([own, alike] if tried else [alike])


@pytest.mark.parametrize(("left", "sought"), [(1.8, True), (1.0, False), (6.0, False)])
@pytest.mark.parametrize("explained", [0.91, 0.89])
def test_beside_one_that_is_not_adequate_an_effect_is_tried_that_explains_nearly_all_in_another_form(
    monkeypatch, left, sought, explained
):
    """A relaxation left 1.8 noise floors of a ripple of the drive, of which the first form, a hum, scores nothing; what
    is left far above the noise is a second effect's."""
    relaxation = Candidate.of([Score("thermal_relaxation", 0.97)])
    relaxation.refits = {"thermal_relaxation": fit(left, left, ["thermal_relaxation"])}
    hum = Candidate.of([Score("periodic_disturbance", 0.02)])
    scores = {
        "thermal_relaxation": [Score("thermal_relaxation", 0.97)],
        "periodic_disturbance": [Score("periodic_disturbance", 0.02), Score("periodic_disturbance.ripple", explained)],
    }
    refitted = []

    def refit_from(case, before, effects, guesses, rival):
        refitted.append(effects[-1])
        return fit(1.0, 1.0, effects)

    monkeypatch.setattr(forms, "scorer_of", lambda case, fit: SimpleNamespace(scores=scores.__getitem__))
    monkeypatch.setattr(forms, "refit_from", refit_from)
    first, shortlist = fit(30.0, 30.0), [relaxation]
    forms.refit_other_forms(CASE, first, first, [relaxation, hum], shortlist)
    found = sought and explained >= forms.NEARLY_ALL
    assert ("periodic_disturbance.ripple" in refitted) == found
    assert (hum in shortlist) == found


@pytest.mark.parametrize(("left", "helps"), [(8.0, True), (9.95, False)])
def test_where_something_helps_half_of_the_time_for_exploring_is_kept_for_what_is_beside_it(monkeypatch, left, helps):
    """Refits in other forms beside a model of 10 noise floors end there."""
    shares, scores = [], [Score("saturation", 0.3), Score("saturation.cubic", 0.3)]
    budget = SimpleNamespace(beside=0.3, allows=lambda what, share: shares.append(share))
    case = SimpleNamespace(floor=1.0, floors=CASE.floors, on_event=CASE.on_event, budget=budget)
    bend = Candidate.of(scores)
    bend.refits = {"saturation": fit(left, left, ["saturation"])}
    monkeypatch.setattr(forms, "scorer_of", lambda case, fit: SimpleNamespace(scores=lambda word: scores))
    forms.refit_other_forms(case, fit(10.0, 10.0), fit(10.0, 10.0), [bend], [bend])
    assert shares == [0.3 if helps else forms.EXPLORING]


@pytest.mark.parametrize(("word", "left", "before", "tried"), [
    ("distributed_memory", 4.0, None, True),
    ("distributed_memory", 1.0, None, False),
    ("distributed_memory", 4.0, 12.0, False),
    ("creep", 4.0, None, False),
])  # fmt: skip
def test_beside_what_follows_anything_all_that_scores_is_tried_in_every_form(monkeypatch, word, left, before, tried):
    """A density took up most of a cubic saturation of the drive, of which no score tells. before: of a model that has
    an effect already."""
    refitted = []

    def refit_from(case, before, effects, guesses, rival):
        refitted.append(effects[-1])
        return fit(1.1, 1.1, effects)

    bend = Candidate.of([Score("saturation", 0.2), Score("saturation.cubic", 0.2)])
    most = Candidate.of([Score(word, 0.7)])
    most.refits = {word: fit(left, left, [word])}
    scores = {word: most.forms, "saturation": bend.forms}
    monkeypatch.setattr(forms, "scorer_of", lambda case, fit: SimpleNamespace(scores=scores.get))
    monkeypatch.setattr(forms, "refit_from", refit_from)
    given = fit(10.0, 10.0)
    model = fit(before, before, ["drift"]) if before else given
    shortlist = [most]
    forms.refit_other_forms(CASE, given, model, [most, bend], shortlist)
    assert ("saturation.cubic" in refitted) == tried == (bend in shortlist)


@pytest.mark.parametrize(("left", "limited", "second"), [(5.0, False, True), (5.0, True, False), (1.0, False, False)])
def test_no_second_effect_is_sought_beside_one_in_a_limit_in_which_it_is_something_else(
    monkeypatch, left, limited, second
):
    """A second mode that is the main one left 16 of 47 noise floors, and a delay, which was there, 11."""
    monkeypatch.setattr(forms, "is_limited", lambda fit: limited)
    before = fit(20.0, 20.0)
    assert forms.second_missing(CASE, before, before, [fit(left, left, ["resonance"])]) == second
