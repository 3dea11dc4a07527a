"""The inverse is held against the model: what it drives the stage with, the stage follows."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from contracts.test_blocks import CHAINS, made
from lin_lin import COUPLED_Y
from pzt_ident.control import inverse
from pzt_ident.control.inverse import Inverse
from pzt_ident.control.limits import Limits
from pzt_ident.control.stage import ACTUATION, MECHANICS
from pzt_ident.errors import InputError
from pzt_ident.model.block import Term
from pzt_ident.model.registry import blocks
from rig import block_of, model, path, record, stage_of


def left_to_passes(word):
    """Whether a term in the mechanics is not inverted, only made up for as far as passes over the model go."""
    effect = blocks[word.partition(":")[0]]
    return issubclass(effect, Term) and not effect.solvable


INVERTED = [
    words for words in CHAINS if "bouc_wen_oscillator" not in words and not any(map(left_to_passes, words.split()))
]


def swept(samples, top=40.0):
    """From rest to rest with reversals between."""
    t = np.arange(samples) / samples
    return top * np.sin(np.pi * t) ** 4 * (1 + np.sin(14 * np.pi * t))


def dynamic(words):
    """Whether a chain is not inverted sample by sample alone."""
    listed = [block_of(word) for word in words.split()]
    return any(getattr(block, "place", None) in ACTUATION | MECHANICS or not block.solvable for block in listed)


def errors_of(words, gain, dt=1e-3, samples=200, some=2):
    """Errors over the span of the displacement, of some candidates of eight that the inverse does not call wrong."""
    chain, measured, thetas = made(words, swept(samples), count=8, dt=dt)
    errors = []
    for theta in thetas:
        stage = stage_of(chain, measured, theta)
        displacement = stage.respond(measured.drive)
        if not np.isfinite(displacement).all():
            continue
        found = Inverse(stage, 100.0, gain=gain)(displacement)
        if not found.wrong.any():
            errors.append(np.abs(found.error).max() / np.ptp(displacement))
        if len(errors) == some:
            break
    return errors


@pytest.mark.parametrize("words", [words for words in INVERTED if not dynamic(words)])
def test_stage_without_dynamics_follows_to_rounding(words):
    """Dry friction that jumps with the speed has no inverse; where the stage is slower than that, it has one."""
    errors = errors_of(words, 10.0) or errors_of(words, 10.0, dt=10.0)
    assert errors and max(errors) < 1e-9


@pytest.mark.parametrize("words", [words for words in INVERTED if dynamic(words)])
def test_stage_with_dynamics_follows_as_far_as_the_noise_gain_allows(words):
    loose, tight = (np.median(errors_of(words, gain, 1e-2, 600, 3)) for gain in (10.0, 1e4))
    assert loose < 1e-3 and tight < 1e-6


def stage(values, words, drive, dt=1e-4, **more):
    chain = model(*words, **more)
    theta = [values[name] for name in chain.names]
    return stage_of(chain, record(*drive, dt=dt), theta)


BOUC_WEN = {"bouc_wen.gain": 0.08, "bouc_wen.alpha": 0.5, "bouc_wen.beta": 0.02, "bouc_wen.gamma": 0.01}
SPRING = {"lumped.mass": 0.15, "lumped.damping": 66.0, "lumped.stiffness": 7e7, "lumped.cubic": 0.02}


def test_first_step_of_bouc_wen_is_the_root_of_its_closed_form():
    target = np.array([[0.0, 1.0]])
    found = Inverse(stage(BOUC_WEN, ["bouc_wen"], [[0.0, 100.0]]), 100.0)(target)

    def displacement(u):
        return 0.08 * (u - 0.5 * -np.expm1(-0.03 * u) / 0.03)

    assert np.isclose(found.drive[0, 1], brentq(lambda u: displacement(u) - 1.0, 0, 100, xtol=1e-12), rtol=1e-12)


def test_where_no_pass_helps_steps_get_no_smoother_than_a_part_of_the_reference(monkeypatch):
    """Twice as wide each time, they had taken all memory."""
    first, widths = [], []
    monkeypatch.setattr(inverse, "PASSES", 64)

    def left(self, found):
        first.append(found)
        return 1.0 if found is first[0] else 2.0

    monkeypatch.setattr(Inverse, "left", left)
    monkeypatch.setattr(Inverse, "step", lambda self, found, width: widths.append(width) or 0.0 * found.reference)
    Inverse(stage(BOUC_WEN, ["bouc_wen"], [np.zeros(200)]), 100.0)(swept(200, 1.0)[None])
    assert widths[:3] == [0, 1, 2]
    assert max(widths) <= inverse.WIDEST * 200 < 2 * max(widths)


def plays(u, widths):
    """p <- max(u - r, min(u + r, p)) of each half-width r: (widths, samples)."""
    p, moved = np.zeros(len(widths)), []
    for each in u:
        p = np.maximum(each - widths, np.minimum(each + widths, p))
        moved.append(p)
    return np.transpose(moved)


@given(
    gain=st.floats(0.05, 2),
    weights=st.lists(st.floats(-0.005, 0.5), min_size=8, max_size=8),
    levels=st.lists(st.floats(-80, 80), min_size=2, max_size=8),
)
@settings(deadline=None, max_examples=25, derandomize=True)
def test_plays_are_inverted_as_by_the_closed_form(gain, weights, levels):
    """Kuhnen (2003), Eur. J. Control 9, 407: w0' = 1 / w0, w_i' = -w_i / (W_i W_(i-1)) with W_i = w0 + w_1 + ... + w_i,
    r_i' = w0 r_i + sum_j<i w_j (r_i - r_j)."""
    weights, widths = np.array(weights), 40.0 * np.arange(1, 9) / 8
    sums = gain + np.concatenate([[0.0], np.cumsum(weights)])
    bent = np.array([gain * r + weights[:i] @ (r - widths[:i]) for i, r in enumerate(widths)])
    values = {f"prandtl_ishlinskii.weight_{i + 1}": weight for i, weight in enumerate(weights)}
    values |= {"prandtl_ishlinskii.gain": gain, "prandtl_ishlinskii.reach": 40.0}
    drive = path(0, *levels, points=12)
    made_up = stage(values, ["prandtl_ishlinskii"], [drive])
    displacement = gain * drive + weights @ plays(drive, widths)
    closed = displacement / gain - (weights / (sums[1:] * sums[:-1])) @ plays(displacement, bent)
    found = Inverse(made_up, 100.0)(displacement[None])
    assert np.allclose(found.drive[0], closed, atol=1e-9)


@pytest.mark.parametrize("late", [0.01, 0.05, 0.1])
def test_a_delay_of_many_samples_is_seen_ahead(late):
    late_stage = stage(BOUC_WEN | {"delay.time": late}, ["delay", "bouc_wen"], [[0.0, 100.0]])
    assert Inverse(late_stage, 10.0).actuation.ahead == pytest.approx(late / 1e-4, abs=1)


def test_stiffening_spring_is_bent_further():
    drive = swept(600)
    made_up = stage(BOUC_WEN | SPRING, ["bouc_wen", "lumped", "cubic_stiffness"], [drive])
    displacement = made_up.respond(drive[None])
    assert np.abs(Inverse(made_up, 100.0)(displacement).error).max() < 1e-9 * np.ptp(displacement)


def test_friction_of_the_mass_is_made_up_for_by_passes():
    values = BOUC_WEN | SPRING | {"lumped.friction": 0.05, "lumped.reach": 0.1, "lumped.stiction": 0.0}
    values |= {"lumped.stribeck": 1.0}
    made_up = stage(values, ["bouc_wen", "lumped", "friction.motion"], [swept(600)], dt=1e-3)
    displacement = made_up.respond(swept(600)[None])
    once = Inverse(made_up, 100.0).once(displacement, displacement)
    found = Inverse(made_up, 100.0)(displacement)
    assert np.abs(found.error).max() < 1e-3 * np.abs(once.error).max()


def test_model_that_moves_the_wrong_way_is_told():
    """Lin & Lin (2012), table 7, axis y: alpha 2 beta / (beta + gamma) > 1."""
    there_and_back = 8 * np.concatenate([np.linspace(0, 1, 200), np.linspace(1, 0, 200)[1:]])[None]
    found = Inverse(stage(COUPLED_Y, ["bouc_wen"], there_and_back, dt=1e-3), 90.0)(there_and_back)
    assert np.flatnonzero(found.wrong[0])[0] == 200 and found.wrong.sum() < 20


def test_axes_are_decoupled_or_each_is_inverted_by_itself():
    values = {f"{axis}.{name}": value for axis in "xy" for name, value in BOUC_WEN.items()}
    values |= {"x.cross_coupling.ratio": -0.05, "y.cross_coupling.ratio": 0.03}
    drive = swept(600)
    coupled = stage(values, ["bouc_wen", "cross_coupling"], [drive, drive[::-1]])
    reference = coupled.respond(np.array([drive, drive[::-1]]))
    assert np.abs(Inverse(coupled, 100.0)(reference).error).max() < 1e-12 * np.ptp(reference)
    alone = Inverse(coupled, 100.0, decoupled=False)(reference)
    left = np.array([-0.05 * alone.reference[1], 0.03 * alone.reference[0]])
    assert np.allclose(alone.error, left, atol=1e-12 * np.ptp(reference))


def test_two_axes_with_three_effects_follow_to_rounding():
    effects = {"creep.ratio": 0.1, "creep.tau": 1.0, "creep.decades": 3.0, "quadratic_gain.curvature": 5e-4}
    own = BOUC_WEN | SPRING | effects | {"cross_coupling.ratio": 0.05}
    words = ["bouc_wen", "lumped", "creep", "quadratic_gain", "cross_coupling"]
    values = {f"{axis}.{name}": value for axis in "xy" for name, value in own.items()}
    drives = np.array([swept(600), swept(600)[::-1]])
    made_up = stage(values, words, drives, dt=1e-3)
    reference = made_up.respond(drives)
    assert np.abs(Inverse(made_up, 100.0)(reference).error).max() < 1e-9 * np.ptp(reference)


def test_an_axis_that_is_not_measured_has_its_drive_given():
    values = BOUC_WEN | {"cross_coupling.ratio": 0.4, "amplifier_lag.tau": 1e-3}
    drives = np.array([swept(600), swept(600)[::-1]])
    words = ["amplifier_lag", "bouc_wen", "cross_coupling"]
    coupled = stage(values, words, drives, axes=2, measured=[0])
    reference = np.array([coupled.respond(drives)[0], drives[1]])
    found = Inverse(coupled, 100.0, gain=1e4)(reference)
    assert np.array_equal(found.drive[1], drives[1])
    assert np.abs(found.error[0]).max() < 1e-6 * np.ptp(reference[0])


def test_limits_are_kept_and_what_is_asked_beyond_them_is_told():
    made_up = stage(BOUC_WEN, ["bouc_wen"], [swept(600)])
    reference = made_up.respond(2 * swept(600)[None])
    limits = Limits(np.array([[-20.0, 60.0]]), np.array([3e3]))
    found = Inverse(made_up, 100.0, limits)(reference)
    assert found.drive.max() <= 60 and np.abs(np.diff(found.drive)).max() <= 0.3 * (1 + 1e-12)
    assert np.allclose(found.asked, 2 * swept(600)) and found.limited.any()
    inside = ~found.limited[0]
    assert np.allclose(found.drive[0, inside], found.asked[0, inside])


def test_model_stepped_finer_than_its_samples_is_refused():
    chain, measured, theta = made("bouc_wen_oscillator", swept(100), count=1)
    with pytest.raises(InputError, match="bouc_wen_oscillator: has no inverse"):
        Inverse(stage_of(chain, measured, theta), 100.0)
