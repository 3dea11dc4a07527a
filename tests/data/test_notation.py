import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pzt_ident.data import notation as numbers

DIGITS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")


def read(text: str) -> float:
    mantissa, power = re.fullmatch(r"([−\d.]+?)?(?:(?:^| × )10([⁻⁰¹²³⁴-⁹]+))?", text).groups()
    return float((mantissa or "1").translate(DIGITS)) * 10.0 ** int((power or "0").translate(DIGITS))


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (8.195e-8, "8.195 × 10⁻⁸"),
        (0.08195, "0.08195"),
        (0.375, "0.3750"),
        (17500.0, "17500"),
        (-1.2e7, "−1.200 × 10⁷"),
        (9.99996, "10.00"),
        (0, "0"),
        (None, "–"),
        (math.nan, "–"),
        (math.inf, "∞"),
        (-math.inf, "−∞"),
    ],
)
def test_a_number_as_an_engineer_writes_it(value, text):
    assert numbers.number(value) == text


@given(st.floats(1e-15, 1e15) | st.floats(-1e15, -1e-15))
def test_four_digits_are_within_half_a_unit_of_the_fourth(value):
    assert read(numbers.number(value)) == pytest.approx(value, rel=5.1e-4)


@given(st.floats(1e-12, 1e12) | st.integers(-9, 9).map(lambda power: 10.0**power))
def test_short_is_the_same_number(value):
    assert read(numbers.short(value)) == pytest.approx(value, rel=5.1e-4)


@pytest.mark.parametrize(("value", "text"), [(0.16, "0.16"), (100.0, "100"), (1e5, "10⁵"), (0.0, "0"), (1e4, "10⁴")])
def test_round_numbers_are_short(value, text):
    assert numbers.short(value) == text


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.081953, 0.000118, "0.08195 ± 0.00012"),
        (8.195e-8, 1.2e-10, "(8.195 ± 0.012) × 10⁻⁸"),
        (12345.6, 123.0, "12350 ± 120"),
        (0.31, 45.0, "0.31 ± 45"),
        (0.0229, 0.048, "0.023 ± 0.048"),
        (0.0, 0.048, "0.000 ± 0.048"),
        (0.375, None, "0.3750"),
        (0.375, 0.0, "0.3750"),
        (0.375, math.inf, "0.3750"),
        (0.375, 1e-13, "0.37500000 ± 1.0 × 10⁻¹³"),
        (None, 1.0, "–"),
    ],
)
def test_value_and_error_end_at_the_same_digit(value, error, text):
    assert numbers.with_error(value, error) == text


@given(st.floats(1e-9, 1e9), st.floats(1e-6, 0.9))
def test_the_printed_pair_has_as_many_decimals_on_either_side(value, share):
    text = numbers.with_error(value, share * value)
    left, right = re.fullmatch(r"\(?([\d.]+) ± ([\d.]+).*", text).groups()
    assert len(left.partition(".")[2]) == len(right.partition(".")[2])


@pytest.mark.parametrize(
    ("given_unit", "printed"),
    [
        ("um", "µm"),
        ("\u03bcm/V", "µm/V"),
        ("1/um", "1/µm"),
        ("N s/m", "N·s/m"),
        ("m/s^2", "m/s²"),
        ("V**-1", "V⁻¹"),
        ("1", ""),
        ("counts", "counts"),
        ("urad", "µrad"),
    ],
)
def test_units_are_printed_as_in_a_paper(given_unit, printed):
    assert numbers.unit(given_unit) == printed


def test_quantity_does_not_break():
    assert numbers.quantity(0.375, "um", 3) == "0.375\u00a0µm"
    assert numbers.quantity(2.0, "1", 2) == "2.0"


@pytest.mark.parametrize(
    ("values", "texts"),
    [
        ([95930.0, 150500.0], ["0.9593 × 10⁵", "1.505 × 10⁵"]),
        ([9.923e-5, 0.09991], ["0.00009923", "0.09991"]),
        ([206.0, 25.29], ["206.0", "25.29"]),
        ([4.971e-6, 0.0304], ["4.971 × 10⁻⁶", "0.03040"]),
        ([2e5, 0.0, math.nan], ["2.000 × 10⁵", "0", "–"]),
        ([], []),
    ],
)
def test_numbers_that_are_compared_are_written_alike(values, texts):
    assert numbers.alike(values) == texts


@given(st.floats(1e-12, 1e12), st.floats(1e-3, 1e3), st.sampled_from([-1, 1]))
def test_numbers_of_one_size_have_one_power_of_ten_and_four_digits(value, ratio, sign):
    texts = numbers.alike([value, sign * value * ratio])
    assert [read(text) for text in texts] == pytest.approx([value, sign * value * ratio], rel=0.51e-3)
    powers = {text.partition(" × ")[2] for text in texts}
    assert len(powers) == 1 or not 1.1e-3 < ratio < 0.9e3


@pytest.mark.parametrize(("count", "text"), [(0, "0 devices"), (1, "1 device"), (2, "2 devices")])
def test_things_are_counted(count, text):
    assert numbers.counted(count, "device") == text


def test_counts_and_shares():
    assert numbers.count(17500) == "17\u202f500"
    assert numbers.count(None) == numbers.percent(None) == "–"
    assert numbers.percent(0.8) == "80\u00a0%"
    assert numbers.bounds(0, 1e5) == "0 to 10⁵"
    assert numbers.bounds(None, None) == "–"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("ended on its bound of 3 um: why", "ended on its bound of 3 µm: why"),
        ("moves at 2 to 40 um/s or 1\u00a0uC/cm2", "moves at 2 to 40 µm/s or 1\u00a0µC/cm2"),
        ("u_x 3 us 4 umbrellas um", "u_x 3 µs 4 umbrellas um"),
    ],
)
def test_units_in_sentences(text, expected):
    assert numbers.spelled(text) == expected
