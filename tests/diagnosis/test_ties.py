"""When two fits are one on these data: by hand, the noise floor being 1."""

import numpy as np
import pytest

from made_fits import CASE, fit
from pzt_ident.diagnosis.ties import generalises, is_tied, is_twin, nearness_of


@pytest.mark.parametrize(("total", "apart", "close"), [(2.0, 0.39, True), (2.0, 0.41, False)])
def test_look_alikes_are_a_tie_where_they_are_twice_as_far_apart(total, apart, close):
    best, rival = (
        fit(total, total, ["amplifier_lag"]),
        fit(np.hypot(total, apart), np.hypot(total, apart), ["sensor_lag"]),
    )
    assert is_tied(CASE, "amplifier_lag", best, rival) == close
    stranger = fit(rival.identify, rival.validate, ["saturation"])
    assert not is_tied(CASE, "amplifier_lag", best, stranger)


@pytest.mark.parametrize(("share", "close"), [(1.009, True), (1.011, False)])
def test_far_above_the_noise_look_alikes_are_a_tie_to_one_percent(share, close):
    best, rival = fit(50.0, 50.0, ["amplifier_lag"]), fit(50.0 * share, 50.0 * share, ["sensor_lag"])
    assert is_tied(CASE, "amplifier_lag", best, rival) == close


@pytest.mark.parametrize(
    ("best", "rival", "close"),
    [
        ((1.1, 2.8), (1.15, 3.0), True),  # both are off where neither was fitted
        ((1.1, 2.8), (1.15, 4.5), False),  # one far more than the other
        ((1.1, 1.05), (1.15, 1.5), False),  # one is at the noise there
        ((1.1, 2.8), (1.3, 3.0), False),  # one fits worse
        ((1.1, None), (1.5, None), False),
    ],
)
def test_what_tells_look_alikes_apart_by_less_than_both_are_off_tells_nothing(best, rival, close):
    fits = fit(*best, ["cubic_stiffness"]), fit(*rival, ["saturation"])
    assert is_tied(CASE, "cubic_stiffness", *fits) == close


@pytest.mark.parametrize(
    ("apart", "word", "twin"),
    [(9e-4, "kinematic_coupling", True), (1.1e-3, "kinematic_coupling", False), (0.0, "creep", False)],
)
def test_what_fits_as_another_form_of_an_effect_does_is_not_told_from_it(apart, word, twin):
    """A coupling by the other axis' voltage fits better than by its force, which is that of its displacement."""
    force, rival = fit(3.0, 3.0, ["cross_coupling"]), fit(3.0 + apart, 3.0 + apart, [word])
    assert is_twin(CASE, "cross_coupling.voltage", [force], rival) == twin


@pytest.mark.parametrize(("word", "twin"), [("amplifier_lag", False), ("sensor_lag", True)])
def test_a_form_that_contains_a_look_alike_does_not_tie_another_form_with_it(word, twin):
    """A limit that is never reached leaves its lag: of an amplifier, which says nothing of a limit that is."""
    in_its_limit, rival = fit(8.0, 8.0, ["slew_limit.lag"]), fit(8.0, 8.0, [word])
    assert is_twin(CASE, "slew_limit.soft", [in_its_limit], rival) == twin


def test_a_form_of_more_parameters_than_the_best_effect_may_contain_it():
    lag = fit(1.0, effects=["amplifier_lag"], dimensions=5)
    assert generalises(fit(1.0, effects=["slew_limit.lag"], dimensions=6), lag)
    assert generalises(
        fit(1.0, effects=["slew_limit.lag"], dimensions=6), fit(1.0, effects=["sensor_lag"], dimensions=5)
    )
    assert not generalises(fit(1.0, effects=["slew_limit"], dimensions=6), lag)
    assert not generalises(fit(1.0, effects=["sensor_lag.second_order"], dimensions=5), lag)
    assert not generalises(fit(1.0, effects=["sensor_lag.second_order"], dimensions=6), lag)
    assert generalises(fit(1.0, effects=["sensor_lag.third_order"], dimensions=7), lag)


def test_of_two_names_of_one_equation_that_nearer_to_the_reading_counts_unless_it_is_that_of_the_other():
    """A coupling of what the sensor reads and one of forces are one model where no mechanics are between them; by the
    voltage, without hysteresis, it is one of voltages."""
    assert nearness_of("kinematic_coupling") > nearness_of("cross_coupling")
    assert nearness_of("kinematic_coupling.voltage") == nearness_of("cross_coupling.voltage")
