"""Residuals of known place: their shares of the misfit have a closed form."""

import json
import tracemalloc
from dataclasses import asdict, replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pzt_ident.data.noise import Floor
from pzt_ident.data.record import Record
from pzt_ident.diagnosis.binning import doubling_binning, linear_binning, logarithmic_binning, power_spectrum
from pzt_ident.diagnosis.locate import locate
from pzt_ident.diagnosis.worst_intervals import heaviest_runs

DT = 1e-3
TIME = DT * np.arange(8000)
TRIANGLE = 100 * np.abs((TIME + 1) % 2 - 1)
OTHER = 40 * np.abs((TIME / 1.6 + 1) % 2 - 1)
FALLING = TIME % 2 >= 1
SILENT = Floor(0.0, "none")


def record(name="loops", use="identify", drive=TRIANGLE, other=None, settle=0):
    drives = np.array([drive] if other is None else [drive, other])
    response = np.full_like(drives, np.nan)
    response[0] = 1e-7 * drive
    axes = ("x", "y")[: len(drives)]
    return Record(
        name,
        use,
        DT,
        drives,
        response,
        settle=settle,
        axes=axes,
        drive_units=("V",) * len(axes),
        response_units=("um", None)[: len(axes)],
    )


def located(residuals, records=None, floor=SILENT):
    """Residuals in um."""
    records = records or [record(name=f"record {i}") for i in range(len(residuals))]
    (axis,) = locate(records, [1e-6 * np.atleast_2d(part) for part in residuals], [floor])
    return axis


def view(axis, name):
    (chosen,) = [one for one in axis.views if one.name == name]
    return chosen


def share(axis, name, *labels):
    return sum(part.share for part in view(axis, name).bins if part.label in labels)


def text(axis):
    return "\n".join(axis.sentences)


def test_all_on_the_falling_branch():
    axis = located([0.3 * FALLING])
    branch = {part.label: part for part in view(axis, "branch").bins}
    assert branch["falling"].share == pytest.approx(1, abs=2e-3)
    assert branch["falling"].samples == pytest.approx(0.5, abs=2e-3)
    assert branch["falling"].rmse == pytest.approx(0.3, rel=2e-3)
    assert (axis.rmse, axis.misfit, axis.unit) == (pytest.approx(0.3 / 2**0.5), pytest.approx(0.3 / 2**0.5), "um")
    assert "100 % of the misfit lies where the drive is falling, which is 50 % of the samples." in axis.sentences


def test_after_reversals():
    axis = located([0.2 * (TIME % 1 < 0.1)])
    chosen = view(axis, "time since reversal").dominant
    assert (chosen.share, chosen.samples) == (pytest.approx(1, abs=0.01), pytest.approx(0.1, abs=2e-3))
    assert "within 0.1 s after a reversal or stop, which is 10 % of the samples." in text(axis)


def test_in_one_record():
    axis = located([0.1 * np.ones(8000), 0.3 * np.ones(8000)])
    assert share(axis, "record", "record 0") == pytest.approx(0.1)
    assert view(axis, "record").dominant.share == pytest.approx(0.9)
    assert axis.sentences[0].startswith("90 % of the misfit lies in record record 1, which is 50 %")


def test_in_holds():
    drive = np.interp(TIME, [0, 1, 3, 4, 5, 6, 7, 8], [0, 100, 100, 0, 100, 0, 100, 0])
    axis = located([1.0 * ((TIME > 1) & (TIME < 3))], [record(drive=drive)])
    assert share(axis, "branch", "holding") == pytest.approx(1, abs=0.01)
    assert share(axis, "rate", "holding") == pytest.approx(1, abs=0.01)
    assert "where the drive is holding" in text(axis)


def test_wherever_the_drive_moves():
    drive = np.interp(TIME, [0, 1, 7, 8], [0, 100, 100, 0])
    axis = located([1.0 * ((TIME < 1) | (TIME > 7))], [record(drive=drive)])
    assert "where the drive is moving, which is 25 % of the samples." in text(axis)


def test_what_follows_from_the_record_is_not_said_of_its_cycles():
    slow = 100 * np.abs((TIME / 4 + 1) % 2 - 1)
    axis = located([0.5 + 0 * TIME, 0 * TIME], [record(), record(drive=slow)])
    assert share(axis, "cycle", "3 to 4") == pytest.approx(0.5, abs=2e-3)
    assert not view(axis, "cycle").dominant
    assert view(axis, "record").dominant.share == 1


def test_in_large_and_fast_half_cycles():
    drive = np.where(TIME < 4, TRIANGLE, 0.2 * TRIANGLE)
    axis = located([0.1 * (TIME < 4)], [record(drive=drive)])
    assert view(axis, "amplitude").dominant.sentence == (
        "100 % of the misfit lies in half cycles of 90 to 110 V peak to peak, which is 50 % of the samples."
    )
    assert share(axis, "rate", "30 to 100 V/s", "100 to 300 V/s") == pytest.approx(1, abs=2e-3)


def test_in_a_band_of_frequency():
    axis = located([0.5 * np.sin(2 * np.pi * 7 * TIME)])
    assert share(axis, "frequency", "3 to 10 Hz") == pytest.approx(1)
    assert view(axis, "frequency").dominant.samples == pytest.approx(7 / 500, rel=0.02)
    assert "at frequencies of 3 to 10 Hz" in text(axis)


LINES = [(3, "odd harmonics"), (4, "even harmonics"), (2.5, "between the harmonics")]


@pytest.mark.parametrize(("order", "kind"), LINES)
def test_in_lines(order, kind):
    axis = located([np.cos(2 * np.pi * order * TIME / 2)])
    assert share(axis, "lines", kind) == pytest.approx(1)


def test_lines_only_where_the_drive_repeats():
    chirp = np.sin(2 * np.pi * (TIME + TIME**2))
    assert not [one for one in located([chirp], [record(drive=chirp)]).views if one.name == "lines"]
    both = located([chirp, chirp], [record(drive=chirp), record()])
    assert view(both, "lines").covers == pytest.approx(0.5)


def test_tied_to_another_axis():
    falling = TIME % 3.2 >= 1.6
    axis = located([0.1 * falling], [record(other=OTHER)])
    assert share(axis, "branch of y", "falling") == pytest.approx(1, abs=2e-3)
    assert "where the drive of y is falling" in text(axis)
    assert "where the drive is" not in text(axis)
    level = located([OTHER > 35], [record(other=OTHER)])
    assert "100 % of the misfit lies where the drive of y is 35 to 45 V" in text(level)


def test_an_axis_that_is_not_driven_is_no_view():
    names = {one.name for one in located([FALLING], [record(other=0 * TIME)]).views}
    assert not [name for name in names if name.endswith("of y")]


def test_what_is_not_scored_does_not_count():
    axis = located([1.0 * (TIME < 1)], [record(settle=1000)])
    assert (axis.misfit, axis.samples) == (0, 7000)


@pytest.mark.parametrize("seed", range(5))
def test_white_noise_at_the_floor_is_no_misfit(seed):
    rng = np.random.default_rng(seed)
    axis = located([0.05 * rng.normal(size=8000) for _ in range(3)], floor=Floor(5e-8, "rest segments"))
    assert (axis.misfit, axis.map, axis.worst) == (0, None, ())
    assert not [one for one in axis.views if one.dominant]
    assert axis.sentences == ("Nothing is left above the noise.",)


def test_noise_takes_no_share():
    noise = 0.05 * np.random.default_rng(1).normal(size=8000)
    axis = located([noise + 0.1 * FALLING], floor=Floor(5e-8, "rest segments"))
    assert share(axis, "branch", "falling") == pytest.approx(1, abs=0.02)
    assert axis.misfit == pytest.approx(0.1 / 2**0.5, rel=0.02)


def test_a_misfit_that_is_everywhere_dominates_nowhere_in_time():
    axis = located([0.1 * np.random.default_rng(1).normal(size=8000)], floor=Floor(5e-8, "rest segments"))
    assert axis.misfit == pytest.approx(0.1 * 0.75**0.5, rel=0.02)
    assert axis.sentences == ("No record, branch, amplitude, rate or band stands out: the misfit is spread evenly.",)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0, 0.9), st.integers(1, 3), st.integers(0, 500))
def test_shares_sum_to_one_and_squares_add(seed, floor, count, settle):
    rng = np.random.default_rng(seed)
    drives = [np.cumsum(rng.normal(size=1000)) for _ in range(count)]
    records = [
        replace(record(f"{i}", drive=drive, other=drive[::-1].copy()), dt=DT * 3**i, settle=settle)
        for i, drive in enumerate(drives)
    ]
    residuals = [rng.normal(size=1000) * rng.uniform(0, 2, 1000) for _ in drives]
    axis = located(residuals, records, Floor(1e-6 * floor, "given"))
    for one in axis.views:
        assert sum(part.share for part in one.bins) == pytest.approx(1 if axis.misfit else 0)
        assert sum(part.samples for part in one.bins) == pytest.approx(1)
        squares = [(part.rmse or 0) ** 2 * (1 if one.name == "frequency" else part.samples) for part in one.bins]
        if one.covers == 1:
            assert sum(squares) == pytest.approx(axis.rmse**2)
    if axis.misfit:
        assert axis.rmse**2 == pytest.approx(axis.noise_floor**2 + axis.misfit**2)
        assert sum(map(sum, axis.map.share)) == pytest.approx(1)
    assert json.loads(json.dumps(asdict(axis)))["axis"] == "x"


def test_the_map_crosses_the_two_views_that_tell_most():
    axis = located([0.1 * FALLING, 0 * TIME])
    assert (axis.map.rows, axis.map.row_labels) == ("record", ("record 0", "record 1"))
    assert (axis.map.columns, axis.map.column_labels) == ("branch", ("rising", "falling", "holding"))
    np.testing.assert_allclose(axis.map.share, [[0, 1, 0], [0, 0, 0]], atol=2e-3)
    assert axis.map.rmse[0] == (pytest.approx(0, abs=5e-3), pytest.approx(0.1, rel=2e-3), None)


def test_the_worst_stretches():
    burst = (TIME > 2) & (TIME < 2.5)
    axis = located([0.1 + 0 * TIME, 0.1 + burst + 0.8 * (TIME > 7.5)])
    first, second = axis.worst
    assert first.record == "record 1"
    assert (first.start, first.end) == (pytest.approx(2, abs=0.05), pytest.approx(2.5, abs=0.05))
    assert first.rmse == pytest.approx(1.1, rel=0.05)
    assert (second.start, second.end) == (pytest.approx(7.5, abs=0.05), pytest.approx(7.999, abs=0.05))
    total = 0.01 * (16_000 - 998) + 1.21 * 499 + 0.81 * 499
    assert first.share == pytest.approx(1.21 * 499 / total, rel=0.05)


@given(st.lists(st.integers(-5, 5), min_size=1, max_size=14))
def test_the_heaviest_run_is_the_heaviest(weights):
    runs = heaviest_runs(np.array(weights, dtype=float), 3)
    sums = [sum(weights[i:j]) for i, j in combinations(range(len(weights) + 1), 2)]
    if max(sums) <= 0:
        assert not runs
    else:
        assert sum(weights[slice(*runs[0])]) == max(sums)
        covered = [place for first, last in runs for place in range(first, last)]
        assert len(covered) == len(set(covered))


@given(st.lists(st.floats(1e-6, 1e6), min_size=1, max_size=30), st.integers(0, 5))
def test_every_value_is_in_its_bin(values, shift):
    values = np.array(values)
    for binning in (linear_binning("a", "V", [values]), logarithmic_binning("b", "s", [values], 1e-4 * values.max())):
        for value, place in zip(values, binning.places[0], strict=True):
            limits, slack = binning.bins[place], 1e-9 * values.max()
            assert limits.lower - slack <= value <= limits.upper + slack
    integers = np.round(values).astype(int) + 1
    binning = doubling_binning("c", [integers])
    for value, place in zip(integers, binning.places[0], strict=True):
        assert binning.bins[place].lower <= value <= binning.bins[place].upper


@given(st.integers(2, 300), st.integers(0, 100))
def test_parseval(samples, seed):
    values = np.random.default_rng(seed).normal(size=samples)
    energy, freedom = power_spectrum(values)
    assert energy.sum() == pytest.approx((values**2).sum())
    assert freedom.sum() == samples


def test_each_axis_has_its_own_residual_unit_and_floor():
    """0.1 um of x above no noise, 300 nm of y above 200 nm."""
    both = replace(record(other=OTHER), response_units=("um", "nm"))
    both = replace(both, response=np.vstack([1e-7 * TRIANGLE, 1e-7 * OTHER]))
    residuals = np.array([0.1e-6, 300e-9])[:, None] * np.ones((2, TIME.size))
    x, y = locate([both], [residuals], [SILENT, Floor(200e-9, "given")])
    assert (x.axis, x.unit, x.rmse, x.misfit) == ("x", "um", pytest.approx(0.1), pytest.approx(0.1))
    assert (y.axis, y.unit, y.rmse, y.noise_floor) == ("y", "nm", pytest.approx(300), pytest.approx(200))
    assert y.misfit == pytest.approx(np.sqrt(300**2 - 200**2))
    assert (x.noise_source, y.noise_source) == ("none", "given")


@pytest.mark.parametrize(("settle", "excess"), [(0, 0.3), (7900, 4 * np.sqrt(2 / 100))])
@pytest.mark.parametrize("more", [0.98, 1.02])
def test_an_excess_is_more_than_chance_and_than_the_error_of_the_floor(settle, excess, more):
    """Of many samples 0.3 of the squared floor, of 100 samples four standard deviations of their mean square."""
    size = 0.05 * np.sqrt(1 + more * excess)
    axis = located([size + 0 * TIME], [record(settle=settle)], Floor(0.05e-6, "given"))
    assert axis.misfit == pytest.approx(0.05 * np.sqrt(more * excess) if more > 1 else 0)


def test_a_part_below_the_noise_is_said_to_be():
    axis = located([np.where(FALLING, 1.0, 0.01)], floor=Floor(0.05e-6, "given"))
    below = {part.label: part.below_noise for part in view(axis, "branch").bins}
    assert (below["falling"], below["rising"]) == (False, True)


@pytest.mark.parametrize(("count", "least"), [(10, 0.25), (2, 0.75)])
@pytest.mark.parametrize("more", [-0.01, 0.01])
def test_a_dominant_part_has_a_share_beyond_that_of_its_samples(count, least, more):
    """0.15 more than a tenth, or one and a half times a half."""
    part = least + more
    sizes = [np.sqrt(part), *[np.sqrt((1 - part) / (count - 1))] * (count - 1)]
    axis = located([size + 0 * TIME for size in sizes], [record(f"{i}", settle=7000) for i in range(count)])
    most = view(axis, "record").dominant
    assert (most is not None) == (more > 0)
    assert most is None or (most.first, most.last, most.share) == (0, 0, pytest.approx(part))


def test_what_is_due_to_a_record_is_not_said_of_its_branch():
    """One record only rises and has 9 of 14 parts of the squares, five only fall."""
    ramp = np.linspace(0, 100, TIME.size)
    records = [record("up", drive=ramp), *[record(f"down {i}", drive=ramp[::-1].copy()) for i in range(5)]]
    axis = located([(0.3 if i == 0 else 0.1) + 0 * TIME for i in range(6)], records)
    assert view(axis, "record").dominant.share == pytest.approx(9 / 14)
    assert share(axis, "branch", "rising") == pytest.approx(9 / 14, abs=2e-3)
    assert view(axis, "branch").dominant is None


def test_samples_are_sorted_in_few_bytes():
    """A dozen numbers a sample at most, though there are nine views."""
    drive = np.tile(TRIANGLE, 25)
    long, residual = record(drive=drive), np.random.default_rng(0).normal(0, 1e-8, (1, drive.size))
    locate([record()], [residual[:, : TIME.size]], [SILENT])
    tracemalloc.start()
    (found,) = locate([long], [residual], [Floor(5e-9, "rests")])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(found.views) == 9
    assert peak < 12 * drive.nbytes
