"""The plant is held against the matrix exponential, its loop against the numbers of Lin & Lin's stage, and the gains
against closed forms."""

import control
import numpy as np
import pytest
from scipy.linalg import expm, solve_continuous_lyapunov

from lin_lin import X, Y
from pzt_ident.control.continuous import error_dynamics, lyapunov_rate, routh_damping
from pzt_ident.control.plant import Plant, plant_of
from pzt_ident.control.tuning import Loop, tune
from pzt_ident.errors import InputError
from rig import model, record, stage_of

DT, STEPS = 1e-3, 256
KP, KI = 0.8e6, 480e6  # V/m, V/(m s)


def plant(values, words="bouc_wen lumped", dt=DT):
    chain = model(*words.split())
    theta = [values[name] * (1e-6 if name.endswith("gain") else 1) for name in chain.names]
    stage = stage_of(chain, record([0.0, 130.0], dt=dt / STEPS), theta)
    return plant_of(stage, 0, (0.0, 130.0), STEPS)


def axis_with(axis, damping, **more):
    return axis | {"lumped.damping": damping} | more


def held(axis, damping):
    """Exact response to a held pulse of one."""
    mass, stiffness = axis["lumped.mass"], axis["lumped.stiffness"]
    whole = np.array([[0, 1, 0], [-stiffness / mass, -damping / mass, stiffness / mass], [0, 0, 0]])
    step = expm(whole * DT)
    states = [np.linalg.matrix_power(step[:2, :2], i) @ step[:2, 2] for i in range(300)]
    return np.array(states)[:, 0], np.linalg.eigvals(step[:2, :2])


@pytest.mark.parametrize("damping", [0.0, 66.0, 2000.0])
def test_plant_of_a_lumped_stage_is_the_matrix_exponential(damping):
    found = plant(axis_with(X, damping))
    pulse, poles = held(X, damping)
    assert np.allclose(np.sort(found.dynamics.poles()), np.sort(poles), atol=1e-7)
    assert np.allclose(control.impulse_response(found.dynamics, np.arange(301) * DT).outputs[1:] * DT, pulse, atol=1e-8)
    assert found.gain == pytest.approx(81.947e-9, rel=1e-4)  # d, the slope where h is saturated


@pytest.mark.parametrize(("time", "samples"), [(2.0e-3, 2), (0.5e-3, 0), (1.25e-3, 1)])
def test_dead_time_and_lag_are_poles_of_their_own(time, samples):
    values = axis_with(X, 66.0) | {"delay.time": time, "sensor_lag.tau": 5e-4}
    found = plant(values, "delay bouc_wen lumped sensor_lag").dynamics
    assert np.abs(found.poles() - np.exp(-2)).min() < 1e-6
    assert found.dcgain() == pytest.approx(1.0, abs=1e-8)
    response = control.impulse_response(found, np.arange(samples + 3) * DT).outputs * DT
    assert np.abs(response[: samples + 1]).max() < 1e-9 and response[samples + 1] > 0.01


@pytest.mark.parametrize(("axis", "least"), [(X, 22.4), (Y, 13.6)])
def test_published_gains_need_damping_unless_the_answer_is_late(axis, least):
    """Physics: resonances at 3.4 and 5.6 kHz, sampled at 1 kHz."""

    def radius(damping, delay):
        return Loop(plant(axis_with(axis, damping)), delay, KP, KI).radius

    assert radius(least - 0.1, 0) > 1 > radius(least + 0.1, 0)
    assert radius(0.1, 1) < 0.98


def test_undamped_axis_is_stable_with_a_sample_of_delay():
    assert Loop(plant(axis_with(X, 0.0)), 1, KP, KI).radius == pytest.approx(0.974, abs=1e-3)


def test_routh_limits_of_the_published_axes():
    limits = [routh_damping(a["lumped.mass"], a["bouc_wen.gain"], 0.8, 480.0) for a in (X, Y)]
    assert limits == pytest.approx([5.78, 3.08], abs=0.005)
    for axis, limit in zip((X, Y), limits, strict=True):
        mass, stiffness, gain = axis["lumped.mass"], axis["lumped.stiffness"], axis["bouc_wen.gain"]
        reals = [
            np.linalg.eigvals(error_dynamics(mass, share * limit, stiffness, gain, 0.8, 480.0)).real.max()
            for share in (0.99, 1.01)
        ]
        assert reals[0] > 0 > reals[1]


def test_lyapunov_bound_holds_nothing():
    """Damped by 1 %: mu of 1e-9 /s, where the loop has a time constant of 27 ms. Undamped there is none."""
    a = error_dynamics(0.1566, 66.0, 7.0028e7, 8.1947e-2, 0.8, 480.0)
    assert lyapunov_rate(a) == pytest.approx(1.18e-9, rel=0.01)
    assert -1 / np.linalg.eigvals(a).real.max() == pytest.approx(27e-3, rel=0.01)
    assert np.isnan(lyapunov_rate(error_dynamics(0.1566, 0.0, 7.0028e7, 8.1947e-2, 0.8, 480.0)))


def test_lyapunov_rate_of_a_well_conditioned_loop():
    a = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-2.0, -3.0, -4.0]])
    p = solve_continuous_lyapunov(a.T, -np.eye(3))
    assert lyapunov_rate(a) == pytest.approx(1 / np.linalg.eigvalsh(p).max(), rel=1e-9)


def one_sample(gain=2.0, dt=DT):
    """y(i + 1) = gain u(i)."""
    return Plant(control.ss([[0.0]], [[1.0]], [[1.0]], [[0.0]], dt), gain)


@pytest.mark.parametrize("delay", [0, 1, 2])
def test_margins_of_an_integrator_with_dead_time(delay):
    """L = k z^-n / (z - 1), n = delay: its phase is -90 degrees - (n + 1/2) w, its size k / (2 sin(w / 2))."""
    k = 0.1
    loop = Loop(one_sample(), delay, 0.0, k / (2.0 * DT))
    turned = np.pi / (2 * delay + 1)
    crossed = 2 * np.arcsin(k / 2)
    assert loop.margins.gain == pytest.approx(2 * np.sin(turned / 2) / k, rel=1e-4)
    assert loop.margins.phase == pytest.approx(90 - np.degrees((delay + 0.5) * crossed), abs=1e-3)
    if delay == 0:  # 1 / (1 + L) = (z - 1) / (z - 1 + k), largest at z = -1
        assert loop.margins.sensitivity == pytest.approx(2 / (2 - k), rel=1e-6)
    assert len(loop.poles) == 2 + delay


def test_pole_of_an_integrator_is_at_one_less_its_gain():
    loop = Loop(one_sample(), 0, 0.0, 0.3 / (2.0 * DT))
    assert np.sort(loop.poles.real) == pytest.approx([0.0, 0.7], abs=1e-12)
    assert loop.bandwidth == pytest.approx(pole_bandwidth(0.7), rel=0.01)


def pole_bandwidth(pole):
    """Of (1 - p) / (z - p): 1 + p^2 - 2 p cos w = 2 (1 - p)^2."""
    return np.arccos((1 + pole**2 - 2 * (1 - pole) ** 2) / (2 * pole)) / (2 * np.pi * DT)


def test_gains_keep_their_margins_and_no_larger_integral_gain_does():
    axis = plant(axis_with(X, 66.0))
    for delay, gain, phase in ((0, 2.0, 60.0), (1, 2.0, 60.0), (2, 3.0, 70.0)):
        found = tune(axis, delay, gain, phase)
        kept = found.margins
        assert found.radius < 1 and kept.gain > 0.999 * gain and kept.phase > phase - 0.1
        assert min(kept.gain / gain, kept.phase / phase) < 1.02
        for kp in found.kp + np.linspace(0, 2e6, 3):
            more = Loop(axis, delay, kp, 1.02 * found.ki)
            assert more.radius > 1 or more.margins.gain < gain or more.margins.phase < phase


def test_gain_of_a_plant_only_scales_the_gains():
    small, large = (tune(one_sample(gain), 1, 2.0, 60.0) for gain in (1.0, -4.0))
    assert (large.kp, large.ki) == pytest.approx((small.kp / -4, small.ki / -4))


def test_undamped_resonance_leaves_no_margin():
    with pytest.raises(InputError, match="no PI gains keep a gain margin of 2 and a phase margin of 60 degrees"):
        tune(plant(axis_with(X, 0.0)), 0, 2.0, 60.0)
    with pytest.raises(InputError, match="give the resonance its damping"):
        tune(plant(axis_with(X, 0.0)), 1, 2.0, 60.0)
