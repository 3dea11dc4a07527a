"""Robust spreads: planted outliers are found and no others, with and without a dependence on a column."""

import numpy as np
import pytest

from pzt_ident.lot.sentences import groups_of
from pzt_ident.lot.statistics import Quantity, differences, groups, numeric, out_of_line, spread, trends

RNG = np.random.default_rng(0)
N = 200
NORMAL = RNG.standard_normal(N)
NAMES = [f"d{i}" for i in range(N)]


def quantity(values, *, name="gain", known=None, error=0.0, one_sided=False):
    half = np.full(values.size, 1.96 * error)
    known = np.ones(values.size, bool) if known is None else known
    return Quantity(name, "um", values, values - half, values + half, known, one_sided)


def test_the_spread_is_the_standard_deviation_of_a_normal_distribution():
    values = 3 + 0.2 * np.random.default_rng(1).standard_normal(100_000)
    assert spread(values) == pytest.approx(0.2, rel=0.01)
    assert spread(np.append(values[:1000], np.full(300, 1e9))) < 0.4


def test_a_planted_device_is_out_of_line_and_no_other():
    values = 1 + 0.01 * np.clip(NORMAL, -3, 3)
    values[7] = 1.08
    (finding,) = out_of_line(NAMES, [quantity(values)], [], {})
    assert (finding.device, finding.quantity) == ("d7", "gain")
    assert finding.sentence.startswith("gain 1.080\u00a0µm, usual 1.000\u00a0µm: ")
    assert finding.sentence.endswith("spreads above")


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_what_is_out_of_line_does_not_hang_on_the_unit(scale):
    values = scale * (1 + 0.01 * np.clip(NORMAL, -3, 3))
    values[3], values[5] = 1.07 * scale, 0.9 * scale
    assert [finding.device for finding in out_of_line(NAMES, [quantity(values)], [], {})] == ["d5", "d3"]


def test_a_device_within_its_own_error_or_not_determined_is_in_line():
    values = np.full(N, 1.0)
    values[2] = 1.2
    assert out_of_line(NAMES, [quantity(values, error=0.1)], [], {}) == []
    assert len(out_of_line(NAMES, [quantity(values, error=0.01)], [], {})) == 1
    assert out_of_line(NAMES, [quantity(values, known=np.arange(N) != 2)], [], {}) == []


@pytest.mark.parametrize("share", [0.05, 0.3, 0.45])
@pytest.mark.parametrize("difference", [1e-12, 1e-6, 1e-3])
def test_where_most_values_are_equal_the_others_are_out_of_line_where_they_are_few_and_far(share, difference):
    values = np.where(np.arange(N) < share * N, 1 + difference * (1 + 0.1 * NORMAL), 1.0)
    findings = out_of_line(NAMES, [quantity(values)], [], {})
    assert bool(findings) == (difference == 1e-3 and share < 0.2)
    values[:1] = 1.2
    assert [finding.device for finding in out_of_line(NAMES, [quantity(values)], [], {})][:1] == ["d0"]


def test_what_is_usual_of_an_error_is_more_than_nothing():
    kelvin = np.linspace(280, 340, N)
    values = np.maximum(1.0 - (kelvin - 280) / 40 + 0.01 * NORMAL, 0.01)
    values[-1] = 5.0
    noise = quantity(values, name="noise floor", one_sided=True)
    columns = {"temperature [K]": kelvin.tolist()}
    (finding,) = [f for f in out_of_line(NAMES, [noise], trends([noise], columns), columns) if f.device == f"d{N - 1}"]
    assert trends([noise], columns)[0].at(kelvin)[-1] < 0 < float(finding.sentence.split()[-4])


@pytest.mark.parametrize("devices", [8, 40])
def test_of_healthy_lots_few_have_a_finding_however_many_columns_and_quantities(devices):
    """Five in a hundred of each kind, less where the limit is that of large lots."""
    rng, lots = np.random.default_rng(devices), 40
    found = np.zeros((lots, 3), bool)
    for lot in range(lots):
        quantities = [quantity(1 + 0.01 * rng.standard_normal(devices), name=f"q{i}") for i in range(6)]
        columns = {f"number {i}": rng.standard_normal(devices).tolist() for i in range(4)}
        columns |= {f"word {i}": rng.choice(["a", "b", "c"], devices).tolist() for i in range(4)}
        known = trends(quantities, columns)
        groups = differences(quantities, columns, devices)
        far = out_of_line(NAMES[:devices], quantities, [], columns)
        found[lot] = bool(far), any(item.clear for item in known), any(item.clear for item in groups)
    assert found.mean(axis=0).max() <= 0.15


def test_a_device_that_is_far_out_is_found_in_a_small_lot_too():
    values = 1 + 0.01 * np.random.default_rng(5).standard_normal(16)
    values[3] = 1.3
    assert [finding.device for finding in out_of_line(NAMES[:16], [quantity(values)], [], {})] == ["d3"]


def test_a_device_of_which_a_column_says_nothing_is_judged_as_if_nothing_hung_on_it():
    kelvin = np.linspace(280, 340, N)
    gain = quantity(1 + 0.002 * (kelvin - 310) + 0.001 * np.clip(NORMAL, -3, 3))
    columns = {"temperature [K]": [None, *kelvin[1:].tolist()]}
    assert out_of_line(NAMES, [gain], trends([gain], columns), columns) == []
    gain.values[0] = 2.0
    (finding,) = out_of_line(NAMES, [gain], trends([gain], columns), columns)
    assert "usual 1." in finding.sentence


def test_few_devices_do_not_tell_what_is_usual():
    assert out_of_line(NAMES[:7], [quantity(np.array([1, 1, 1, 1, 1, 1, 9.0]))], [], {}) == []


def test_of_an_error_only_large_values_are_out_of_line():
    values = 1 + 0.01 * np.clip(NORMAL, -3, 3)
    values[1], values[2], values[3] = 0.1, 5.0, 1.2
    (finding,) = out_of_line(NAMES, [quantity(values, one_sided=True)], [], {})
    assert (finding.device, finding.of_fit) == ("d2", True)
    assert "5.0 times the usual" in finding.sentence


def test_a_trend_is_found_with_its_slope_and_devices_are_judged_beside_it():
    kelvin = np.repeat([280.0, 300.0, 320.0, 340.0], N // 4)
    values = 1 + 0.002 * (kelvin - 300) + 0.005 * np.clip(NORMAL, -3, 3)
    values[0] = 1.0  # usual in the middle of the lot, not at 280 K
    gain, columns = quantity(values), {"temperature [K]": kelvin.tolist(), "serial": NAMES}
    (trend,) = trends([gain], columns)
    assert (trend.column, trend.slope) == ("temperature [K]", pytest.approx(0.002, rel=0.05))
    assert trend.clear and trend.correlation > 0.9
    assert out_of_line(NAMES, [gain], [], columns) == []
    (finding,) = out_of_line(NAMES, [gain], [trend], columns)
    assert finding.device == "d0"
    assert "usual at its temperature 0.96" in finding.sentence


def test_a_trend_and_a_difference_that_are_certain_are_found_however_weak():
    rng = np.random.default_rng(3)
    x, batch = rng.standard_normal(N), rng.choice(["A", "B"], N)
    gain = quantity(1 + 0.01 * (0.35 * x + 0.6 * (batch == "B") + rng.standard_normal(N)))
    columns = {"x": x.tolist(), "batch": batch.tolist()}
    (trend,), (difference,) = trends([gain], columns), differences([gain], columns, N)
    assert trend.clear and 0.2 < trend.correlation < 0.45 and not trend.strong
    assert difference.clear and difference.distance < 0.5
    assert out_of_line(NAMES, [gain], [trend], columns) == out_of_line(NAMES, [gain], [], {})


def test_chance_is_no_trend_and_no_difference():
    """Of 200 columns by chance."""
    gain, rng = quantity(NORMAL), np.random.default_rng(2)
    columns = {f"c{i}": rng.standard_normal(N).tolist() for i in range(100)}
    words = {f"w{i}": rng.choice(["A", "B", "C"], N).tolist() for i in range(100)}
    assert not any(trend.clear for trend in trends([gain], columns))
    assert not any(difference.clear for difference in differences([gain], words, N))


def test_groups_that_differ_are_found():
    batch = ["A", "B"] * (N // 2)
    values = 1 + 0.01 * NORMAL + 0.02 * (np.array(batch) == "B")
    (difference,) = differences([quantity(values)], {"batch": batch, "serial": NAMES}, N)
    assert difference.clear
    assert difference.medians == {"A": pytest.approx(1.0, abs=0.003), "B": pytest.approx(1.02, abs=0.003)}


def test_of_many_groups_that_which_stands_out_is_named():
    batch = [f"B{i % 10}" for i in range(N)]
    values = 1 + 0.01 * NORMAL + 0.3 * (np.array(batch) == "B7")
    (difference,) = differences([quantity(values)], {"batch": batch}, N)
    assert difference.clear and difference.furthest == "B7"
    assert groups_of(difference, "um") == "B7 has 1.307 um, 31\u00a0% above the median of all"


def test_dates_are_days_and_words_are_groups():
    columns = {"date": ["2026-03-02", None, "2026-03-05"], "batch": ["A", "B", "A"], "K": [1.0, None, 2.0]}
    numbers = numeric(columns)
    np.testing.assert_array_equal(numbers["date [days]"], [0, np.nan, 3])
    np.testing.assert_array_equal(numbers["K"], [1, np.nan, 2])
    assert list(groups(columns | {"batch": ["A", "B", "A"]}, 6)) == ["batch"]


@pytest.mark.parametrize(
    "dates",
    [
        ["2026-03-02", None, "2026-03-05"],
        ["02.03.2026", None, "5.3.2026"],
        ["02.03.2026 14:05", None, "05.03.2026 14:05:00"],
        ["2026-03-02T23:30+01:00", None, "2026-03-05T22:30Z"],
        ["2026-03-02 08:00", "2026-03-02T08:00:00", "2026-03-05 08:00"],
    ],
)
def test_dates_are_read_as_they_are_written(dates, recwarn):
    days = numeric({"date": dates})["date [days]"]
    np.testing.assert_allclose(days[[0, 2]], [0, 3])
    assert not recwarn


@pytest.mark.parametrize(
    "word", ["now", "today", "NaT", "20260302", "PX-1000", "2026-99", "32.01.2026", "03/02/2026", "1"]
)
def test_words_are_no_dates(word):
    assert numeric({"date": ["2026-03-02", word]}) == {}
