"""What becomes of the signals: slices, decimation, several axes, records that differ."""

import hashlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pzt_ident.data.readers import read_records
from pzt_ident.data.readers.decimate import decimated
from pzt_ident.data.record import Axis, Channel, Level, Source

SAMPLES = 400


@pytest.fixture
def path(tmp_path):
    """400 samples of 10 ms from 3 s on: u counts the rows, x their squares."""
    n = np.arange(SAMPLES)
    table = np.stack([3 + 0.01 * n, n, n**2], axis=1)
    np.savetxt(tmp_path / "loop.txt", table, fmt="%.6f", header="t [s] u [V] x [um]")
    return tmp_path / "loop.txt"


def test_rows_time_and_start(path, read):
    record = read(path, rows=(100, 300))
    assert (record.drive[0, 0], record.drive[0, -1], record.samples) == (100, 299, 200)
    assert record.start == pytest.approx(4)
    record = read(path, time=(3.5, 4.0))
    assert (record.drive[0, 0], record.drive[0, -1]) == (50, 99)
    assert record.start == pytest.approx(3.5)
    record = read(path, rows=(100, None), time=(4.5, None), settle=0.25)
    assert (record.drive[0, 0], record.samples, record.settle) == (150, 250, 25)


@pytest.mark.parametrize(
    ("settle", "decimate", "samples"),
    [
        (0.0, 4, 0),
        (0.29, 1, 29),
        (0.244, 1, 24),
        (0.246, 1, 25),
        (0.25, 4, 6),
        (0.27, 4, 7),
        (0.4, 10, 4),
        (1.0, 3, 33),
    ],
)
def test_settle_is_the_nearest_number_of_the_samples_that_are_left(path, read, settle, decimate, samples):
    """Of 10 ms each in the file, after the cut to rows, whatever the clock reads."""
    for rows in (None, (100, 300)):
        record = read(path, rows=rows, settle=settle, decimate=decimate)
        assert record.settle == samples
        assert record.dt == pytest.approx(0.01 * decimate)


def test_settle_leaves_at_least_one_decimated_sample(path, read, problem):
    """400 samples of 10 ms, decimated by 4: 99.25 samples round to 99 of 100, 99.75 leave nothing."""
    record = read(path, settle=3.97, decimate=4)
    assert (record.settle, record.samples) == (99, 100)
    assert "settle 3.99 s leaves nothing of 4 s" in problem(path, settle=3.99, decimate=4).message


@pytest.mark.parametrize(("settle", "first"), [(0.0, 0), (0.5, 50), (1.5, 150), (2.0, None)])
def test_only_scored_samples_that_are_fitted_validate_nothing(path, settle, first):
    axes = {"x": Axis(Channel("u"), Channel("x"))}
    sources = [Source("loop.txt", name="fit", rows=(0, 200)), Source("loop.txt", "validate", settle=settle)]
    notes = read_records(sources, axes, Channel("t"), path.parent)[1].notes
    assert [note.split(" are ")[0] for note in notes] == [f"rows {first} to 200"] * (first is not None)


def test_what_a_record_carries(path, read):
    record = read(path, use="validate", run_in=2)
    assert (record.name, record.use, record.file, record.run_in) == ("loop", "validate", "loop.txt", 2)
    assert record.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert record.notes == ("the drive is run 2 times ahead of the first sample",)
    assert read(path, name="slow").name == "slow"


@pytest.mark.parametrize(("level", "volts"), [(Level(2.0), 2.0), (Level(-0.1, "kV"), -100.0), (None, None)])
def test_the_drive_of_rest_is_ahead_of_the_record(path, read, level, volts):
    record = read(path, rows=(100, 300), rest_at=level and {"x": level})
    assert record.rest_at == ((volts,) if level else ())
    assert record.samples == 200 and record.drive[0, 0] == 100
    assert [f"at {volts:g} V on x" in note for note in record.notes] == ([True] if level else [])
    assert record.levels == [volts if level else 100] and record.ahead == bool(level)


def test_the_drive_of_rest_has_the_unit_of_a_drive(path, problem):
    fault = problem(path, rest_at={"x": Level(2.0, "um")})
    assert "rest_at: 2 um cannot be a drive in V" in fault.message


def test_records_of_one_file_are_numbered_and_rates_may_differ(path):
    axes = {"x": Axis(Channel("u"), Channel("x"))}
    sources = [Source("loop.txt"), Source("loop.txt", decimate=4), Source("loop.txt", name="other")]
    records = read_records(sources, axes, Channel("t"), path.parent)
    assert [record.name for record in records] == ["loop_1", "loop_2", "other"]
    assert [record.dt for record in records] == pytest.approx([0.01, 0.04, 0.01])
    assert records[1].samples == 100
    assert "corners of the drive" in records[1].notes[0]


def test_a_number_that_is_a_name_already_is_left_out(path):
    axes = {"x": Axis(Channel("u"), Channel("x"))}
    sources = [Source("loop.txt"), Source("loop.txt", name="loop_1"), Source("loop.txt")]
    records = read_records(sources, axes, Channel("t"), path.parent)
    assert [record.name for record in records] == ["loop_2", "loop_1", "loop_3"]


def test_samples_that_are_fitted_validate_nothing(path):
    axes = {"x": Axis(Channel("u"), Channel("x")), "y": Axis(Channel("u"))}
    taken = {"all": {}, "end": {"rows": (200, 400)}, "middle": {"time": (4.0, 5.5)}, "coarse": {"decimate": 2}}
    sources = [Source("loop.txt", name="fit", rows=(0, 200))]
    sources += [Source("loop.txt", "validate", name, **more) for name, more in taken.items()]
    notes = {record.name: record.notes for record in read_records(sources, axes, Channel("t"), path.parent)}
    note = "rows {} to 200 are fitted in 'fit', so they validate nothing"
    assert (notes["fit"], notes["end"]) == ((), ())
    assert notes["all"] == (note.format(0),)
    assert notes["middle"] == (note.format(100),)
    assert not any("fitted" in note for note in notes["coarse"])


def test_axes_that_are_driven_but_not_measured(path):
    axes = {"x": Axis(Channel("u"), Channel("x")), "y": Axis(Channel("u"))}
    (record,) = read_records([Source("loop.txt")], axes, Channel("t"), path.parent)
    assert record.measured == (0,)
    assert (record.drive.shape, record.response.shape) == ((2, SAMPLES), (2, SAMPLES))
    assert np.isnan(record.response[1]).all()
    assert record.response_units == ("um", None)


def test_a_record_says_what_is_different_in_it(tmp_path):
    rng = np.random.default_rng(3)
    arrays = {name: rng.normal(size=(20, 2)) for name in ("u_1", "y_1", "u_2", "y_2", "z")}
    for name, values in arrays.items():
        np.save(tmp_path / f"{name}.npy", values)
    axes = {axis: Axis(Channel(column=k, unit="V"), Channel(column=k, unit="m")) for k, axis in enumerate("xy", 1)}
    sources = [
        Source("u_1.npy", sample_rate=10, channels={"response": Channel(file="y_1.npy")}),
        Source(
            "u_2.npy",
            sample_rate=10,
            channels={"response": Channel(file="y_2.npy"), "y.response": Channel(file="z.npy", column=1, unit="um")},
        ),
    ]
    first, second = read_records(sources, axes, None, tmp_path)
    np.testing.assert_array_equal(first.drive.T, arrays["u_1"])
    np.testing.assert_array_equal(first.response.T, arrays["y_1"])
    np.testing.assert_array_equal(second.response[0], arrays["y_2"][:, 0])
    np.testing.assert_array_equal(second.response[1], 1e-6 * arrays["z"][:, 0])
    files = [(tmp_path / name).read_bytes() for name in ("u_1.npy", "y_1.npy")]
    assert first.sha256 == hashlib.sha256(b"".join(files)).hexdigest()
    assert first.response_units == second.response_units == ("m", "m")


@given(st.floats(-1e3, 1e3), st.floats(-1, 1), st.integers(2, 12), st.integers(50, 300))
def test_decimation_keeps_offset_and_slope_to_the_ends(offset, slope, step, samples):
    line = offset + slope * np.arange(samples)
    np.testing.assert_allclose(decimated(line, step), line[::step], atol=1e-9 * (1 + np.abs(line).max()))


@pytest.mark.parametrize("step", [2, 3, 5, 10])
def test_decimation_passes_below_the_new_nyquist_and_stops_above(step):
    n = np.arange(200 * step)
    middle = slice(60, 140)
    for frequency in (0.1, 0.5, 0.75):
        tone = np.sin(np.pi * frequency * n / step + 0.3)
        np.testing.assert_allclose(decimated(tone, step)[middle], tone[::step][middle], atol=2e-3)
    for frequency in (1.02, 1.3, 1.9):
        assert np.abs(decimated(np.sin(np.pi * frequency * n / step + 0.3), step)[middle]).max() < 2e-3


@pytest.mark.parametrize("step", [2, 4, 8])
def test_decimation_of_a_period_is_that_of_many(step):
    """To the ends: tones of whole periods below the new Nyquist frequency come back as they are."""
    n = np.arange(512)
    tones = sum(np.sin(2 * np.pi * k * n / 512 + k) for k in (1, 5, 256 * 7 // (10 * step)))
    wrapped, folded = (np.abs(decimated(tones, step, each) - tones[::step]).max() for each in (True, False))
    assert wrapped < 1e-3 < folded


def test_decimation_does_not_bias_a_noisy_record_at_its_ends():
    rng = np.random.default_rng(5)
    ends = [decimated(7 + 0.1 * rng.normal(size=200), 8)[[0, -1]] for _ in range(300)]
    np.testing.assert_allclose(np.mean(ends, axis=0), 7, atol=4 * 0.1 / np.sqrt(300))


def test_decimation_rounds_a_corner_and_keeps_its_place():
    ramp = np.abs(np.arange(-100, 101) / 1.0)
    low = decimated(ramp, 10)
    assert low.argmin() == 10
    assert 0.5 < low[10] < 5
    np.testing.assert_allclose(low, low[::-1], atol=1e-9)
