"""The drive that tells rivals apart: what sets them apart the most, within what the rig may do."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rig
import stage
from pzt_ident.diagnosis import next_experiment
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.next_experiment import DriveLimits, chirp, propose, protocols, respond
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.starts import first_fit

LINEAR = {"bouc_wen.alpha": 0.0, "bouc_wen.beta": 0.01, "bouc_wen.gamma": 0.0}
LIMITS = DriveLimits(0.0, 100.0, 1e5, 60.0)


@pytest.fixture(scope="module")
def case():
    return stage.case(stage.EFFECTS["sensor_lag"] | LINEAR, LINEAR)


@pytest.fixture(scope="module")
def rivals(case):
    first = first_fit(case, 0)
    return {word: refit(case, first, (word,), {f"{word}.{name}": 3e-3}) for word, name in LAGS}


LAGS = (("sensor_lag", "tau"), ("delay", "time"))


def within(drive, limits, dt):
    small = 1e-6 * (limits.high - limits.low)
    return (
        drive.min() >= limits.low - small
        and drive.max() <= limits.high + small
        and np.abs(np.diff(drive)).max() / dt <= 1.001 * limits.rate
        and drive.size * dt <= limits.duration + dt
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
    limits = DriveLimits(low, low + span, rate, duration)
    for name, dt, drive in protocols([limits] * axes, min(axis, axes - 1)):
        assert name
        assert drive.shape[0] == axes
        assert np.isfinite(drive).all()
        for row in drive:
            assert within(row, limits, dt), name


@pytest.mark.parametrize(("duration", "seen"), [(60.0, True), (4.0, True), (0.2, False)])
def test_two_rates_are_two_or_none(duration, seen):
    drives = [
        drive[0] for name, _, drive in protocols([DriveLimits(0.0, 100.0, 1e3, duration)], 0) if name == "two rates"
    ]
    assert bool(drives) == seen
    for drive in drives:
        speed = np.abs(np.diff(drive))[1:-1]
        assert speed.max() > 2.9 * np.median(speed[: speed.size // 3])
        assert drive[0] == pytest.approx(drive[-1], abs=1)


def test_an_axis_that_never_moved_is_not_moved():
    drives = {name: drive for name, _, drive in protocols([LIMITS, DriveLimits(5.0, 5.0, 0.0, 60.0)], 0)}
    assert drives
    assert all(np.all(drive[1] == 5) for drive in drives.values())


def test_a_rig_that_may_do_much_is_offered_every_protocol():
    names = [name for name, *_ in protocols([LIMITS] * 2, 0)]
    assert len(names) == 8
    assert {"steps and holds", "small chirp", "the other axis alone"} <= set(names)


def test_holds_last_as_long_whatever_the_ramps_take():
    for rate in (1e5, 5.0):
        drive, dt = next(
            (drive[0], dt)
            for name, dt, drive in protocols([DriveLimits(0.0, 100.0, rate, 200.0)], 0)
            if "holds" in name
        )
        level = np.isclose(drive, 60)
        assert level.sum() * dt == pytest.approx(20, abs=0.1)


def test_a_chirp_sweeps_its_band_and_no_more():
    """(f1 - f0) T / ln(f1 / f0) cycles in all, 3 % of the range high."""
    drive = chirp(DriveLimits(0.0, 100.0, 1e9, 60.0), (20.0, 2000.0), 2.0, 5e-5)[-40_000:] - 50
    crossings = np.flatnonzero(np.diff(np.sign(drive)))
    assert crossings.size / 2 == pytest.approx(1980 * 2 / np.log(100), abs=1)
    assert (crossings < 2000).sum() / 2 == pytest.approx(20 * (100**0.05 - 1) * 2 / np.log(100), abs=0.6)
    assert np.abs(drive).max() == pytest.approx(3, rel=1e-3)


def test_the_other_axis_moves_alone():
    other = [drive for name, _, drive in protocols([LIMITS] * 2, 0) if "other axis" in name]
    assert all(np.ptp(drive[0]) == 0 < np.ptp(drive[1]) for drive in other)


def test_the_proposal_sets_the_rivals_furthest_apart(case, rivals):
    proposal = propose(case, rivals, [LIMITS])
    assert proposal.splits == ("sensor_lag", "delay")
    assert proposal.separation > 3
    for _, dt, drive in protocols([LIMITS], 0):
        one, two = (respond(case, fit, dt, drive) for fit in rivals.values())
        assert np.sqrt(np.mean((one - two) ** 2)) / case.floor <= proposal.separation * (1 + 1e-9)


def test_where_two_stay_alike_the_others_are_told_apart(case, rivals):
    proposal, same = propose(case, rivals, [LIMITS]), propose(case, rivals | {"again": rivals["delay"]}, [LIMITS])
    assert same.separation == pytest.approx(0, abs=1e-9)
    one, two = (respond(case, fit, same.dt, same.drive) for fit in rivals.values())
    assert np.sqrt(np.mean((one - two) ** 2)) > 3 * case.floor
    assert proposal.separation > 3


def test_what_no_drive_tells_apart_is_asked_of_none(case, rivals):
    assert propose(case, {"delay": rivals["delay"], "again": rivals["delay"]}, [LIMITS]) is None


def test_a_rig_that_may_do_nothing_is_asked_nothing(case, rivals):
    assert propose(case, rivals, [DriveLimits(0.0, 100.0, 1e3, 1e-3)]) is None


def test_a_response_is_about_its_mean(case, rivals):
    _, dt, drive = next(iter(protocols([LIMITS], 0)))
    response = respond(case, rivals["delay"], dt, drive)
    assert response.shape == drive.shape[1:]
    assert response.mean() == pytest.approx(0, abs=1e-15)


@pytest.fixture
def proposed(monkeypatch):
    """The proposal among drives of which each sets three rivals at these places, in noise floors of 2: the distances of
    one and two, one and three, two and three are the differences."""
    wave = np.resize([1.0, -1.0], 100)

    def of(**places):
        case = SimpleNamespace(records=[rig.record(wave)], floor=2.0)
        drives = [(name, 1e-3, np.array([number]) * np.ones((1, 100))) for number, name in enumerate(places)]
        monkeypatch.setattr(next_experiment, "protocols", lambda limits, axis: drives)

        def respond(case, fit, dt, drive):
            return 2.0 * list(places.values())[int(drive[0, 0])][fit] * wave

        monkeypatch.setattr(next_experiment, "respond", respond)
        rivals = {word: place for place, word in enumerate(("one", "two", "three"))}
        return propose(case, rivals, [LIMITS])

    return of


def test_what_the_closest_two_are_apart_is_what_a_drive_is_worth(proposed):
    """3.5, 3.5 and 7 against 3, 4 and 7, and against 3, 40 and 43, which would win without the cap."""
    proposal = proposed(far=(0, 3, 43), even=(0, 3.5, 7), near=(0, 3, 7))
    assert proposal.name == "even"
    assert proposal.separation == pytest.approx(3.5)
    assert proposal.splits == ("one", "two", "three")


def test_telling_all_apart_a_little_is_more_than_telling_one_of_them_by_far(proposed):
    """2 + 2 + 3 of three at most each, against 0 + 3 + 3."""
    assert proposed(one=(0, 0, 50), all=(0, 2, 4)).name == "all"


def test_the_sum_goes_before_the_closest_two(proposed):
    """1 + 3 + 3 against 1.5 + 1.5 + 3: each pair counts up to three."""
    proposal = proposed(even=(0, 1.5, 3), most=(0, 1, 4))
    assert (proposal.name, proposal.separation) == ("most", pytest.approx(1))


@pytest.mark.parametrize(("place", "separated"), [(0.29, False), (0.31, True)])
def test_three_tenths_of_the_noise_are_told_apart(proposed, place, separated):
    assert (proposed(only=(0, place, place / 2)) is not None) == separated


def test_pairs_that_are_not_told_apart_count_nothing(proposed):
    """0.29 + 0.29 + 0.58 against 0 + 0.6 + 0.6."""
    assert proposed(little=(0, 0.29, 0.58), two=(0, 0, 0.6)).name == "two"


def test_of_drives_that_are_as_good_the_first_is_taken_and_one_that_fails_is_not(proposed):
    assert proposed(fails=(0, np.inf, 9), first=(0, 4, 8), second=(0, 4, 8)).name == "first"


@pytest.mark.parametrize(
    ("alike", "measured", "first", "axis"),
    [("uvv", 0, [0, 1], 0), ("uvv", 1, [0, 1], 1), ("uvv", 2, [0, 1], 1), ("uuv", 2, [0, 2], 1), ("uvu", 1, [0, 1], 1)],
)
def test_a_drive_has_the_reach_of_its_first_axis_and_the_measured_one_leads(monkeypatch, alike, measured, first, axis):
    drives = dict(zip("uv", np.random.default_rng(0).uniform(0, 1, (2, 50)), strict=True))
    asked = []
    monkeypatch.setattr(next_experiment, "protocols", lambda limits, axis: asked.append((limits, axis)) or [])
    limits = [DriveLimits(0.0, size, 1.0, 1.0) for size in (1.0, 2.0, 3.0)]
    case = SimpleNamespace(records=[rig.record(*(drives[word] for word in alike), measured=[measured])], floor=1.0)
    assert propose(case, {}, limits) is None
    assert asked == [([limits[i] for i in first], axis)]


def test_axes_that_are_driven_alike_move_together_and_others_stay(monkeypatch):
    u, v = np.random.default_rng(0).uniform(0, 1, (2, 50))
    case = SimpleNamespace(records=[rig.record(u, v, u)], floor=1.0)
    moves = np.array([[1.0, 2.0], [3.0, 4.0]])
    monkeypatch.setattr(next_experiment, "protocols", lambda limits, axis: [("it", 1e-3, moves)])
    monkeypatch.setattr(next_experiment, "respond", lambda case, fit, dt, drive: fit * np.ones(2))
    proposal = propose(case, {"one": 0.0, "two": 1.0}, [LIMITS] * 3)
    np.testing.assert_array_equal(proposal.drive, moves[[0, 1, 0]])


STRAIGHT = {f"bouc_wen.{word}": value for word, value in (("alpha", 0.0), ("beta", 0.01), ("gamma", 0.0))}


def test_responses_are_in_units_of_the_loss_of_the_first_measured_axis():
    """y and z are measured, in sizes of 3 and 5: the drive of y counts, whatever the others do."""
    drive = np.array([np.resize([0.0, top], 40) for top in (5.0, 10.0, 20.0)])
    record = rig.record(*drive, measured=[1, 2])
    case = Case(["bouc_wen"], (), [replace(record, response=1e-7 * drive)], stage.specs(STRAIGHT))
    case.error_scales = np.array([3.0, 5.0])
    problem = case.problem(())
    fit = fit_at((), problem, problem.unit_point(dict(zip(problem.names, (1e-7, 3e-7), strict=True))))
    expected = 1e-7 / 3 * (drive[1] - drive[1].mean())
    np.testing.assert_allclose(respond(case, fit, 1e-3, drive), expected, rtol=1e-6)


def test_a_protocol_runs_at_its_own_sample_time():
    """A lag of 20 ms under a step, sampled at 1 ms, which the records with their 5 s would not show."""
    step = np.repeat([0.0, 100.0], 200)
    lag = STRAIGHT | {"amplifier_lag.tau": 20e-3}
    case = Case(["bouc_wen", "amplifier_lag"], (), [rig.record(step, response=[1e-7 * step], dt=5.0)], stage.specs(lag))
    problem = case.problem(())
    response = respond(case, fit_at((), problem, problem.unit_point({"bouc_wen.gain": 1e-7})), 1e-3, step[None])
    after = 1e-3 * (np.arange(200) + 0.5)  # the step is a ramp over a sample
    np.testing.assert_allclose(response[200:] - response[0], 1e-5 * (1 - np.exp(-after / 20e-3)), atol=1e-8)


@pytest.mark.parametrize("rate", [0.5, 5.0, 500.0])
def test_no_drive_is_longer_than_a_diagnosis_can_take(rate):
    sizes = {name: drive.shape[1] for name, _, drive in protocols([DriveLimits(0.0, 100.0, rate, 400.0)] * 2, 0)}
    assert max(sizes.values()) <= 100_000
    assert {"slow triangles", "nested loops", "the other axis alone"} <= set(sizes) or rate < 5
