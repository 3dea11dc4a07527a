"""Friction against its closed forms: Dahl's in the displacement, and Stribeck's in the speed of sliding; in the
equation of motion against that equation, integrated."""

import math
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rig import path, response


def rubbed(force, sliding=0.05, reach=0.3, stiction=0.0, stribeck=1.0, dt=1e-3):
    words = {"force": sliding, "reach": reach, "stiction": stiction, "stribeck": stribeck}
    return response(["friction"], {f"friction.{word}": value for word, value in words.items()}, force, dt=dt)


def driving(x, sliding, reach):
    """The force that moves the stage along a path, from rest: x plus Dahl's friction on every monotone step."""
    friction, found = 0.0, [x[0]]
    for before, after in pairwise(x):
        move = after - before
        limit = np.sign(move) * sliding
        friction = limit + (friction - limit) * np.exp(-abs(move) / reach)
        found.append(after + friction)
    return np.array(found)


@pytest.mark.parametrize(("sliding", "reach"), [(0.05, 0.3), (0.1, 1e-3), (1.0, 1e-2), (1e-9, 1.0), (2.0, 0.01)])
def test_displacement_for_the_force_that_makes_it(sliding, reach):
    x = np.concatenate([path(0, 8, 3, 5, -2, 4, points=40), 4 + np.random.default_rng(1).normal(size=300).cumsum()])
    np.testing.assert_allclose(rubbed(driving(x, sliding, reach), sliding, reach), x, rtol=0, atol=1e-12)


@pytest.mark.parametrize(("stribeck", "excess"), [(1e9, 0.4), (1e-9, 0.0)])
def test_a_stiction_that_never_fades_is_more_friction_and_one_that_fades_at_once_is_none(stribeck, excess):
    force = path(0, 3, 1, 2, -1, points=60)
    with_stiction = rubbed(force, sliding=0.05, reach=0.3, stiction=0.4, stribeck=stribeck)
    without = rubbed(force, sliding=0.05 * (1 + excess), reach=0.3 * (1 + excess))
    np.testing.assert_allclose(with_stiction, without, rtol=0, atol=1e-9)


def test_a_long_loop_is_twice_the_sliding_friction_wide():
    force = path(0, 10, 0, 10, points=400)
    x = rubbed(force)
    assert x[800:][200] - x[400:800][200] == pytest.approx(-2 * 0.05, rel=1e-6)


def test_below_the_reach_it_is_a_spring():
    """sliding / reach times the stiffness."""
    small = path(0, 1e-6, -1e-6, 0)
    np.testing.assert_allclose(rubbed(small), small / (1 + 0.05 / 0.3), rtol=1e-5, atol=1e-11)


@given(speed=st.floats(0.01, 100), stiction=st.floats(0, 0.5), stribeck=st.floats(0.1, 10))
def test_sliding_takes_less_force_the_faster_it_is(speed, stiction, stribeck):
    """The Stribeck curve, eq. 5: some reaches on, the stage is behind its force by the level of its speed."""
    force = np.linspace(0, 20, 501)
    behind = force - rubbed(force, stiction=stiction, stribeck=stribeck, dt=force[1] / speed)
    assert behind[-1] == pytest.approx(0.05 * (1 + stiction * np.exp(-((speed / stribeck) ** 2))), rel=1e-9)


def test_breaking_away_overshoots_the_sliding_friction():
    """A stage that speeds up is left behind by what stiction was, within the reach."""
    force = np.concatenate([np.linspace(0, 7, 7001), 7 + np.linspace(0, 10, 101)[1:]])  # 1/s, then 100/s
    behind = force - rubbed(force, stiction=0.2, stribeck=10.0)
    assert behind[7000] == pytest.approx(0.05 * (1 + 0.2 * np.exp(-0.01)), rel=1e-6)
    assert behind[-1] == pytest.approx(0.05, rel=1e-6)
    assert np.all(np.diff(behind[7001:]) <= 1e-15)


MASS, DAMPING, STIFFNESS = 0.16, 60.0, 7e7
STAGE = {"lumped.mass": MASS, "lumped.damping": DAMPING, "lumped.stiffness": STIFFNESS}
LAW = {"lumped.friction": 0.3, "lumped.reach": 0.2, "lumped.stiction": 0.0, "lumped.stribeck": 1.0}


def moved(force, dt, **law):
    return response(["lumped"], STAGE | LAW | {f"lumped.{word}": value for word, value in law.items()}, force, dt=dt)


def integrated(force, dt, friction=0.3, reach=0.2, stiction=0.0, stribeck=1.0, cubic=0.0):
    """m x'' + b x' + k (x + c x^3 + F) = k f,  F' = x' - |x'| F / (reach g / friction), times friction / reach."""

    def change(f, x, v, pull):
        level = friction * (1 + stiction * math.exp(-((v / stribeck) ** 2)))
        push = STIFFNESS * (f - x - cubic * x**3 - pull)
        return v, (push - DAMPING * v) / MASS, (level * v - abs(v) * pull) / (reach * level / friction)

    return stepped(change, (force[0], 0.0, 0.0), force, dt)


def stepped(change, state, force, dt, steps=5):
    """Runge and Kutta's steps of fourth order under a force that is linear between its samples: their own error is a
    fiftieth of what is allowed."""
    h, found = dt / steps, [state[0]]

    def moved_by(share, slope):
        return [value + share * h * each for value, each in zip(state, slope, strict=True)]

    for before, after in pairwise(force.tolist()):
        for k in range(steps):
            f, middle, end = (before + (after - before) * (k + share) / steps for share in (0, 0.5, 1))
            one = change(f, *state)
            two = change(middle, *moved_by(0.5, one))
            three = change(middle, *moved_by(0.5, two))
            four = change(end, *moved_by(1, three))
            slope = [(a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(one, two, three, four, strict=True)]
            state = moved_by(1, slope)
        found.append(state[0])
    return np.array(found)


def errors_under_a_chirp(simulated, truth, *steps):
    """Largest error over the span of the displacement, at each sample time; both of (force, dt)."""
    errors = []
    for dt in steps:
        time = np.arange(0, 0.01, dt)
        force = 2 * np.sin(2 * np.pi * (200 + 6e4 * time) * time)
        expected = truth(force, dt)
        errors.append(np.abs(simulated(force, dt) - expected).max() / np.ptp(expected))
    return errors


@pytest.mark.parametrize("law", [{}, {"cubic": 2e-3}, {"stiction": 0.3, "stribeck": 2e3}, {"reach": 2.0}])
def test_a_chirp_moves_it_as_the_equation_of_motion_says(law):
    """Error of second order in the sample time."""
    errors = errors_under_a_chirp(partial(moved, **law), partial(integrated, **law), 2e-5, 1e-5)
    assert errors[1] < 2e-3
    assert errors[1] < 0.4 * errors[0]


def test_slowly_driven_it_is_friction_ahead_of_the_motion():
    force = path(0, 8, 3, 5, -2, 4, points=400)
    ahead = rubbed(force, sliding=0.3, reach=0.2)
    np.testing.assert_allclose(moved(force, 1.0), ahead, rtol=0, atol=1e-7)
    assert np.ptp(moved(force, 1.0) - force) > 0.5


def test_ringing_wears_off_within_the_reach():
    """Without friction it goes on."""
    step = np.append(np.zeros(2), np.full(2000, 1.0))
    free, rubbing = (moved(step, 1e-5, friction=level, reach=0.01) for level in (0.0, 0.05))
    assert np.ptp(free[1000:]) > 0.1
    assert np.ptp(rubbing[1000:]) < 0.02 * np.ptp(free[1000:])


@pytest.mark.parametrize(("friction", "speed", "cubic"), [(0.3, 2e3, 0.0), (0.3, 2e3, 2e-3), (1.0, 5e3, 0.0)])
def test_a_chirp_moves_it_under_coulomb_friction_as_the_equation_of_motion_says(friction, speed, cubic):
    """Error of second order in the sample time."""
    law = {"friction": friction, "speed": speed, "cubic": cubic}

    def change(f, x, v):
        pull = STIFFNESS * (f - x - cubic * x**3 - friction * math.tanh(v / speed))
        return v, (pull - DAMPING * v) / MASS

    named = STAGE | {f"lumped.{word}": value for word, value in law.items()}
    errors = errors_under_a_chirp(
        lambda force, dt: response(["lumped"], named, force, dt=dt),
        lambda force, dt: stepped(change, (0.0, 0.0), force, dt),
        1e-5,
        5e-6,
    )
    assert errors[1] < 1e-3
    assert errors[1] < 0.35 * errors[0]


@pytest.mark.parametrize("speed", [1e-2, 1.0])
def test_slowly_driven_coulomb_friction_follows_the_speed(speed):
    force = path(0, 8, 3, 5, points=400)
    rate = np.append(0, np.diff(force)) / 1e-2
    found = response(["lumped"], STAGE | {"lumped.friction": 0.3, "lumped.speed": speed}, force, dt=1e-2)
    expected = force - 0.3 * np.tanh(rate / speed)
    assert np.median(np.abs(found - expected)) < 1e-5


SLIP = 0.3


def slipping(force, dt, reach=0.4, spacing=0.5, cubic=0.0):
    law = {"lumped.friction": SLIP, "lumped.reach": reach, "lumped.spacing": spacing, "lumped.cubic": cubic}
    return response(["lumped"], STAGE | law, force, dt=dt)


def stretched(pulls, dx, reach, spacing):
    """The forces of four elements after a step of the displacement."""
    reaches = reach * spacing ** np.arange(3, -1, -1)
    return np.clip(pulls + SLIP / 4 / reaches * dx, -SLIP / 4, SLIP / 4)


def slipped(force, dt, reach=0.4, spacing=0.5, cubic=0.0, steps=16):
    """m x'' + b x' + k (x + c x^3 + F) = k f by many small steps of the midpoint."""
    h, x, v, pulls, found = dt / steps, force[0], 0.0, np.zeros(4), [force[0]]
    for before, after in pairwise(force.tolist()):
        for k in range(steps):
            f, middle = before + (after - before) * (k + 0.5) / steps, x + v * h / 2
            pull = stretched(pulls, v * h / 2, reach, spacing).sum()
            push = h * STIFFNESS * (f - middle - cubic * middle**3 - pull) / MASS
            lost = h * DAMPING / MASS / 2
            new = (v * (1 - lost) + push) / (1 + lost)
            dx = h * (v + new) / 2
            x, v, pulls = x + dx, new, stretched(pulls, dx, reach, spacing)
        found.append(x)
    return np.array(found)


@pytest.mark.parametrize("law", [{}, {"spacing": 1.0}, {"cubic": 2e-3}, {"reach": 4.0, "spacing": 0.2}])
def test_a_chirp_moves_elements_that_slip_as_the_equation_of_motion_says(law):
    errors = errors_under_a_chirp(partial(slipping, **law), partial(slipped, **law), 2e-5, 1e-5)
    assert errors[1] < 3e-3
    assert errors[1] < 0.5 * errors[0]


@pytest.mark.parametrize("spacing", [1.0, 0.5, 0.2])
def test_slowly_driven_elements_are_plays_of_the_displacement(spacing):
    force = path(0, 8, 3, 5, -2, 4, points=400)
    x = slipping(force, 1.0, spacing=spacing)
    pulls, expected = np.zeros(4), [0.0]
    for dx in np.diff(x):
        pulls = stretched(pulls, dx, 0.4, spacing)
        expected.append(pulls.sum())
    np.testing.assert_allclose(force - x, expected, rtol=0, atol=1e-7)
    assert np.ptp(force - x) == pytest.approx(2 * SLIP)


ELASTIC = {"friction": 0.3, "reach": 0.2, "elastic": 0.5, "stiction": 0.0, "stribeck": 1.0, "cubic": 0.0}


def bending(force, dt, **law):
    return response(["lumped"], STAGE | {f"lumped.{word}": x for word, x in (ELASTIC | law).items()}, force, dt=dt)


def slope_of_bristles(pull, way, level, friction, reach, elastic):
    """dF/dx in the direction `way`: that of bristles which only bend, or slide more and more."""
    along = way * pull
    return friction / reach * np.minimum(1, (level - along) / (level * (1 - elastic)))


def bent(force, dt, **law):
    """m x'' + b x' + k (x + c x^3 + F) = k f, integrated."""
    known = ELASTIC | law
    friction, reach, elastic = (known[word] for word in ("friction", "reach", "elastic"))

    def change(f, x, v, pull):
        level = friction * (1 + known["stiction"] * math.exp(-((v / known["stribeck"]) ** 2)))
        push = STIFFNESS * (f - x - known["cubic"] * x**3 - pull)
        way = 1.0 if v >= 0 else -1.0
        return v, (push - DAMPING * v) / MASS, v * float(slope_of_bristles(pull, way, level, friction, reach, elastic))

    return stepped(change, (force[0], 0.0, 0.0), force, dt)


@pytest.mark.parametrize(
    "law", [{}, {"cubic": 2e-3}, {"stiction": 0.3, "stribeck": 2e3}, {"elastic": 0.0}, {"elastic": 0.9, "reach": 1.0}]
)
def test_a_chirp_moves_bristles_that_only_bend_at_first_as_the_equation_of_motion_says(law):
    errors = errors_under_a_chirp(partial(bending, **law), partial(bent, **law), 2e-5, 1e-5)
    assert errors[1] < 3e-3
    assert errors[1] < 0.5 * errors[0]


def test_slowly_driven_bristles_bend_on_a_line_then_slide_exponentially():
    force = path(0, 8, -3, points=400)
    x = bending(force, 1.0)
    pull = force - x
    assert np.ptp(pull) == pytest.approx(0.6, rel=1e-6)
    line = pull[:400] < 0.15
    np.testing.assert_allclose(pull[:400][line], 1.5 * x[:400][line], rtol=0, atol=1e-7)
    beyond = (x[:400] - 0.1)[~line]
    np.testing.assert_allclose(pull[:400][~line], 0.3 - 0.15 * np.exp(-beyond / 0.1), rtol=0, atol=1e-6)
    small = path(0, 0.2, 0.1, 0.2, -0.2, points=50)
    np.testing.assert_allclose(bending(small, 1.0), small / 2.5, rtol=0, atol=1e-7)


def test_a_reversal_within_the_reach_leaves_a_closed_loop():
    x = slipping(path(0, 8, 7.7, 8, 9, points=400), 1.0)
    assert x[1200] == pytest.approx(x[400], abs=1e-7)
    assert np.ptp(x[400:1200]) > 0.01


def test_friction_and_a_bent_spring_are_in_one_equation():
    """Slowly x + c x^3 + F = f, to first order where the friction turns, and without friction the spring alone."""
    force, cubic = path(0, 8, -4, 6, points=400), 2e-3
    x = moved(force, 1.0, cubic=cubic)
    np.testing.assert_allclose(driving(x, 0.3, 0.2) + cubic * x**3, force, rtol=0, atol=2e-4)
    alone = response(["lumped"], STAGE | {"lumped.cubic": cubic}, force, dt=1e-3)
    np.testing.assert_allclose(moved(force, 1e-3, cubic=cubic, friction=0.0), alone, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    "law",
    [
        {"friction": 0.3, "reach": 0.2, "stiction": 0.2, "stribeck": 1.0},
        {"friction": 0.3, "speed": 2.0},
        {"friction": 0.3, "speed": 0.01},
        {"friction": SLIP, "reach": 0.4, "spacing": 0.5},
        {"friction": 0.3, "reach": 0.2, "elastic": 0.5, "stiction": 0.2, "stribeck": 1.0},
    ],
)
def test_friction_alone_is_friction_beside_a_spring_that_does_not_bend(law):
    force, named = path(0, 8, 3, 5, -2, 4, points=200), {f"lumped.{word}": value for word, value in law.items()}
    alone, beside = (response(["lumped"], STAGE | named | bent, force, dt=2e-4) for bent in ({}, {"lumped.cubic": 0.0}))
    np.testing.assert_allclose(alone, beside, rtol=0, atol=1e-12)
    straight = response(["lumped"], STAGE, force, dt=2e-4)
    assert np.abs(alone - straight).max() > 0.1
