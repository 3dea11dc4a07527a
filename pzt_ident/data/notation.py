"""Numbers and units as an engineer writes them."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterable, Sequence

MISSING = "–"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: float | None, digits: int = 4) -> str:
    """`value` with `digits` significant digits: 0.08195, 17.30, 8.195 × 10⁻⁸; a dash for None and NaN."""
    if value is None or math.isnan(value):
        return MISSING
    if math.isinf(value) or value == 0:
        return {math.inf: "∞", -math.inf: "−∞"}.get(value, "0")
    power = _power(value, digits)
    if -4 <= power < 5:
        return _fixed(value, digits - 1 - power)
    return f"{_fixed(value / 10.0**power, digits - 1)} × {power_of_ten(power)}"


def alike(values: Sequence[float], digits: int = 4) -> list[str]:
    """Numbers that are compared, all with the power of ten of the largest or all without: 0.9593 × 10⁵, 1.505 × 10⁵.
    Those of very different size as `number` writes each."""
    powers = {value: _power(value, digits) for value in values if value and math.isfinite(value)}
    highest, lowest = max(powers.values(), default=0), min(powers.values(), default=0)
    if highest - lowest > 3:
        return [number(value, digits) for value in values]
    power = 0 if -4 <= highest < 5 else highest
    times = f" × {power_of_ten(power)}" if power else ""

    def written(value: float) -> str:
        return f"{_fixed(value / 10.0**power, digits - 1 - powers[value] + power)}{times}"

    return [written(value) if value in powers else number(value, digits) for value in values]


def short(value: float | None, digits: int = 4) -> str:
    """As `number`, without trailing zeros: for bounds, ticks and other round numbers."""
    mantissa, times, power = number(value, digits).partition(" × ")
    if "." in mantissa:
        mantissa = mantissa.rstrip("0").rstrip(".")
    if mantissa == "1" and times:
        return power
    return {"10000": "10⁴", "0.0001": "10⁻⁴"}.get(mantissa, mantissa) + times + power


def bounds(lower: float | None, upper: float | None) -> str:
    return MISSING if lower is None or upper is None else f"{short(lower)} to {short(upper)}"


def with_error(value: float | None, error: float | None) -> str:
    """`value ± error`, the error with two significant digits and the value with the same decimals.

    Where the value would have fewer than two digits or more than eight, both are written as `number` does.
    """
    if value is None or error is None or not math.isfinite(value) or not math.isfinite(error) or error <= 0:
        return number(value)
    power, last = _power(value, 4), _power(error, 2) - 1
    if value and not 1 <= power - last <= 8:
        return f"{number(value, 2 if power < last + 1 else 8)} ± {number(error, 2)}"
    power = max(power, last + 1)
    if -4 <= power < 5:
        return f"{_fixed(value, -last)} ± {_fixed(error, -last)}"
    scale = 10.0**power
    pair = f"{_fixed(value / scale, power - last)} ± {_fixed(error / scale, power - last)}"
    return f"({pair}) × {power_of_ten(power)}"


def count(value: float | None) -> str:
    """An integer with spaces between the thousands: 17 500."""
    return MISSING if value is None or math.isnan(value) else f"{round(value):,}".replace(",", "\u202f")


def counted(count: int, noun: str) -> str:
    """A number of things: 1 device, 3 devices."""
    return f"{count} {noun}{'s' * (count != 1)}"


def percent(share: float | None, decimals: int = 0) -> str:
    return MISSING if share is None or math.isnan(share) else f"{100 * share:.{decimals}f}\u00a0%"


def unit(text: str) -> str:
    """A unit as it is printed: um/V as µm/V, N s/m as N·s/m, m/s^2 as m/s², 1 as the empty text."""
    text = unicodedata.normalize("NFKC", text).replace("\u03bc", "µ").strip()
    text = re.sub(r"\bu(?=(m|s|g|V|A|N|C|F|K|W|Hz|rad)\b)", "µ", text)
    text = re.sub(r"(?:\^|\*\*)(-?\d+)", lambda match: match[1].translate(SUPERSCRIPTS), text)
    return "" if text == "1" else re.sub(r"\s*\*\s*|\s+", "·", text)


def spelled(text: str) -> str:
    """A sentence with its units printed as by `unit`: 3 um as 3 µm."""
    return re.sub(r"(?<=\d[ \u00a0])u(?=(m|s|g|V|A|N|C|F)\b)", "µ", text)


def quantity(value: float | None, of: str, digits: int = 4) -> str:
    """Number and unit with a non-breaking space between them."""
    return f"{number(value, digits)}\u00a0{unit(of)}".rstrip("\u00a0")


def power_of_ten(power: int) -> str:
    return "10" + str(power).translate(SUPERSCRIPTS)


def listed(names: Iterable[str], last_word: str = "and") -> str:
    """a, b and c; empty where there is nothing."""
    *most, last = [*names] or [""]
    return f"{', '.join(most)} {last_word} {last}" if most else last


def either(names: Iterable[str]) -> str:
    """a, b or c; empty where there is nothing."""
    return listed(names, "or")


def ranges(names: Iterable[str]) -> list[str]:
    """Names, with `weight_3 to weight_9` in the place of three or more that are numbered consecutively."""
    runs: list[list[str]] = []
    for name in names:
        head, _, digits = name.rpartition("_")
        last_head, _, last = runs[-1][-1].rpartition("_") if runs else ("", "", "")
        if last_head == head and digits.isdigit() and last.isdigit() and int(digits) == int(last) + 1:
            runs[-1].append(name)
        else:
            runs.append([name])
    return [text for run in runs for text in ([f"{run[0]} to {run[-1]}"] if len(run) > 2 else run)]


def _power(value: float, digits: int) -> int:
    """The power of ten of `value` rounded to `digits` significant digits."""
    return int(f"{value:.{digits - 1}e}".partition("e")[2])


def _fixed(value: float, decimals: int) -> str:
    return f"{round(value, decimals):.{max(decimals, 0)}f}".replace("-", "−")
