"""What `signals.nc` says of axes that differ in everything, and what its readers make of it: gains alone, by hand."""

import sys
from dataclasses import replace
from threading import Event, Thread

import numpy as np
import pytest

import rig
from pzt_ident.data.signals import read_signals, read_traces, write_signals
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks
from pzt_ident.run.misfit import misfits
from pzt_ident.search.cube import FixedValue
from pzt_ident.search.problem import Problem

AXES, DRIVES, RESPONSES = ("y", "v", "x"), ("mV", "kV", "V"), ("nm", None, "um")
VOLTS = {"y": 1e-3, "v": 1e3, "x": 1.0}
METRES = {"y": 1e-9, "x": 1e-6}
TRUE, MODEL = {"y": 3e-7, "x": 1e-7}, {"y": 5e-7, "x": 0.9e-7}  # m/V
SETTLE, DT, START = 29, 0.01, 2.5  # 0.29 s / 0.01 s is less than 29 in floating point


def simulated(name, use, seed):
    """Axes in no order of the alphabet; what is driven but not measured stands between the others."""
    drive = np.random.default_rng(seed).uniform(0, 100, (3, 200))
    response = np.array([TRUE.get(axis, np.nan) * drive[i] for i, axis in enumerate(AXES)])
    blank = rig.record(*drive, response=response, dt=DT, settle=SETTLE, start=START)
    return replace(blank, name=name, use=use, axes=AXES, drive_units=DRIVES, response_units=RESPONSES)


RECORDS = [simulated("slow", "validate", 1), simulated("fast", "identify", 2)]
ORDER = [record.name for record in RECORDS]


def residual(record, axis):
    """Model less measurement, m, about its mean over what is scored."""
    drive = record.drive[AXES.index(axis)]
    return (MODEL[axis] - TRUE[axis]) * (drive - drive[SETTLE:].mean())


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    linear = {f"{axis}.bouc_wen.{word}": FixedValue(0.0) for axis in "xy" for word in ("alpha", "gamma")}
    linear |= {f"{axis}.bouc_wen.beta": FixedValue(0.01) for axis in "xy"}
    linear |= {f"{axis}.bouc_wen.gain": FixedValue(MODEL[axis] / METRES[axis] * VOLTS[axis]) for axis in "xy"}
    problem = Problem(Chain([blocks["bouc_wen"]], AXES, (0, 2), given=linear), RECORDS, linear)
    path = tmp_path_factory.mktemp("signals") / "signals.nc"
    write_signals(path, problem.errors(np.zeros(0)))
    return path


@pytest.fixture(scope="module")
def traces(path):
    return {(trace.record, trace.axis): trace for trace in read_traces(path, ORDER)}


@pytest.mark.parametrize("record", RECORDS, ids=ORDER)
@pytest.mark.parametrize("axis", ["x", "y"])
def test_an_axis_is_written_in_its_own_units(traces, record, axis):
    trace, place = traces[record.name, axis], AXES.index(axis)
    left = residual(record, axis) / METRES[axis]
    measured = record.response[place] / METRES[axis]
    assert (trace.use, trace.drive_unit, trace.unit) == (record.use, DRIVES[place], RESPONSES[place])
    np.testing.assert_allclose(trace.time, START + DT * np.arange(200))
    np.testing.assert_allclose(trace.drive, record.drive[place] / VOLTS[axis])
    np.testing.assert_allclose(trace.response, measured)
    np.testing.assert_allclose(trace.residual, left, atol=1e-9 * np.ptp(left))
    np.testing.assert_allclose(trace.model, measured + left, atol=1e-9 * np.ptp(measured))
    assert trace.scored.sum() == 200 - SETTLE


def test_traces_are_those_of_measured_axes_in_the_order_of_the_records(traces):
    assert list(traces) == [("slow", "x"), ("slow", "y"), ("fast", "x"), ("fast", "y")]


def test_records_come_back_in_si_units_each_axis_with_its_residual(path):
    records, residuals = read_signals(path, ORDER)
    assert [(record.name, record.use) for record in records] == [("slow", "validate"), ("fast", "identify")]
    for record, read, was in zip(records, residuals, RECORDS, strict=True):
        assert (sorted(record.axes), record.settle, len(read)) == (sorted(AXES), SETTLE, 2)
        assert (record.dt, record.start) == (pytest.approx(DT), START)
        for place, axis in enumerate(record.axes):
            old = AXES.index(axis)
            assert (record.drive_units[place], record.response_units[place]) == (DRIVES[old], RESPONSES[old])
            np.testing.assert_allclose(record.drive[place], was.drive[old])
            np.testing.assert_allclose(record.response[place], was.response[old])
        for left, place in zip(read, record.measured, strict=True):
            expected = residual(was, record.axes[place])
            np.testing.assert_allclose(left, expected, atol=1e-9 * np.ptp(expected))


def test_the_misfit_of_an_axis_is_that_of_its_own_residual_and_floor(path):
    floors = {"x": 0.01, "y": 20.0}  # um, nm
    result = {"best": {"run": "pso-0"}, "unit": "um", "noise_floor": floors}
    axes = misfits(path.parent, "hand", result, ORDER)["axes"]
    for axis, floor in floors.items():
        scored = np.concatenate([residual(record, axis)[SETTLE:] for record in RECORDS]) / METRES[axis]
        assert axes[axis]["unit"] == RESPONSES[AXES.index(axis)]
        assert (axes[axis]["samples"], axes[axis]["noise_floor"]) == (2 * (200 - SETTLE), pytest.approx(floor))
        assert axes[axis]["rmse"] == pytest.approx(np.sqrt(np.mean(scored**2)))
        assert axes[axis]["misfit"] == pytest.approx(np.sqrt(np.mean(scored**2) - floor**2))


@pytest.fixture
def profiled():
    """A thread that holds the frames of all others for a moment, again and again, as a profiler does."""
    ended = Event()

    def hold():
        held = []
        while not ended.wait(1e-4):
            held.append(sys._current_frames())
            if len(held) == 5:
                held.clear()

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    profiler = Thread(target=hold)
    profiler.start()
    yield
    ended.set()
    profiler.join()
    sys.setswitchinterval(interval)


def test_the_file_is_the_same_to_the_byte_whatever_a_profiler_holds_of_its_writer(tmp_path, profiled):
    pairs = [(record, np.ones((2, record.samples))) for record in RECORDS]
    for name in range(30):
        write_signals(tmp_path / str(name), pairs)
    assert len({path.read_bytes() for path in tmp_path.iterdir()}) == 1
