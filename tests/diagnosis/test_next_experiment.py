"""The drive that tells rivals apart: what sets them apart the most, within what the rig may do."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import stage
from pzt_ident.diagnosis.next_experiment import Reach, propose, protocols, respond
from pzt_ident.diagnosis.refit import first_fit, refit

LINEAR = {"bouc_wen.alpha": 0.0, "bouc_wen.beta": 0.01, "bouc_wen.gamma": 0.0}
REACH = Reach(0.0, 100.0, 1e5, 60.0)


@pytest.fixture(scope="module")
def made():
    return stage.case(stage.EFFECTS["sensor_lag"] | LINEAR, LINEAR)


@pytest.fixture(scope="module")
def rivals(made):
    first = first_fit(made, 0)
    return {word: refit(made, first, (word,), {f"{word}.{name}": 3e-3}) for word, name in LAGS}


LAGS = (("sensor_lag", "tau"), ("delay", "time"))


def within(drive, reach, dt):
    small = 1e-6 * (reach.high - reach.low)
    return (
        drive.min() >= reach.low - small
        and drive.max() <= reach.high + small
        and np.abs(np.diff(drive)).max() / dt <= 1.001 * reach.rate
        and drive.size * dt <= reach.duration + dt
    )


@settings(max_examples=40, deadline=None)
@given(
    st.floats(-200, 100),
    st.floats(1, 300),
    st.floats(1, 1e6),
    st.floats(0.5, 100),
    st.integers(1, 2),
    st.integers(0, 1),
)
def test_every_drive_stays_within_what_the_rig_may_do(low, span, rate, duration, axes, axis):
    reach = Reach(low, low + span, rate, duration)
    for name, why, dt, drive in protocols([reach] * axes, min(axis, axes - 1)):
        assert name and why
        assert drive.shape[0] == axes
        assert np.isfinite(drive).all()
        for row in drive:
            assert within(row, reach, dt), name


@pytest.mark.parametrize(("duration", "seen"), [(60.0, True), (4.0, True), (0.2, False)])
def test_two_rates_are_two_or_none(duration, seen):
    found = [drive[0] for name, _, _, drive in protocols([Reach(0.0, 100.0, 1e3, duration)], 0) if name == "two rates"]
    assert bool(found) == seen
    for drive in found:
        speed = np.abs(np.diff(drive))[1:-1]
        assert speed.max() > 2.9 * np.median(speed[: speed.size // 3])
        assert drive[0] == pytest.approx(drive[-1], abs=1)


def test_an_axis_that_never_moved_is_not_moved():
    drives = {name: drive for name, _, _, drive in protocols([REACH, Reach(5.0, 5.0, 0.0, 60.0)], 0)}
    assert drives
    assert all(np.all(drive[1] == 5) for drive in drives.values())


def test_a_rig_that_may_do_much_is_offered_every_protocol():
    names = [name for name, *_ in protocols([REACH] * 2, 0)]
    assert len(names) == 8
    assert {"steps and holds", "small chirp", "the other axis alone"} <= set(names)


def test_holds_last_as_long_whatever_the_ramps_take():
    for rate in (1e5, 5.0):
        drive, dt = next(
            (drive[0], dt) for name, _, dt, drive in protocols([Reach(0.0, 100.0, rate, 200.0)], 0) if "holds" in name
        )
        level = np.isclose(drive, 60)
        assert level.sum() * dt == pytest.approx(20, abs=0.1)


def test_the_other_axis_moves_alone():
    other = [drive for name, _, _, drive in protocols([REACH] * 2, 0) if "other axis" in name]
    assert all(np.ptp(drive[0]) == 0 < np.ptp(drive[1]) for drive in other)


def test_the_proposal_sets_the_rivals_furthest_apart(made, rivals):
    found = propose(made, rivals, [REACH])
    assert found.splits == ("sensor_lag", "delay")
    assert found.apart > 3
    for _, _, dt, drive in protocols([REACH], 0):
        one, two = (respond(made, fit, dt, drive) for fit in rivals.values())
        assert np.sqrt(np.mean((one - two) ** 2)) / made.floor <= found.apart * (1 + 1e-9)


def test_where_two_stay_alike_the_others_are_told_apart(made, rivals):
    found, same = propose(made, rivals, [REACH]), propose(made, rivals | {"again": rivals["delay"]}, [REACH])
    assert same.apart == pytest.approx(0, abs=1e-9)
    one, two = (respond(made, fit, same.dt, same.drive) for fit in rivals.values())
    assert np.sqrt(np.mean((one - two) ** 2)) > 3 * made.floor
    assert found.apart > 3


def test_what_no_drive_tells_apart_is_asked_of_none(made, rivals):
    assert propose(made, {"delay": rivals["delay"], "again": rivals["delay"]}, [REACH]) is None


def test_a_rig_that_may_do_nothing_is_asked_nothing(made, rivals):
    assert propose(made, rivals, [Reach(0.0, 100.0, 1e3, 1e-3)]) is None


def test_a_response_is_about_its_mean(made, rivals):
    _, _, dt, drive = next(iter(protocols([REACH], 0)))
    response = respond(made, rivals["delay"], dt, drive)
    assert response.shape == drive.shape[1:]
    assert response.mean() == pytest.approx(0, abs=1e-15)
