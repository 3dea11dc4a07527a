"""Time stamps that are rounded are a grid; stamps of which one is missing are none."""

import numpy as np
import pytest

N = np.arange(500)


def written(folder, stamps, form, unit="s"):
    path = folder / "loop.csv"
    rows = "".join(f"{t:{form}},{i % 7},{i % 11}\n" for i, t in enumerate(stamps))
    path.write_text(f"t [{unit}],u [V],x [um]\n{rows}", encoding="utf-8")
    return path


@pytest.mark.parametrize(("rate", "form", "decimal"), [(30e3, ".6f", 1e-6), (300.0, ".4f", 1e-4), (7e3, ".5f", 1e-5)])
def test_stamps_rounded_to_a_decimal_are_a_grid(tmp_path, read, rate, form, decimal):
    record = read(written(tmp_path, 5.4321 + N / rate, form))
    assert record.dt == pytest.approx(1 / rate, abs=1.01 * decimal / (N.size - 1))
    assert record.notes[0].startswith(f"time stamps are rounded to {decimal:g} s")


@pytest.mark.parametrize(("rate", "since"), [(50e3, 1.8e9), (500e3, 1.8e9), (50e3, 3.8e9), (5e3, -1.8e9)])
@pytest.mark.parametrize("form", [".9f", ".7f"])
def test_seconds_counted_from_1970_or_1904_are_a_grid_to_their_last_bit(tmp_path, read, rate, since, form):
    record = read(written(tmp_path, since + N / rate, form))
    assert record.dt == pytest.approx(1 / rate, abs=1.01 * np.spacing(abs(since)) / (N.size - 1))


def test_seconds_from_1970_of_too_fast_a_clock_are_refused(tmp_path, problem):
    assert "repeats" in problem(written(tmp_path, 1.8e9 + N / 1e7, ".9f")).message


def test_stamps_in_another_unit_are_rounded_there(tmp_path, read):
    record = read(written(tmp_path, 1e3 * N / 30e3, ".3f", "ms"), clock="t [ms]")
    assert record.dt == pytest.approx(1 / 30e3, rel=1e-4)
    assert "rounded to 1e-06 s" in record.notes[0]


def test_stamps_that_are_exact_are_said_nothing_of(tmp_path, read):
    assert read(written(tmp_path, N / 1e3, ".3f")).notes == ()


@pytest.mark.parametrize("lost", [1, 250, 498])
@pytest.mark.parametrize(("rate", "form"), [(30e3, ".6f"), (300.0, ".4f"), (1e3, ".3f"), (300.0, ".3f")])
@pytest.mark.parametrize("since", [0.0, 1.8e9])
def test_a_sample_that_is_lost_is_no_rounding(tmp_path, problem, lost, rate, form, since):
    assert "time is not uniform" in problem(written(tmp_path, since + np.delete(N / rate, lost), form)).message


def test_stamps_coarser_than_a_fifth_of_a_sample_are_refused(tmp_path, problem):
    assert "time is not uniform" in problem(written(tmp_path, N / 300.0, ".3f")).message
