"""What unseen records do not confirm is tried behind other forms: by hand, the noise floor being 1."""

from types import SimpleNamespace

import pytest

import made_fits
import stage
from pzt_ident.diagnosis import behind
from pzt_ident.diagnosis.behind import accounts_behind, exchange_behind, possible_beside
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.model.registry import word_of

COUPLED, PUSHED, LIMIT = "kinematic_coupling", "cross_coupling.displacement", "slew_limit"


@pytest.fixture
def tried(monkeypatch):
    """The items that are tried behind a coupling in another form; `left` is what one of them leaves there of the
    validation records."""
    noted = SimpleNamespace(items=[], left=1.1)

    def accounts(case, before, effect, items):
        assert before.effects == (COUPLED,) == (effect,)
        noted.items += items
        yield made_fits.fit(12.0, 11.0, [PUSHED]), made_fits.fit(1.0, noted.left, [PUSHED, items[-1]])

    def without(case, fit, effects, values):
        return made_fits.fit(12.0, 15.0, effects)

    monkeypatch.setattr(behind, "accounts_behind", accounts)
    monkeypatch.setattr(behind, "refit", without)
    monkeypatch.setattr(behind, "fitting_forms", lambda case, effects, word: [word, f"{word}.soft"])
    return noted


@pytest.mark.parametrize(
    ("fitted", "unseen", "left", "exchanged"),
    [(1.2, 17.0, 1.1, True), (1.2, 17.0, 16.0, False), (1.2, 1.1, 1.0, False), (6.0, 17.0, 1.1, False)],
    ids=["confirmed behind", "not confirmed", "confirmed as it is", "little of what is fitted"],
)
def test_what_unseen_records_do_not_confirm_is_tried_behind_other_forms(fitted, unseen, left, exchanged, tried):
    """RMSE in noise floors: the coupling leaves 12 and 15, a slew limit beside it little of the former."""
    first, now = made_fits.fit(30.0, 30.0), made_fits.fit(12.0, 15.0, [COUPLED])
    fits, tried.left = [made_fits.fit(9.0, 9.0, ["creep"]), made_fits.fit(fitted, unseen, [COUPLED, LIMIT])], left
    steps = exchange_behind(made_fits.CASE, first, now, fits)
    told = [(PUSHED, COUPLED), (LIMIT, None)]
    assert [(step.added, step.removed) for step in steps] == (told if exchanged else [])
    assert tried.items in ([], [LIMIT])


@pytest.mark.parametrize(("fitted", "unseen", "exchanged"), [(1.6, 4.6, True), (4.0, 4.6, False), (1.0, 1.9, False)])
def test_where_a_model_predicts_far_less_than_it_fits_its_last_effect_is_tried_behind_other_forms(
    fitted, unseen, exchanged, tried
):
    first, now = made_fits.fit(30.0, 30.0), made_fits.fit(fitted, unseen, [COUPLED, LIMIT])
    steps = exchange_behind(made_fits.CASE, first, now, [])
    told = [(None, LIMIT), (PUSHED, COUPLED), (f"{LIMIT}.soft", None)]
    assert [(step.added, step.removed) for step in steps] == (told if exchanged else [])


@pytest.mark.parametrize(
    ("taken", "items"), [("amplifier_lag", ["sensor_lag.second_order", "sensor_lag"]), ("sensor_lag", [])]
)
def test_what_took_the_place_of_an_effect_is_not_added_beside_itself(taken, items):
    case = stage.case()
    fit = SimpleNamespace(effects=(taken,))
    assert possible_beside(case, fit, ["sensor_lag.second_order", "sensor_lag"]) == items
    pairs = [*accounts_behind(case, first_fit(case, 0, effects=("delay",)), "delay", ["sensor_lag"])]
    assert all([*map(word_of, both.effects)].count("sensor_lag") == 1 for _, both in pairs) and pairs
