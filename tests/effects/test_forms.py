"""The forms of effects against closed forms of their own, and against the first form where they contain it."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lsim, lti

from pzt_ident.engine.simulator import simulate
from pzt_ident.model.block import Place, Term
from pzt_ident.model.registry import blocks
from rig import candidates, model, path, record, response

DRIVE = path(0, 80, 10, 60, 0, points=70)
T = np.arange(DRIVE.size) * 1e-3
BOUC_WEN = {"bouc_wen.gain": 0.08, "bouc_wen.alpha": 0.4, "bouc_wen.beta": 0.04, "bouc_wen.gamma": -0.01}


def alone(item, drive=DRIVE, **parameters):
    """Response of one effect to a drive."""
    word = item.partition(".")[0]
    return response([item], {f"{word}.{name}": value for name, value in parameters.items()}, drive)


def behind(item, **parameters):
    """Response of Bouc-Wen with an effect, less that without it."""
    word = item.partition(".")[0]
    named = {f"{word}.{name}": value for name, value in parameters.items()}
    return response(["bouc_wen", item], BOUC_WEN | named, DRIVE) - response(["bouc_wen"], BOUC_WEN, DRIVE)


def filtered(numerator, denominator, signal=DRIVE):
    return lsim(lti(numerator, denominator), signal - signal[0], T)[1] + signal[0]


def test_the_displacement_curves_and_saturates_with_its_hysteresis():
    f = response(["bouc_wen"], BOUC_WEN, DRIVE)
    np.testing.assert_allclose(behind("quadratic_gain.displacement", curvature=0.03), 0.03 * f**2, atol=1e-12)
    np.testing.assert_allclose(behind("saturation.displacement", knee=0.2) + f, 5 * np.tanh(f / 5), atol=1e-12)


def test_the_cubic_is_what_saturation_begins_with():
    found = behind("saturation.cubic", knee=2e-3)
    np.testing.assert_allclose(found, -0.08 * 2e-3**2 * DRIVE**3, atol=1e-12)
    small = 1e-4
    ratio = behind("saturation", knee=small)[70] / behind("saturation.cubic", knee=small)[70]
    assert ratio == pytest.approx(1 / 3, rel=1e-4)


def test_the_running_amplitude_is_the_widest_swing_so_far():
    span = np.maximum.accumulate(DRIVE) - np.minimum.accumulate(DRIVE)
    np.testing.assert_allclose(alone("amplitude_gain.running", growth=1e-3), DRIVE * (1 + 1e-3 * span), atol=1e-12)


def test_rayleigh_loops_have_the_gain_and_the_loss_of_the_law():
    """Plays of all widths up to the peak: the virgin curve is u^2 / 2, a branch from u1 adds (u - u1)^2 / 4."""
    found = alone("amplitude_gain.rayleigh", growth=1.0) - DRIVE
    up, turn = slice(0, 71), 70
    np.testing.assert_allclose(found[up], DRIVE[up] ** 2 / 2, atol=80**2 / 20**2)
    down = slice(70, 141)
    expected = found[turn] - (DRIVE[turn] - DRIVE[down]) ** 2 / 4
    np.testing.assert_allclose(found[down], expected, atol=80**2 / 20**2)


def test_creep_of_the_voltage_leaves_the_hysteresis_alone():
    found = behind("creep.voltage", ratio=0.1, tau=0.05, decades=0.0)
    np.testing.assert_allclose(found, 0.08 * 0.1 * filtered([1], [0.05, 1]), atol=1e-9)


def test_three_elements_creep_each_at_its_own_time():
    ratios, taus = (0.05, 0.02, -0.01), (0.01, 0.03, 0.09)
    named = {f"ratio_{i + 1}": ratio for i, ratio in enumerate(ratios)} | {"fastest": 0.01, "spacing": 3.0}
    expected = sum(ratio * filtered([1], [tau, 1]) for ratio, tau in zip(ratios, taus, strict=True))
    np.testing.assert_allclose(alone("creep.elements", **named), DRIVE + expected, atol=1e-9)
    np.testing.assert_allclose(behind("creep.voltage_elements", **named), 0.08 * expected, atol=1e-9)


@pytest.mark.parametrize("item", ["amplifier_lag.two_poles", "sensor_lag.second_order"])
@pytest.mark.parametrize(
    ("damping", "denominator"),
    [
        (0.5**0.5, [2e-3**2 / 2, 2e-3, 1]),  # Butterworth
        (1.0, np.polymul([1e-3, 1], [1e-3, 1])),
        (1.25, np.polymul([1.6e-3, 1], [0.4e-3, 1])),
    ],
)
def test_lags_of_second_order_lag_by_tau(item, damping, denominator):
    np.testing.assert_allclose(alone(item, tau=2e-3, damping=damping), filtered([1], denominator), atol=1e-8)


@pytest.mark.parametrize(
    ("share", "damping", "denominator"),
    [
        (0.5, 0.5, np.polymul([1e-3, 1], [1e-6, 1e-3, 1])),  # Butterworth
        (0.25, 1.25, np.polymul([0.5e-3, 1], np.polymul([1.2e-3, 1], [0.3e-3, 1]))),
    ],
)
def test_a_filter_of_third_order_lags_by_tau(share, damping, denominator):
    known = {"sensor_lag.tau": 2e-3, "sensor_lag.share": share, "sensor_lag.damping": damping}
    fine = np.interp(np.arange(0, T[-1] + 1e-6, 1e-5), T, DRIVE)
    found = response(["sensor_lag.third_order"], known, fine, dt=1e-5)[::100]
    np.testing.assert_allclose(found, filtered([1], denominator), atol=1e-4)


@pytest.mark.parametrize(
    ("share", "damping", "other"),
    [
        (0.8, 0.7, {"sensor_lag": {}}),
        (0.1, 0.7, {"sensor_lag.second_order": {"damping": 0.7}}),
        (0.43, 2.0, {"sensor_lag.second_order": {"damping": 1.0}}),
    ],
)
def test_a_filter_of_third_order_is_one_of_fewer_poles_where_its_shapes_end(share, damping, other):
    """To a tenth of what it lags: what rests there is a filter nonetheless."""
    found = alone("sensor_lag.third_order", tau=2e-3, share=share, damping=damping)
    ((item, shapes),) = other.items()
    assert np.std(found - alone(item, tau=2e-3, **shapes)) < 0.1 * np.std(found - DRIVE)
    declared = blocks["sensor_lag.third_order"].parameters()
    assert declared["share"].end == "both" and declared["damping"].end == "upper"


def test_a_second_mode_in_series_or_of_the_voltage():
    known = {"share": 0.2, "frequency": 40.0, "damping": 0.05}
    w = 2 * np.pi * 40
    expected = 0.2 * (filtered([1], [1 / w**2, 0.1 / w, 1]) - DRIVE)
    np.testing.assert_allclose(alone("resonance.series", **known) - DRIVE, expected, atol=1e-8)
    np.testing.assert_allclose(behind("resonance.voltage", **known), 0.08 * expected, atol=1e-8)


def test_coupling_by_the_voltage_is_without_hysteresis():
    other = DRIVE[::-1].copy()
    named = {f"{axis}.{name}": value for axis in "xy" for name, value in BOUC_WEN.items()}
    coupled = {f"{axis}.cross_coupling.ratio": 0.1 for axis in "xy"}
    found = response(["bouc_wen", "cross_coupling.voltage"], named | coupled, DRIVE, other)
    without = response(["bouc_wen"], named, DRIVE, other)
    np.testing.assert_allclose(found - without, 0.08 * 0.1 * np.array([other, DRIVE]), atol=1e-12)


def test_a_saturating_lag_is_the_lag_below_the_limit_and_the_limit_above_it():
    lag = alone("amplifier_lag", tau=2e-3)
    np.testing.assert_allclose(alone("slew_limit.lag", slowness=0.0, tau=2e-3), lag, atol=1e-12)
    np.testing.assert_allclose(alone("slew_limit.lag", slowness=1e-5, tau=2e-3), lag, atol=1e-12)
    step = np.append(0.0, np.full(300, 50.0))
    held = {"slew_limit.slowness": 1 / 500, "slew_limit.tau": 2e-3}
    found = response(["slew_limit.lag"], held, step)
    assert np.diff(found).max() == pytest.approx(500 * 1e-3)
    assert found[100] == pytest.approx(50, abs=0.5 + 500 * 2e-3) and found[-1] == pytest.approx(50, abs=1e-9)


def test_a_soft_limit_is_the_lag_of_small_signals_and_the_limit_of_a_short_one():
    lag = alone("amplifier_lag", tau=2e-3)
    for slowness in (0.0, 1e-14, 1e-9):
        np.testing.assert_allclose(alone("slew_limit.soft", slowness=slowness, tau=2e-3), lag, atol=1e-9)
    for tau in (0.0, 1e-9):
        np.testing.assert_allclose(
            alone("slew_limit.soft", slowness=1 / 2000, tau=tau), alone("slew_limit", slowness=1 / 2000), atol=0.02
        )


@pytest.mark.parametrize("slowness", [1 / 5000, 1 / 500, 1 / 5])
def test_behind_a_step_a_soft_limit_has_its_closed_form(slowness):
    """sinh(slowness (U - U_a) / tau) = sinh(slowness (U - U_0) / tau) exp(-t / tau)."""
    held = {"slew_limit.slowness": slowness, "slew_limit.tau": 2e-3}
    left = 50 - response(["slew_limit.soft"], held, np.append(0.0, np.full(300, 50.0)))[1:]
    scaled, fading = slowness * left / 2e-3, np.arange(300) / 2
    expected = (
        np.arcsinh(np.sinh(np.minimum(scaled[0], 700)) * np.exp(-fading)) if scaled[0] < 700 else scaled[0] - fading
    )
    np.testing.assert_allclose(scaled, expected, rtol=1e-9, atol=1e-12)


def test_a_soft_limit_follows_its_equation_with_the_square_of_the_step():
    def slope(t, y):
        return np.tanh((np.interp(t, T, DRIVE) - y) / (1500 * 2e-3)) * 1500

    exact = solve_ivp(slope, (0, T[-1]), DRIVE[:1], t_eval=T, rtol=1e-10, atol=1e-10, max_step=2e-4).y[0]
    errors = []
    for finer in (4, 8):
        fine = np.interp(np.arange((T.size - 1) * finer + 1) / finer, np.arange(T.size), DRIVE)
        held = {"slew_limit.slowness": 1 / 1500, "slew_limit.tau": 2e-3}
        errors.append(np.abs(response(["slew_limit.soft"], held, fine, dt=1e-3 / finer)[::finer] - exact).max())
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.2) and errors[1] < 1e-2


@pytest.mark.parametrize("speed", [1e-3, 50.0])
def test_coulomb_friction_depends_on_the_velocity_alone(speed):
    rate = np.append(0, np.diff(DRIVE)) / 1e-3
    found = alone("friction.coulomb", force=0.5, speed=speed, viscous=0.0)
    np.testing.assert_allclose(found, DRIVE - 0.5 * np.tanh(rate / speed), atol=1e-9)
    lagging = alone("friction.coulomb", force=0.0, speed=speed, viscous=3e-3)
    np.testing.assert_allclose(lagging, alone("amplifier_lag", tau=3e-3), atol=1e-12)
    commanded = alone("friction.commanded_coulomb", force=0.5, speed=speed, viscous=3e-3)
    np.testing.assert_allclose(commanded, lagging - 0.5 * np.tanh(rate / speed), atol=1e-9)


@pytest.mark.parametrize("reach", [0.05, 0.5])
def test_viscous_friction_lags_the_force_that_bends_the_bristles(reach):
    known = {"reach": reach, "stiction": 0.2, "stribeck": 10.0}
    lagged = alone("friction.lugre_viscous", force=0.0, viscous=3e-3, **known)
    np.testing.assert_allclose(lagged, alone("amplifier_lag", tau=3e-3), atol=1e-12)
    free = alone("friction.lugre_viscous", force=0.5, viscous=0.0, **known)
    np.testing.assert_allclose(free, alone("friction", force=0.5, **known), atol=1e-12)
    named = {f"friction.{word}": value for word, value in {"force": 0.5, "viscous": 3e-3, **known}.items()}
    slowed = response(["friction"], {f"friction.{word}": v for word, v in {"force": 0.5, **known}.items()}, lagged)
    np.testing.assert_allclose(response(["friction.lugre_viscous"], named, DRIVE), slowed, atol=1e-12)


@pytest.mark.parametrize(("force", "reach"), [(0.5, 4.0), (3.0, 1.0)])
def test_commanded_friction_builds_up_with_what_is_asked_for(force, reach):
    """F = force (1 - exp(-f / reach)) from rest, and force (2 exp(-a / reach) - 1) and so on a back from there; where
    force is more than reach the stage first goes on the other way."""
    up, back = np.linspace(0, 30, 50), np.linspace(30, 10, 50)[1:]
    found = alone("friction.commanded", np.append(up, back), force=force, reach=reach)
    np.testing.assert_allclose(up - found[:50], force * (1 - np.exp(-up / reach)), atol=1e-12)
    turned = force * ((2 - np.exp(-30 / reach)) * np.exp(-(30 - back) / reach) - 1)
    np.testing.assert_allclose(back - found[50:], turned, atol=1e-12)
    assert (found[50:].max() > found[49]) == (2 * force > reach)


@pytest.mark.parametrize("stiction", [0.0, 0.3])
def test_commanded_friction_with_stiction_and_a_viscous_part(stiction):
    """Of a steady rate v the level is force (1 + stiction exp(-(v / stribeck)^2)); what is viscous lags what is asked
    for, and not the bristles."""
    drive, known = np.linspace(0, 40, 400), {"reach": 0.5, "stribeck": 100.0}
    found = alone("friction.commanded_lugre", drive, force=0.5, stiction=stiction, viscous=0.0, **known)
    level = 0.5 * (1 + stiction * np.exp(-((drive[1] / 1e-3 / 100) ** 2)))  # reach and force are one here
    np.testing.assert_allclose(drive - found, level * (1 - np.exp(-drive / level)), atol=1e-9)
    lagged, plain = alone("amplifier_lag", tau=3e-3), alone("friction.commanded", force=0.5, reach=0.5)
    both = alone("friction.commanded_lugre", force=0.5, stiction=0.0, viscous=3e-3, **known)
    np.testing.assert_allclose(both - lagged, plain - DRIVE, atol=1e-11)


def test_the_second_harmonic_of_the_grating():
    wave = 2 * np.pi / 7
    known = {"sine": 0.1, "cosine": -0.2, "second_sine": 0.03, "second_cosine": 0.04, "pitch": 7.0}
    expected = 0.1 * np.sin(wave * DRIVE) - 0.2 * (np.cos(wave * DRIVE) - 1)
    expected += 0.03 * np.sin(2 * wave * DRIVE) + 0.04 * (np.cos(2 * wave * DRIVE) - 1)
    np.testing.assert_allclose(alone("encoder_cyclic_error.second", **known), DRIVE + expected, atol=1e-11)


@pytest.mark.parametrize("centre", [0.0, 35.0])
def test_plays_are_bent_by_their_knee_about_a_centre_and_straight_without(centre):
    weights = {f"weight_{i + 1}": 0.0 for i in range(10)} | {"weight_5": 0.3, "reach": 40.0, "centre": centre}
    straight = alone("distributed_memory", **{name: weights[name] for name in weights if name != "centre"}) - DRIVE
    unbent = alone("distributed_memory.bent_plays", knee=0.0, **weights) - DRIVE
    np.testing.assert_allclose(unbent, straight, atol=1e-12)
    found = alone("distributed_memory.bent_plays", knee=0.05, **weights) - DRIVE
    bent = np.tanh(0.05 * (straight / 0.3 - centre)) + np.tanh(0.05 * centre)
    np.testing.assert_allclose(found, 0.3 * bent / 0.05, atol=1e-10)


def test_a_loop_that_leans_one_way():
    """Without forgetting dh/du = 1 + lean on the way up and 1 - lean on the way down."""
    known = BOUC_WEN | {"bouc_wen.beta": 0.0, "bouc_wen.gamma": 0.0, "bouc_wen.lean": 0.2}
    drive = path(0, 80, 0, points=7)
    memory = (0.08 * drive - response(["bouc_wen"], known, drive)) / (0.4 * 0.08)
    expected = np.append(1.2 * drive[:8], 1.2 * 80 - 0.8 * (80 - drive[8:]))
    np.testing.assert_allclose(memory, expected, rtol=1e-12, atol=1e-12)


CONTAINED = [
    (item, word) for effect in blocks.effects() for item in blocks.forms(effect) for word in blocks[item].contains
]


@pytest.mark.parametrize(("item", "word"), CONTAINED)
def test_what_contains_a_lag_is_that_lag_at_the_null_of_its_own_size(item, word):
    declared = blocks[item].parameters()
    middle = {name: each.null if each.null is not None else sum(each.bounds) / 2 for name, each in declared.items()}
    (seconds,) = (name for name, each in declared.items() if each.unit == "s")
    np.testing.assert_allclose(alone(item, **middle | {seconds: 2e-3}), alone(word, tau=2e-3), atol=1e-9)


def behind_the_hysteresis():
    """Items of effects with what they act in: nothing, or the equation of motion."""
    for item in (item for word in blocks.effects() for item in blocks.forms(word)):
        if issubclass(blocks[item], Term):
            yield from [[item, "lumped"]] * blocks["lumped"].holds(blocks[item])
        elif Place.OPERATOR < blocks[item].place < Place.OUTPUT:
            yield [item]


@pytest.mark.parametrize("items", [*behind_the_hysteresis()], ids="-".join)
def test_what_depends_on_its_zero_is_about_rest(items):
    """A force that is larger all the time moves the rest alone, unless the effect is nonlinear in the displacement."""
    chain = model(*(blocks[item] for item in items))
    theta = candidates(chain, DRIVE, 10, seed=4)
    less, more = (simulate(chain, record(*[DRIVE + shift] * len(chain.axes)), theta) for shift in (0, 20))
    moved = np.ptp(more - less, axis=2).max(axis=1) / np.abs(less).max(axis=(1, 2))
    assert chain.from_rest == (moved.max() > 1e-9)
