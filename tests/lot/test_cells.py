"""What a column holds, whatever is in its cells: numbers, whole numbers, dates or words."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pzt_ident.lot.cells import odd_cells, values_of


@pytest.mark.parametrize(
    ("cells", "values"),
    [
        (["23", "23.5", "-1e3", "+.5", "\u22124"], [23.0, 23.5, -1000.0, 0.5, -4.0]),
        (["23", "NA", "", " n/a ", "none", "-", "\u2013"], [23, None, None, None, None, None, None]),
        (["12", "", "13"], [12, None, 13]),
        (["2026-03-02", "none", "3.2.2026", "-"], ["2026-03-02", None, "3.2.2026", None]),
        (["A", "NA", "", "none", "-"], ["A", None, None, "none", None]),
        (["23", "23 C"], ["23", "23 C"]),
        (["00012", "12345"], ["00012", "12345"]),
        (["4001234567890123"], ["4001234567890123"]),
        (["0.30000000000000004", "0", "023.5"], [0.30000000000000004, 0.0, 23.5]),
        (["1_000", "٣", "inf", "1e999", "nan"], ["1_000", "٣", "inf", "1e999", None]),
        (["23,5", "24"], ["23,5", "24"]),
        (["", "NA"], [None, None]),
    ],
)
def test_a_column_holds_numbers_or_words(cells, values):
    assert values_of(cells) == values


@pytest.mark.parametrize("cells", [["23,5", "24", "1.5e3", "-"], ["1,234"]])
def test_decimals_may_have_a_comma_where_cells_have_none(cells):
    assert values_of(cells, ".,") == [None if cell == "-" else float(cell.replace(",", ".")) for cell in cells]
    assert values_of(["1.234,5"], ".,") == ["1.234,5"]


NUMBERS = ["290", "291.5", "292", "-", "293", "294"]
DATES = ["2026-03-02", "02.03.2026", "", "2026-03-02 14:05"]


@pytest.mark.parametrize(
    ("cells", "kind", "told"),
    [
        ([*NUMBERS, "29O.1"], "number", ["29O.1"]),
        ([*NUMBERS, "1.000,5", "n/a", "21 C"], "number", ["1.000,5", "21 C"]),
        ([*NUMBERS, *["x"] * 4], "number", ["x"] * 4),
        ([*DATES, "2026-13-45"], "date", ["2026-13-45"]),
        ([*DATES, "03/02/2026", "NA"], "date", ["03/02/2026"]),
    ],
)
def test_what_makes_words_of_a_column_is_told(cells, kind, told):
    odd = odd_cells(cells)
    assert (odd.kind, odd.cells, [cells[place] for place in odd.places]) == (kind, told, told)
    assert odd.remedy
    assert all(value is None or isinstance(value, str) for value in values_of(cells))


@pytest.mark.parametrize(
    "cells", [NUMBERS, DATES, [*NUMBERS, *"abcde"], ["B7", "B8", "B9"], ["0012", "1200", "1201", "1202"], [], ["", "-"]]
)
def test_of_a_column_of_one_kind_nothing_is_told(cells):
    assert odd_cells(cells) is None


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False).map(repr), min_size=1))
def test_numbers_are_kept_to_the_last_digit(cells):
    assert values_of(cells) == [float(cell) for cell in cells]


@given(st.lists(st.integers(0, 10**24).map(str), min_size=1))
def test_no_digit_of_an_identifier_is_lost(cells):
    values = values_of(cells)
    assert [value if isinstance(value, str) else f"{value:.0f}" for value in values] == cells


@given(st.lists(st.none() | st.integers(-(10**14), 10**14)))
def test_whole_numbers_stay_whole_where_a_cell_is_empty(numbers):
    values = values_of(["" if number is None else str(number) for number in numbers])
    assert values == numbers and all(value is None or type(value) is int for value in values)
