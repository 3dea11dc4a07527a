"""The simulated loop is the recursion of its controller around the stage, and goes unstable where its poles say."""

import numpy as np
import pytest

from lin_lin import X, Y
from pzt_ident.control.limits import Limits
from pzt_ident.control.loop import PI, closed_loop
from pzt_ident.control.stage import EVERYTHING
from rig import model, record, stage_of

DT, STEPS = 1e-3, 8
GAINS = PI(np.array([0.8e6]), np.array([480e6]))  # 0.8 V/um, 480 V/(um s)


def stage(values, words="bouc_wen lumped", dt=DT / STEPS):
    chain = model(*words.split())
    theta = [values[name] * (1e-6 if name.endswith("gain") else 1) for name in chain.names]
    return stage_of(chain, record([0.0, 130.0], dt=dt), theta)


def damped(axis, damping=66.0):
    return axis | {"lumped.damping": damping}


def triangle(samples=400, top=1e-6):
    return top * np.interp(np.arange(samples), [0, samples / 2, samples], [0, 1, 0])[None]


@pytest.mark.parametrize("delay", [0, 1, 3])
def test_loop_is_its_recursion_sample_by_sample(delay):
    made, reference, ahead = stage(damped(X)), triangle(60), 12e6 * triangle(60)
    found = closed_loop(made, reference, GAINS, ahead, substeps=STEPS, delay=delay, quantum=1e-8)
    part, integral, output = made.part(EVERYTHING), 0.0, ahead[0, :delay].tolist()
    reading = part.respond(ahead[:, :1])[0, 0]
    for i in range(60):
        counted = 1e-8 * round(reading / 1e-8)
        error = reference[0, i] - counted
        integral += 480e6 * DT * error
        output.append(ahead[0, min(i + delay, 59)] + 0.8e6 * error + integral)
        assert found.reading[0, i] == pytest.approx(counted, abs=1e-18)
        assert found.drive[0, i] == pytest.approx(output[i], abs=1e-9)
        reading = part.respond(np.full((1, STEPS), output[i]))[0, -1]


def test_displacement_is_what_the_sensor_reads_but_for_its_counts():
    found = closed_loop(stage(damped(X)), triangle(), GAINS, substeps=STEPS, quantum=1e-7)
    assert np.abs(found.displacement - found.reading).max() <= 0.5e-7 * (1 + 1e-9)
    assert np.allclose(found.reading / 1e-7, np.round(found.reading / 1e-7))


@pytest.mark.parametrize(("axis", "least"), [(X, 22.4), (Y, 13.6)])
def test_without_computing_delay_the_published_gains_need_damping(axis, least):
    """Exact poles: b > 22.4 N s/m (X) and 13.6 (Y); here the drive takes a hundredth of a sample to jump."""

    def grows(damping, delay):
        linear = damped(axis, damping) | {"bouc_wen.alpha": 0.0}
        reference = np.full((1, 1500), 1e-6)
        reference[0, 0] = 0.0
        found = closed_loop(stage(linear, dt=DT / 100), reference, GAINS, substeps=100, delay=delay)
        return np.abs(found.error[0, 1200:]).max() > np.abs(found.error[0, 200:500]).max()

    assert grows(0.9 * least, 0) and not grows(1.1 * least, 0)
    assert not grows(0.1, 1)


def test_error_dies_out_with_the_time_constant_of_slow_integral_action():
    """(1 + d Kp) / (d Ki) = 27 ms."""
    linear = damped(X) | {"bouc_wen.alpha": 0.0}
    reference = np.full((1, 1500), 1e-6)
    reference[0, 0] = 0.0
    error = closed_loop(stage(linear, dt=1e-4 / STEPS), reference, GAINS, substeps=STEPS).error[0, 500:]
    slope = np.polyfit(np.arange(1000) * 1e-4, np.log(-error), 1)[0]
    assert -1 / slope == pytest.approx((1 + 0.0819 * 0.8) / (0.0819 * 480), rel=0.01)


def test_drive_keeps_its_limits_and_comes_off_them_at_once():
    reference = triangle(400, 3e-6)
    limits = Limits(np.array([[-5.0, 20.0]]), np.array([400.0]))
    found = closed_loop(stage(damped(X)), reference, GAINS, substeps=STEPS, limits=limits)
    assert found.drive.max() == 20 and found.drive.min() >= -5
    assert np.abs(np.diff(found.drive)).max() <= 0.4 * (1 + 1e-12)
    held = np.flatnonzero(found.drive[0] == 20)
    free = closed_loop(stage(damped(X)), reference, GAINS, substeps=STEPS)
    reached = np.flatnonzero((reference[0] < found.displacement[0, held[0]]) & (np.arange(400) > 200))[0]
    assert held[-1] <= reached + 10  # without anti-windup 60 samples and more
    assert free.drive.max() > 25


def test_gains_of_zero_are_the_open_loop():
    made, drive = stage(damped(X)), 12e6 * triangle()
    off = PI(np.zeros(1), np.zeros(1))
    found = closed_loop(made, triangle(), off, drive, substeps=STEPS)
    assert np.array_equal(found.drive, drive)
    assert np.abs(found.error).max() == found.peak[0]
    assert found.rmse[0] == pytest.approx(np.sqrt(np.mean(found.error**2)))


def test_spectrum_has_a_sine_at_its_frequency_with_its_root_mean_square():
    reference = 1e-6 * np.sin(2 * np.pi * 50 * np.arange(1000) * DT)[None]
    off = PI(np.zeros(1), np.zeros(1))
    frequencies, size = closed_loop(stage(damped(X)), reference, off, substeps=STEPS).spectrum
    assert frequencies[size[0].argmax()] == pytest.approx(50)
    assert size[0].max() == pytest.approx(1e-6 / np.sqrt(2))


def test_axis_without_a_sensor_gets_its_feedforward_alone():
    chain = model("bouc_wen", "lumped", axes=2, measured=[0])
    values = {f"{axis}.{name}": value for axis in "xy" for name, value in damped(X).items()}
    theta = [values.get(name, damped(X).get(name)) * (1e-6 if name.endswith("gain") else 1) for name in chain.names]
    made = stage_of(chain, record([0.0, 130.0], [0.0, 90.0], dt=DT / STEPS, measured=[0]), theta)
    ahead = np.vstack([0 * triangle(), 5e6 * triangle()])
    both = PI(np.full(2, 0.8e6), np.full(2, 480e6))
    found = closed_loop(made, np.vstack([triangle(), triangle()]), both, ahead, substeps=STEPS)
    assert np.array_equal(found.drive[1], ahead[1])
    assert np.abs(found.drive[0]).max() > 1
