"""The virtual stage against the closed numbers of Lin & Lin's models, and the committed files against the stage."""

import math
from pathlib import Path

import numpy as np
import pytest

from experiments.rigs import xy_stage as rig

ROOT = Path(__file__).parents[2]
RINGING = 0.012  # um, the most that the corners of a drive leave


def triangles(stage, *amplitudes):
    """Three 1 Hz cycles in um, quasi-static, 1 kHz."""
    time = np.arange(3001) / 1000
    return 1e6 * rig.quasi_static(stage, time, [rig.triangle(a, 1, 3) for a in amplitudes])


@pytest.mark.parametrize(
    ("axis", "volts", "peak", "width", "residual"),
    [(rig.X_PSO, 130, 9.999, 1.247, 0.654), (rig.Y_PSO, 90, 9.437, 1.030, 0.522)],
)
def test_standalone_axis_has_the_published_loop(axis, volts, peak, width, residual):
    (x,) = triangles(rig.Stage((axis,)), volts)
    up, down = x[2000:2501], x[2500:][::-1]
    assert [x.max(), (down - up).max(), x[-1]] == pytest.approx([peak, width, residual], abs=5e-4)


def test_coupling_pulls_x_down_and_y_up():
    x, y = triangles(rig.coupled(), 130, 90)
    assert [x.max(), y.max()] == pytest.approx([9.55, 10.26], abs=5e-3)
    assert triangles(rig.coupled(k12=+3.23e6), 130, 90)[0].max() > 10


def test_open_loop_errors_of_case_3():
    stage, time = rig.coupled(), np.arange(2501) / 1000
    x = 1e6 * rig.quasi_static(stage, time, [rig.triangle(1e-5 / axis.gain, 0.5, 1) for axis in stage.axes])
    error = x - 10 * np.interp(time, [0, 1, 2], [0, 1, 0])
    # The reference was sampled and held at 1 kHz, which adds up to 0.01 um of ringing.
    assert np.column_stack([error.min(1), error.max(1)]) == pytest.approx(
        np.array([[-1.10, 0.64], [-0.28, 0.77]]), abs=0.012
    )


def test_minor_loops_drift_as_bouc_wen_does():
    time, levels = tuple(map(float, range(8))), (0.0, 130.0, 60.0, 80.0, 60.0, 80.0, 60.0, 80.0)
    stage = rig.Stage((rig.X_PSO,))
    longer = rig.Drive((*time, 8.0, 9.0), (*levels, 60.0, 80.0))
    (x,) = 1e9 * rig.quasi_static(stage, np.arange(10.0), [longer])
    assert np.diff(x[3::2]) == pytest.approx([-227, -76, -31], abs=1)


def test_rate_does_not_matter_without_inertia():
    stage, samples = rig.Stage((rig.X_PSO,)), np.arange(201)
    slow, fast = (rig.quasi_static(stage, samples / 100 / f, [rig.triangle(130, f, 2)]) for f in (1, 50))
    assert fast == pytest.approx(slow, abs=1e-14)


def test_corner_leaves_ringing_of_the_velocity_over_omega():
    """An undamped axis started by a ramp: x - f = -f'(0) sin(omega t) / omega while f'' is small."""
    axis, time = rig.X_PSO, np.arange(0, 0.02, 1 / 50e3)
    stage, drive = rig.Stage((axis,)), [rig.triangle(130, 1, 1)]
    ringing = (rig.simulate(stage, time, drive) - rig.quasi_static(stage, time, drive))[0]
    omega = math.sqrt(axis.stiffness / axis.mass)
    speed = 260 * axis.gain * (1 - axis.alpha)
    assert ringing == pytest.approx(-speed / omega * np.sin(omega * time), abs=0.01 * speed / omega)


def test_damped_coupled_stage_settles_on_the_balance_of_forces():
    axes = tuple(
        rig.Axis(a.mass, 0.2 * math.sqrt(a.mass * a.stiffness), *list(vars(a).values())[2:]) for a in rig.coupled().axes
    )
    stage = rig.Stage(axes, -3.23e6, 4.15e6)
    time, drives = np.linspace(0, 0.02, 21), [rig.hold(40, 0.003), rig.hold(30, 0.004)]
    assert rig.simulate(stage, time, drives)[:, -1] == pytest.approx(
        rig.quasi_static(stage, time, drives)[:, -1], abs=1e-12
    )


def test_encoder_rounds_to_counts_with_the_error_of_a_uniform_distribution():
    x = np.linspace(0, 10e-6, 100_001)
    read = rig.encoder(x)
    assert np.allclose(read / 0.1e-6, np.round(read / 0.1e-6), atol=1e-9)
    assert np.sqrt(np.mean((read - x) ** 2)) == pytest.approx(28.87e-9, abs=0.02e-9)


def test_encoder_noise_is_a_function_of_its_seed():
    x = np.zeros(20_000)
    noisy = rig.encoder(x, count=1e-12, noise=5e-9, seed=3)
    assert noisy.std() == pytest.approx(5e-9, rel=0.02)
    assert np.array_equal(noisy, rig.encoder(x, count=1e-12, noise=5e-9, seed=3))
    assert not np.array_equal(noisy, rig.encoder(x, count=1e-12, noise=5e-9, seed=4))


@pytest.mark.parametrize("recording", rig.recordings(), ids=lambda recording: Path(recording.path).stem)
def test_committed_file_is_what_the_stage_makes(recording):
    header, rows = recording.table(samples=20)
    file = ROOT / recording.path
    assert file.stat().st_size < 300_000
    with file.open(encoding="utf-8") as stream:
        assert stream.readline().strip().split(",") == header
        committed = np.loadtxt(stream, delimiter=",")
    assert committed.shape == (recording.samples, len(header))
    assert committed[:20] == pytest.approx(rows, abs=1e-9)


@pytest.mark.parametrize("recording", rig.recordings(), ids=lambda recording: Path(recording.path).stem)
def test_whole_committed_file_is_within_half_a_count_of_the_slow_limit(recording):
    rows = np.loadtxt(ROOT / recording.path, delimiter=",", skiprows=1)
    time, drive, response = np.split(rows.T, [1, 1 + len(recording.drives)])
    intended = np.array([drive(time[0]) for drive in recording.drives])
    assert np.abs(drive - intended).max() < 1e-11
    error = response - 1e6 * rig.quasi_static(recording.stage, time[0], recording.drives)
    assert np.abs(error).max() < 0.05 + RINGING
    assert np.sqrt(np.mean(error**2)) == pytest.approx(0.0289, abs=0.001)
