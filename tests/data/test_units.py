import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pzt_ident.data.units import dimension, factor, is_unit, same_kind, split_header, unscaled
from pzt_ident.errors import InputError

NAMED = {
    "um": 1e-6,
    "nm": 1e-9,
    "mV": 1e-3,
    "kV": 1e3,
    "kg": 1,
    "micron": 1e-6,
    "Volts": 1,
    "sec": 1,
    "min": 60,
    "counts": 1,
    "1": 1,
    "kHz": 1e3,
    "um/V": 1e-6,
    "V/um": 1e6,
    "1/V": 1,
    "N*s/m": 1,
    "N s/m": 1,
    "N·s/m": 1,
    "uC/cm2": 1e-2,
    "uC_per_cm2": 1e-2,
    "µC/cm²": 1e-2,
    "kV/cm": 1e5,
    "m/s^2": 1,
    "s⁻¹": 1,
    "kΩ": 1e3,
    "20 V": 20,
    "-15480 nm": -15480e-9,
    "1.25 V/mm": 1250,
    "um/(kV/mm)": 1e-12,
    "1/(kV/mm)^2": 1e-12,
    "uC/cm2/(V/m)": 1e-2,
}


@pytest.mark.parametrize(
    ("unit", "fault"),
    [("1e400", "infinite"), ("1e400 V", "infinite"), ("0 V", "zero"), ("V/0", "infinite"), ("um^-99", "infinite")],
)
def test_a_unit_is_finite_and_not_zero(unit, fault):
    assert not is_unit(unit)
    with pytest.raises(InputError, match=f"the unit {re.escape(repr(unit))} is {fault}"):
        factor(unit)


@pytest.mark.parametrize("unit", NAMED)
def test_factor_to_si(unit):
    assert factor(unit) == pytest.approx(NAMED[unit], rel=1e-12)


def test_both_micro_signs_and_u_are_one():
    assert {factor(unit) for unit in ("\u00b5m", "\u03bcm", "um")} == {1e-6}


@pytest.mark.parametrize(
    ("a", "b", "same"),
    [
        ("N", "kg*m/s2", True),
        ("V", "J/C", True),
        ("V", "A*Ohm", True),
        ("F", "C/V", True),
        ("Pa", "N/m2", True),
        ("W", "J/s", True),
        ("Hz", "1/s", True),
        ("rad", "1", True),
        ("V", "s", False),
        ("um", "um/V", False),
    ],
)
def test_laws_of_dimension(a, b, same):
    assert same_kind(a, b) is same


UNITS = st.sampled_from(["m", "um", "V", "mV", "s", "ms", "N", "kg", "C", "A", "K", "Hz", "1", "micron", "volt"])


@given(UNITS, UNITS)
def test_a_quotient_divides_and_a_product_multiplies(a, b):
    assert factor(f"{a}/{b}") == pytest.approx(factor(a) / factor(b))
    assert factor(f"{a}*{b}") == pytest.approx(factor(a) * factor(b))
    assert dimension(f"{a}/{b}") == tuple(x - y for x, y in zip(dimension(a), dimension(b), strict=True))


@given(UNITS, st.integers(1, 4))
def test_a_power_is_a_repeated_product(unit, power):
    if unit != "1":
        assert factor(f"{unit}^{power}") == pytest.approx(factor("*".join([unit] * power)))


@pytest.mark.parametrize(
    ("header", "expected"),
    {
        "u_x [V]": ("u_x", "V"),
        "u_x (V)": ("u_x", "V"),
        "x(µm)": ("x", "µm"),
        "Ch1,V": ("Ch1", "V"),
        "Time s": ("Time", "s"),
        "P1 uC_per_cm2": ("P1", "uC_per_cm2"),
        "I1 A": ("I1", "A"),
        "V+ [V]": ("V+", "V"),
        "x [furlong]": ("x", "furlong"),
        "Status []": ("Status", None),
        "x (filtered)": ("x (filtered)", None),
        "Channel A": ("Channel A", None),
        "Table 1": ("Table 1", None),
        "V": ("V", None),
    }.items(),
)
def test_split_header(header, expected):
    assert split_header(header) == expected


@pytest.mark.parametrize(("unit", "shown"), [("20 V", "V"), ("1/V", "1/V"), ("uC/cm2", "uC/cm2"), ("-3.5e2 nm", "nm")])
def test_unscaled_is_the_unit_to_show(unit, shown):
    assert unscaled(unit) == shown


@pytest.mark.parametrize(
    ("unit", "part", "remedy"),
    [
        ("khz", "'khz'", "'kHz'"),
        ("um/Volr", "'Volr' (in 'um/Volr')", "'volt'"),
        ("furlong", "'furlong'", "known: "),
        ("", "''", "known: "),
        ("V/", "'' (in 'V/')", "known: "),
        ("V^x", "'V^x'", "'V'"),
        ("um/(kV/furlong)", "'furlong'", "known: "),
    ],
)
def test_an_unknown_unit_names_the_nearest(unit, part, remedy):
    with pytest.raises(InputError) as error:
        factor(unit)
    assert part in error.value.message
    assert remedy in error.value.remedy
