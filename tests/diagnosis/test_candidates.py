"""Which refits are started elsewhere: by hand, the noise floor being 1."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from made_fits import CASE, fit
from pzt_ident.diagnosis import candidates
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.forms import Candidate
from pzt_ident.diagnosis.score import Score
from pzt_ident.model.registry import blocks


@pytest.mark.parametrize("confirmed", [False, True])
def test_what_other_records_do_not_confirm_is_started_anew_where_nothing_is_adequate(monkeypatch, confirmed):
    """A mode that only the others make ring may rest anywhere."""
    monkeypatch.setattr(candidates, "restart", lambda case, fit: replace(fit, validate=1.2))
    case = SimpleNamespace(floor=1.0, budget=Budget())
    fits = {"quadratic_gain": fit(1.04, 14.4), "saturation": fit(2.5, 14.2)}
    if confirmed:
        fits["creep"] = fit(1.0, 1.0)
    shortlist = [Candidate(Score(word), refits={word: made}) for word, made in fits.items()]
    candidates.restart_unconfirmed(case, fit(20.0, 20.0), shortlist)
    validated = [item.refits[item.score.effect].validate for item in shortlist]
    assert validated == ([14.4, 14.2, 1.0] if confirmed else [1.2, 14.2])


def test_of_the_forms_that_other_records_do_not_confirm_the_best_is_started_anew(monkeypatch):
    monkeypatch.setattr(candidates, "restart", lambda case, fit: replace(fit, validate=1.2))
    case = SimpleNamespace(floor=1.0, budget=Budget())
    refits = {"slew_limit": fit(1.04, 17.0), "slew_limit.soft": fit(1.02, 17.0), "slew_limit.lag": fit(1.06, 17.0)}
    limit = Candidate(Score("slew_limit"), refits=refits)
    candidates.restart_unconfirmed(case, fit(20.0, 20.0), [limit])
    assert [made.validate for made in limit.refits.values()] == [17.0, 1.2, 17.0]


@pytest.fixture
def unaccounted(monkeypatch):
    """No second effect is looked for."""
    monkeypatch.setattr(candidates, "account_beside", lambda case, first, fit: None)


@pytest.mark.usefixtures("unaccounted")
@pytest.mark.parametrize(
    ("driven", "promised", "rests", "anew"),
    [
        (True, "", False, ["friction.coulomb", "friction"]),
        (True, "kinematic_coupling", False, None),
        (False, "", False, None),
        (False, "", True, ["friction.coulomb"]),
        (True, "distributed_memory", True, ["friction.coulomb"]),
        (True, "saturation", True, None),
    ],
)
def test_an_effect_is_fitted_from_random_points_unless_another_promises_what_it_leaves(
    monkeypatch, driven, promised, rests, anew
):
    """A friction that leaves a coupling rests on bounds for want of that; where the model as given rests there, too,
    far from the noise, a memory, which the base has, mends nothing. driven: onto bounds; rests: there all along; anew:
    the forms, of those that explain nearly as much as the best."""
    first, tried = fit(12.0, 12.0), []
    scores = {"friction": 0.75, "friction.coulomb": 0.8, "friction.motion": 0.7}
    candidate = Candidate.of([Score(item, explained=share) for item, share in scores.items()])
    errors = {"friction": 6.0, "friction.coulomb": 5.0}
    refits = {item: fit(error, error, (item,)) for item, error in errors.items()}
    monkeypatch.setattr(candidates, "refit_from", lambda case, before, effects, *_: refits[effects[-1]])
    monkeypatch.setattr(
        candidates, "refit_likely_forms", lambda case, first, before, candidate: candidate.take("friction.coulomb")
    )
    monkeypatch.setattr(candidates, "drives_onto_bounds", lambda case, first, candidate: driven)
    monkeypatch.setattr(candidates, "rests_on_bounds", lambda case, first, fit: rests)
    monkeypatch.setattr(candidates, "promises_most", lambda case, first, best: promised)
    monkeypatch.setattr(candidates, "refit_anew", lambda case, first, candidate, items: tried.append(items))
    assert candidates.refit_all(CASE, first, first, [candidate]) == [candidate]
    assert tried == ([anew] if anew else [])


@pytest.mark.usefixtures("unaccounted")
@pytest.mark.parametrize(
    ("friction", "memory", "driven", "further"),
    [
        ((3.0, 9.2), (3.4, 6.6), True, ["friction"]),
        ((3.0, 9.2), (3.4, 6.6), False, []),
        ((3.6, 5.0), (3.4, 6.6), True, []),
    ],
)
def test_what_is_closest_to_the_fitted_records_is_refitted_further_where_it_drives_the_model_onto_bounds(
    monkeypatch, friction, memory, driven, further
):
    """A friction that takes the place of all hysteresis, which other records do not confirm, may rest astray."""
    first, gone_on = fit(6.4, 9.0), []
    offered = [Candidate.of([Score(word, explained=0.6)]) for word in ("distributed_memory", "friction")]
    refits = {"friction": fit(*friction, ["friction"]), "distributed_memory": fit(*memory, ["distributed_memory"])}
    monkeypatch.setattr(candidates, "refit_from", lambda case, before, effects, *_: refits[effects[-1]])
    monkeypatch.setattr(candidates, "drives_onto_bounds", lambda case, first, candidate: driven)

    def refit_from_random_points(case, first, candidate):
        gone_on.append(candidate.score.effect)

    monkeypatch.setattr(candidates, "rests_on_bounds", lambda case, first, fit: False)
    monkeypatch.setattr(candidates, "refit_from_random_points", refit_from_random_points)
    assert candidates.refit_all(CASE, first, first, offered) == offered
    assert gone_on == ["distributed_memory", *further]
    gone_on.clear()
    candidates.refit_all(CASE, fit(20.0, 20.0), first, offered)
    assert not gone_on  # beside other effects it is not


@pytest.mark.usefixtures("unaccounted")
@pytest.mark.parametrize(("more", "anew"), [(0, []), (1, ["creep"])])
def test_nothing_is_fitted_from_random_points_beside_an_adequate_effect_of_no_more_parameters(monkeypatch, more, anew):
    """What scores best may rest on bounds since it stands in for what is refitted after it, in a tenth of the time."""
    first, gone_on = fit(12.0, 12.0), []
    offered = [Candidate.of([Score(word, explained=0.9)]) for word in ("creep", "amplifier_lag")]
    refits = {"creep": fit(4.0, 5.0, ["creep"]), "amplifier_lag": fit(1.0, 1.0, ["amplifier_lag"])}
    refits["amplifier_lag"].problem.dimensions += more
    monkeypatch.setattr(candidates, "refit_from", lambda case, before, effects, *_: refits[effects[-1]])
    monkeypatch.setattr(
        candidates, "refit_from_random_points", lambda case, first, item: gone_on.append(item.score.effect)
    )
    candidates.refit_all(CASE, first, first, offered)
    assert gone_on == anew


@pytest.mark.parametrize("many", ["distributed_memory", "periodic_disturbance"])
@pytest.mark.parametrize(("bend", "first"), [(0.86, "saturation"), (0.61, "saturation"), (0.59, None)])
def test_what_has_many_amounts_is_refitted_behind_what_explains_most_too(bend, first, many):
    scores = [Score(many, 0.92), Score("saturation", bend), Score("creep", 0.5)]
    ordered = candidates.simpler_first([Candidate.of([score]) for score in scores])
    assert ordered[0].score.effect == (first or many) and len(ordered) == 3
    alone = [Candidate.of([score]) for score in scores[:1]]
    assert candidates.simpler_first(alone) == alone and candidates.simpler_first([]) == []


def test_a_disturbance_is_on_the_short_list_whatever_scores_more():
    others = [word for word in blocks.effects() if not blocks[word].amounts()]
    words = [*others, "periodic_disturbance", "drift"]
    promising = [Candidate.of([Score(word, 1 / place)]) for place, word in enumerate(words, 1)]
    assert [item.score.effect for item in candidates.short_list(promising)] == [
        *others[: candidates.SHORTLIST],
        *words[-2:],
    ]


def test_disturbances_of_the_short_list_are_refitted_behind_the_first_effect():
    words = ["saturation", "creep", "drift", "quadratic_gain", "periodic_disturbance"]
    promising = [Candidate.of([Score(word, 1 / place)]) for place, word in enumerate(words, 1)]
    assert [item.score.effect for item in candidates.short_list(promising)] == [words[i] for i in (0, 2, 4, 1, 3)]


@pytest.mark.usefixtures("unaccounted")
@pytest.mark.parametrize(
    ("listed", "explains", "expected"),
    [(True, False, "all"), (True, True, "two"), (False, False, "all"), (False, True, "none")],
)
def test_a_disturbance_is_refitted_in_all_of_its_forms_as_long_as_no_effect_explains_most(
    monkeypatch, listed, explains, expected
):
    """What a ripple of the drive does to the hysteresis is not linear: its score tells little of it."""
    fitted, left = [], 3.0 if explains else 19.0

    def refit_from(case, before, effects, guesses, rival):
        fitted.append(effects[-1])
        return fit(left, left, effects)

    monkeypatch.setattr(candidates, "SHORTLIST", 2 if listed else 1)
    monkeypatch.setattr(candidates, "refit_from", refit_from)
    monkeypatch.setattr(candidates, "from_each_other", lambda case, fits, rival: fits)
    monkeypatch.setattr(candidates, "refit_likely_forms", lambda *arguments: None)
    monkeypatch.setattr(candidates, "refit_astray", lambda *arguments: None)
    hum = blocks.forms("periodic_disturbance")
    some = [[Score(item, 0.3) for item in blocks.forms("creep")], [Score(item, 0.2) for item in hum]]
    some[1][-1].explained = 0.3
    first = fit(20.0, 20.0)
    candidates.refit_all(CASE, first, first, [Candidate.of(scores) for scores in some])
    forms = {"all": hum, "two": [hum[0], hum[-1]], "none": []}[expected]
    assert sorted(fitted) == sorted(["creep", *forms]) and len(hum) > 2


@pytest.mark.parametrize(
    ("left", "beside", "refitted"), [(9.0, False, ["delay"]), (3.0, False, []), (9.0, True, []), (1.0, False, [])]
)
def test_what_scores_little_is_refitted_where_nothing_explains_most(monkeypatch, left, beside, refitted):
    """A delay by a period of the mode, which scored a hundredth, left 1.9 of 17.7 floors."""
    first, tried = fit(10.0, 10.0), []

    def refit_from(case, before, effects, guesses, rival):
        tried.append((effects[-1], rival))
        return fit(2.0, 2.0, effects)

    monkeypatch.setattr(candidates, "refit_from", refit_from)
    offered = [
        Candidate.of([Score(word, share, guesses=[{f"{word}.size": 1.0}] if share else [])])
        for word, share in {"resonance": 0.5, "delay": 0.01, "drift": 0.0}.items()
    ]
    offered[0].refits = {"resonance": fit(left, left, ["resonance"])}
    shortlist = offered[:1]
    candidates.refit_the_rest(CASE, first, fit(10.0, 10.0, ["creep"]) if beside else first, offered, shortlist)
    assert [word for word, _ in tried] == refitted and all(rival == left for _, rival in tried)
    assert [item.score.effect for item in shortlist[1:]] == refitted
    assert all(item.refits for item in shortlist)


@pytest.mark.parametrize(
    ("left", "promised", "together", "second"),
    [
        (4.0, {"cross_coupling": 0.9}, {"cross_coupling": (1.0, 1.0)}, "cross_coupling"),
        (4.0, {"cross_coupling": 0.6}, {"cross_coupling": (1.4, 1.4)}, "cross_coupling"),
        (4.0, {"cross_coupling": 0.6}, {"cross_coupling": (1.1, 4.0)}, "cross_coupling"),
        (4.0, {"cross_coupling": 0.6}, {"cross_coupling": (1.9, 2.0)}, "cross_coupling"),
        (4.0, {"cross_coupling": 0.6}, {"cross_coupling": (1.9, 2.1)}, None),
        (2.2, {"cross_coupling": 0.6}, {"cross_coupling": (1.9, 1.9)}, None),
        (4.0, {"cross_coupling": 0.4}, {"cross_coupling": (1.0, 1.0)}, None),
        (4.0, {"drift": 0.9}, {"drift": (1.0, 1.0)}, None),
        (9.0, {"cross_coupling": 0.9}, {"cross_coupling": (1.0, 1.0)}, None),
        (1.0, {"cross_coupling": 0.9}, {"cross_coupling": (1.0, 1.0)}, None),
        (
            4.0,
            {"distributed_memory": 0.9, "saturation": 0.8, "friction": 0.7},
            {"distributed_memory": (1.0, 1.0), "saturation": (1.6, 1.6), "friction": (1.0, 1.0)},
            "friction",
        ),
        (
            4.0,
            {"saturation": 0.9, "friction": 0.8, "slew_limit": 0.7},
            {"saturation": (1.7, 1.7), "friction": (1.6, 1.6)},
            "friction",
        ),
        (4.0, {"friction": 0.9, "saturation": 0.8, "slew_limit": 0.7, "resonance": 0.6}, {"resonance": (1, 1)}, None),
    ],
)
def test_two_effects_account_for_all_where_the_second_promises_most_of_what_the_first_leaves(
    monkeypatch, left, promised, together, second
):
    """A creep of half of the misfit at least, which is not adequate alone, and one of three others: no look-alike, and
    last what follows anything. What is not near the noise, or at that of the records that are fitted, leaves two
    noise floors of all at most, and half of what the creep leaves."""
    offered = [Candidate.of([Score(word, share, share, guesses=[{}])]) for word, share in promised.items()]
    monkeypatch.setattr(candidates, "score_all", lambda *given, in_every_form: offered)
    monkeypatch.setattr(candidates, "scorer_of", lambda case, fit: None)
    monkeypatch.setattr(
        candidates,
        "refit_from",
        lambda case, before, effects, guesses: fit(*together.get(effects[-1], (4.0, 4.0)), effects),
    )
    account = candidates.account_beside(CASE, fit(12.0, 12.0), fit(left, left, ["creep"]))
    assert (account.effects if account else None) == (("creep", second) if second else None)


@pytest.mark.parametrize(
    ("account", "refitted"),
    [
        (None, ["creep", "friction", "saturation"]),
        (2.0, ["creep", "friction", "saturation"]),
        (1.0, ["creep", "saturation"]),
    ],
)
def test_where_two_effects_account_for_all_only_what_may_do_so_alone_is_refitted(monkeypatch, account, refitted):
    first, shares = fit(12.0, 12.0), {"creep": 0.8, "saturation": 0.4, "friction": 0.2}
    offered = [Candidate.of([Score(word, share, guesses=[{}])]) for word, share in shares.items()]
    monkeypatch.setattr(candidates, "refit_from", lambda case, before, effects, *_: fit(8.0, 11.0, effects))
    monkeypatch.setattr(candidates, "account_beside", lambda *given: account and fit(account, account))
    for astray in ("drives_onto_bounds", "rests_on_bounds"):
        monkeypatch.setattr(candidates, astray, lambda *given: False)
    made = candidates.refit_all(CASE, first, first, offered)
    assert sorted(item.score.effect for item in made) == refitted
    shortlist = [*made]
    candidates.refit_the_rest(CASE, first, first, offered, shortlist)
    assert len(shortlist) == len(made) and (made[0].account is not None) == bool(account)


@pytest.mark.parametrize(("alone", "both", "dropped"), [(1.0, 1.0, True), (2.0, 1.0, False), (1.8, 1.9, True)])
def test_two_effects_account_for_nothing_that_one_does_alone(alone, both, dropped):
    """A memory and a bend were at the noise, before another form of the bend was there alone. Nor where it leaves no
    more: of a real bender a lag left less than a mode and a gain by the swing."""
    memory = Candidate(
        Score("distributed_memory"), refits={"distributed_memory": fit(2.1, 2.1)}, account=fit(both, both)
    )
    forms = {"quadratic_gain": fit(2.2, 2.1), "quadratic_gain.displacement": fit(alone, alone)}
    candidates.drop_outdone_accounts(CASE, fit(4.0, 3.0), [memory, Candidate(Score("quadratic_gain"), refits=forms)])
    assert (memory.account is None) == dropped


@pytest.mark.usefixtures("unaccounted")
@pytest.mark.parametrize(("damped", "anew"), [(3.6, "viscous_damping"), (3.7, "resonance")])
def test_the_simplest_of_the_closest_is_refitted_where_it_leads_off_the_bounds_of_the_model(monkeypatch, damped, anew):
    """A damper left 3.70 floors of a density that rested on a bound, a second mode 3.57, and from elsewhere 0.9."""
    first, gone_on = fit(8.7, 8.5), []
    left = {"friction": (5.0, 8), "viscous_damping": (damped, 6), "resonance": (3.3, 9)}
    offered = [Candidate.of([Score(word, explained=0.6)]) for word in left]
    refits = {word: fit(error, error, [word], size) for word, (error, size) in left.items()}
    monkeypatch.setattr(candidates, "refit_from", lambda case, before, effects, *_: refits[effects[-1]])
    monkeypatch.setattr(candidates, "drives_onto_bounds", lambda case, first, candidate: False)
    monkeypatch.setattr(candidates, "rests_on_bounds", lambda case, first, fit: fit.effects[-1] == anew)
    monkeypatch.setattr(
        candidates, "refit_from_random_points", lambda case, first, item: gone_on.append(item.score.effect)
    )
    candidates.refit_all(CASE, first, first, offered)
    assert gone_on == ["friction", anew]
