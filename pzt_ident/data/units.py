"""Units as written in headers and job files: a small table, SI prefixes, products and quotients."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Sequence
from functools import lru_cache

from pzt_ident.errors import InputError, nearest

Dimension = tuple[int, int, int, int, int]
"""Exponents of m, kg, s, A, K."""

_NUMBER: Dimension = (0, 0, 0, 0, 0)
TIME: Dimension = (0, 0, 1, 0, 0)
FREQUENCY: Dimension = (0, 0, -1, 0, 0)
MASS: Dimension = (0, 1, 0, 0, 0)

_PREFIXES = {
    "f": 1e-15,
    "p": 1e-12,
    "n": 1e-9,
    "u": 1e-6,
    "m": 1e-3,
    "c": 1e-2,
    "d": 1e-1,
    "k": 1e3,
    "M": 1e6,
    "G": 1e9,
}
_PREFIXED: dict[str, tuple[float, Dimension]] = {
    "m": (1, (1, 0, 0, 0, 0)),
    "g": (1e-3, MASS),
    "s": (1, TIME),
    "A": (1, (0, 0, 0, 1, 0)),
    "K": (1, (0, 0, 0, 0, 1)),
    "Hz": (1, FREQUENCY),
    "N": (1, (1, 1, -2, 0, 0)),
    "Pa": (1, (-1, 1, -2, 0, 0)),
    "J": (1, (2, 1, -2, 0, 0)),
    "W": (1, (2, 1, -3, 0, 0)),
    "C": (1, (0, 0, 1, 1, 0)),
    "V": (1, (2, 1, -3, -1, 0)),
    "F": (1, (-2, -1, 4, 2, 0)),
    "Ohm": (1, (2, 1, -3, -2, 0)),
    "rad": (1, _NUMBER),
}
_WORDS = {
    "m": "meter meters metre metres",
    "um": "micron microns micrometer micrometers micrometre micrometres",
    "nm": "nanometer nanometers nanometre nanometres",
    "mm": "millimeter millimeters millimetre millimetres",
    "s": "sec secs second seconds",
    "ms": "msec millisecond milliseconds",
    "us": "usec microsecond microseconds",
    "min": "minute minutes",
    "h": "hour hours",
    "V": "volt volts",
    "mV": "millivolt millivolts",
    "kV": "kilovolt kilovolts",
    "A": "amp amps ampere amperes",
    "N": "newton newtons",
    "C": "coulomb coulombs",
    "F": "farad farads",
    "Ohm": "ohm ohms Ω",
    "Hz": "hertz",
    "1": "count counts lsb",
}
_SINGLE: dict[str, tuple[float, Dimension]] = {
    **_PREFIXED,
    **{
        prefix + name: (size * scale, dim)
        for prefix, scale in _PREFIXES.items()
        for name, (size, dim) in _PREFIXED.items()
    },
    "1": (1, _NUMBER),
    "%": (1e-2, _NUMBER),
    "min": (60, TIME),
    "h": (3600, TIME),
}
_SYNONYM = {word: unit for unit, words in _WORDS.items() for word in words.split()}
_FACTOR = re.compile(
    r"(?:(?P<name>[^\W\d_]+|%)|\((?P<inside>[^()]+)\))(?:(?:\^|\*\*)?(?P<power>[+-]?\d+))?|(?P<number>[+-]?\d+\.?\d*(?:[eE][+-]?\d+)?)"
)
_SCALED = re.compile(r"^[+-]?\d+\.?\d*(?:[eE][+-]?\d+)?\s+(?=[^\W\d_])")
_BRACKETED = re.compile(r"^(?P<name>.*?)\s*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>[^()]*)\))\s*$")
_TRAILING = re.compile(r"^(?P<name>.+?)(?:\s*,\s*|\s+)(?P<unit>[^\s,]+)$")
_SPELLING = str.maketrans("μ−·⋅×", "u-***")
_LABELLED = re.compile(r"(?i)\b(?:ch|channel|sensor|axis|input|output|probe|actuator|stage|phase)$")


def factor(unit: str) -> float:
    """The factor from `unit` to SI units: `factor("um/V")` is 1e-6.

    A number in front is the scale of a signal: values in `20 V` are volts after a gain of 20.
    Raises InputError with the nearest known words.
    """
    return _parsed(unit)[0]


def dimension(unit: str) -> Dimension:
    """The exponents of m, kg, s, A, K. Raises InputError with the nearest known words."""
    return _parsed(unit)[1]


def same_kind(a: str, b: str) -> bool:
    """Whether values in one unit can be converted to the other."""
    return dimension(a) == dimension(b)


def duration(text: str) -> float:
    """A time above zero, such as `60s` or `5 min`, in s, which is its unit where none is given. Raises InputError."""
    match = re.fullmatch(r"\s*(\d+\.?\d*|\.\d+)\s*([a-zA-Zµ]*)\s*", text)
    unit = (match and match[2]) or "s"
    seconds = float(match[1]) * factor(unit) if match and is_unit(unit) and same_kind(unit, "s") else 0.0
    if not 0 < seconds < float("inf"):
        raise InputError(f"{text!r} is no time above zero", remedy="write it as 60s, 5min or 1h")
    return seconds


def of_one_kind(units: Sequence[str]) -> bool:
    """Whether values in all units can be added up."""
    return all(same_kind(unit, units[0]) for unit in units)


def common_unit(units: Sequence[str]) -> str:
    """The unit of a number over responses in several units: the first, or 1 where they are of different kinds."""
    return units[0] if of_one_kind(units) else "1"


def unscaled(unit: str) -> str:
    """The unit without a number in front, in which results are shown: `V` for `20 V`."""
    return _SCALED.sub("", unit.strip())


def is_unit(text: str) -> bool:
    try:
        _parsed(text)
    except InputError:
        return False
    return True


def plain(text: str) -> str:
    """A text in a uniform spelling: NFKC, ASCII micro, minus and product signs, single spaces."""
    return " ".join(unicodedata.normalize("NFKC", text).translate(_SPELLING).split())


def split_header(header: str) -> tuple[str, str | None]:
    """Name and unit of a column: `u_x [V]`, `u_x (V)`, `Ch1,V` and `P1 uC_per_cm2` all have one.

    Text in square brackets counts as a unit, known or not; elsewhere only a known unit does, and a single letter
    after a word such as `Channel` does not.
    """
    header = header.strip()
    if match := _BRACKETED.match(header):
        inside = (match["square"] if match["square"] is not None else match["round"]).strip()
        if match["square"] is not None or is_unit(inside):
            return match["name"], inside or None
    elif match := _TRAILING.match(header):
        label = len(match["unit"]) == 1 and "," not in header and _LABELLED.search(match["name"])
        if not match["unit"][0].isdigit() and is_unit(match["unit"]) and not label:
            return match["name"], match["unit"]
    return header, None


@lru_cache(maxsize=512)
def _parsed(unit: str) -> tuple[float, Dimension]:
    text = plain(unit).replace("_per_", "/").replace(" per ", "/")
    size, powers, position, sign = 1.0, [0] * 5, 0, 1
    while True:
        match = _FACTOR.match(text, position)
        if not match:
            raise _unknown(unit, text[position:])
        scale, dim, power = _single(unit, match)
        try:
            size *= scale ** (sign * power)
        except (OverflowError, ZeroDivisionError):
            size = math.inf
        powers = [old + sign * power * new for old, new in zip(powers, dim, strict=True)]
        if match.end() == len(text):
            if not 0 < abs(size) < math.inf:
                problem = f"the unit {unit!r} is {'infinite' if size else 'zero'}"
                raise InputError(problem, remedy="give a scale such as 20 in `20 V`")
            return size, (powers[0], powers[1], powers[2], powers[3], powers[4])
        operator = re.compile(r"\s*([*/])\s*|\s+").match(text, match.end())
        if not operator:
            raise _unknown(unit, text[position:])
        sign, position = (-1 if operator[1] == "/" else 1), operator.end()


def _single(unit: str, match: re.Match[str]) -> tuple[float, Dimension, int]:
    if match["number"]:
        return float(match["number"]), _NUMBER, 1
    if match["inside"]:
        return *_parsed(match["inside"]), int(match["power"] or 1)
    name = match["name"]
    name = name if name in _SINGLE else _SYNONYM.get(name.lower(), name)
    name = re.sub("(?:Ω|ohm)$", "Ohm", name)
    if name not in _SINGLE:
        raise _unknown(unit, match["name"])
    return *_SINGLE[name], int(match["power"] or 1)


def _unknown(unit: str, part: str) -> InputError:
    context = f" (in {unit!r})" if part != unit else ""
    common = "m mm um nm micron s ms us second Hz kHz V mV kV volt A mA N mN C uC nC F kg K Pa J W Ohm rad % count 1"
    return InputError(f"unknown unit {part!r}{context}", remedy=nearest(part, common.split()))
