"""What stands out in a lot: robust spreads, devices out of line, what a quantity depends on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.notation import alike, number, unit
from pzt_ident.data.notation import quantity as in_words
from pzt_ident.lot.dates import dates_of

Array = NDArray[np.float64]

MAD = 1.4826  # times the median absolute deviation is the standard deviation of a normal distribution
MEAN = 1.2533  # times the mean absolute deviation is, too
LEAST = 1e-6  # of the median: a spread below it is of no consequence
FAR = 3.5  # spreads from the median, at least: Iglewicz and Hoaglin (1993), How to Detect and Handle Outliers
CHANCE = 0.05  # that anything is found in a lot where nothing is: devices out of line, trends, differences of groups
WORTH = 0.37  # of a normal deviate is one in a median absolute deviation, as it is in a standard deviation
FEWEST = 8  # devices that tell what is usual
WORSE = 1.5  # times the usual error: less is of no consequence
STRONG = 0.5  # correlation of ranks from which devices are judged beside a trend


@dataclass(frozen=True, eq=False)
class Quantity:
    """One number of each device, with the ends of its interval; known: whether the data of the device determine it.
    one_sided: only large values are out of line."""

    name: str
    unit: str
    values: Array
    low: Array
    high: Array
    known: NDArray[np.bool_]
    one_sided: bool = False

    @property
    def usable(self) -> NDArray[np.bool_]:
        return self.known & self.present

    @property
    def present(self) -> NDArray[np.bool_]:
        """Which devices have it."""
        return np.isfinite(self.values)

    @property
    def median(self) -> float:
        return float(np.median(self.values[self.usable])) if self.usable.any() else float("nan")

    @property
    def spread(self) -> float:
        return spread(self.values[self.usable])

    @property
    def own_error(self) -> float:
        """The median standard error of a single device, 0 where none is known."""
        half = (self.high - self.low)[self.usable] / (2 * 1.96)
        half = half[np.isfinite(half)]
        return float(np.median(half)) if half.size else 0.0


@dataclass(frozen=True)
class Trend:
    """A quantity against a column of numbers: a line by the medians of slopes (Theil-Sen), Spearman's correlation of
    ranks, and the chance that one of all pairs of quantity and column has such a one where none depends on another."""

    quantity: str
    column: str
    slope: float
    level: float
    correlation: float
    chance: float

    def at(self, x: Array) -> Array:
        return self.level + self.slope * x

    @property
    def clear(self) -> bool:
        """Whether chance would hardly give it, be it weak."""
        return self.chance < CHANCE

    @property
    def strong(self) -> bool:
        """Whether devices are judged beside it."""
        return self.clear and abs(self.correlation) > STRONG


@dataclass(frozen=True)
class Difference:
    """A quantity by the groups of a column: the medians, that of all devices, the group that is furthest from it, in
    spreads of single devices, and the chance as of a `Trend` (Kruskal and Wallis 1952)."""

    quantity: str
    column: str
    medians: Mapping[str, float]
    usual: float
    furthest: str
    distance: float
    chance: float

    @property
    def clear(self) -> bool:
        """Whether chance would hardly give it, be it small."""
        return self.chance < CHANCE


@dataclass(frozen=True)
class Finding:
    """A device out of line: in which quantity, how many spreads from the usual value, and that in a sentence. of_fit:
    whether it is the model that does not fit the device."""

    device: str
    quantity: str
    distance: float
    sentence: str
    of_fit: bool


def spread(values: Array) -> float:
    """The median absolute deviation, as a standard deviation; the mean one where more than half of the values are
    equal (Iglewicz and Hoaglin 1993)."""
    if not values.size:
        return float("nan")
    deviations = np.abs(values - np.median(values))
    return float(MAD * np.median(deviations) or MEAN * np.mean(deviations))


def trends(quantities: Sequence[Quantity], columns: Mapping[str, Sequence[Any]]) -> list[Trend]:
    """Each quantity against each column of numbers, the clearest first."""
    pairs = []
    for quantity in quantities:
        for name, x in numeric(columns).items():
            known = quantity.usable & np.isfinite(x)
            if known.sum() >= FEWEST and np.ptp(x[known]) > 0 and np.ptp(quantity.values[known]) > 0:
                pairs.append((quantity, name, x[known], quantity.values[known]))
    return sorted((_trend(*pair, len(pairs)) for pair in pairs), key=lambda trend: -abs(trend.correlation))


def _trend(quantity: Quantity, column: str, x: Array, y: Array, pairs: int) -> Trend:
    from scipy.stats import spearmanr, theilslopes

    few = np.random.default_rng(0).permutation(x.size)[:1000]  # slopes are taken of all pairs
    slope = float(theilslopes(y[few], x[few])[0])
    level = float(np.median(y - slope * x))
    correlation, chance = spearmanr(x, y)
    return Trend(quantity.name, column, slope, level, float(correlation), float(chance) * pairs)


def numeric(columns: Mapping[str, Sequence[Any]]) -> dict[str, Array]:
    """The columns of numbers and of dates; dates as days since the first."""
    numbers = {}
    for name, values in columns.items():
        known = [value for value in values if value is not None]
        if all(isinstance(value, int | float) for value in known):
            numbers[name] = np.array([np.nan if value is None else float(value) for value in values])
        elif (days := _days(values)) is not None:
            numbers[f"{name} [days]"] = days
    return numbers


def _days(values: Sequence[Any]) -> Array | None:
    """Days since the first of some dates; None where a value is none."""
    dates = dates_of(values)
    if dates is None:
        return None
    first = min(date for date in dates if date is not None)
    return np.array([np.nan if date is None else (date - first).total_seconds() / 86400 for date in dates])


def groups(columns: Mapping[str, Sequence[Any]], devices: int) -> dict[str, dict[str, NDArray[np.bool_]]]:
    """Which devices are in each group of a column of words; of columns that sort them into a few."""
    groups = {}
    numbers = {name.removesuffix(" [days]") for name in numeric(columns)}
    for name, values in columns.items():
        words = sorted({str(value) for value in values if value is not None})
        if name not in numbers and 1 < len(words) <= min(12, devices / 3):
            groups[name] = {word: np.array([str(value) == word for value in values]) for word in words}
    return groups


def differences(quantities: Sequence[Quantity], columns: Mapping[str, Sequence[Any]], devices: int) -> list[Difference]:
    """Each quantity by each column that sorts the devices into groups, the most certain first."""
    pairs = []
    for quantity in quantities:
        for name, members in groups(columns, devices).items():
            inside = {word: quantity.values[quantity.usable & group] for word, group in members.items()}
            inside = {word: values for word, values in inside.items() if values.size >= 3}
            if len(inside) > 1 and np.ptp(np.concatenate([*inside.values()])) > 0:
                pairs.append((quantity, name, inside))
    made = (_difference(*pair, len(pairs)) for pair in pairs)
    return sorted((item for item in made if item), key=lambda item: (item.chance, -item.distance))


def _difference(quantity: Quantity, column: str, inside: Mapping[str, Array], pairs: int) -> Difference | None:
    from scipy.stats import kruskal

    size = spread(np.concatenate([values - np.median(values) for values in inside.values()]))
    if not size > 0:
        return None
    medians = {word: float(np.median(values)) for word, values in inside.items()}
    furthest = max(medians, key=lambda word: abs(medians[word] - quantity.median) * np.sqrt(inside[word].size))
    distance = abs(medians[furthest] - quantity.median) / size
    chance = float(kruskal(*inside.values())[1]) * pairs
    return Difference(quantity.name, column, medians, quantity.median, furthest, distance, chance)


def out_of_line(
    devices: Sequence[str],
    quantities: Sequence[Quantity],
    known: Sequence[Trend],
    columns: Mapping[str, Sequence[Any]] | None = None,
) -> list[Finding]:
    """Devices further from the median than chance takes one of so many, the furthest first. Where a quantity
    depends strongly on a column, the median is that of devices with the same value in it."""
    findings, judged = [], [quantity for quantity in quantities if quantity.usable.sum() >= FEWEST]
    for quantity in judged:
        usual, size, beside = _usual(quantity, known, numeric(columns or {}))
        distance = np.divide(quantity.values - usual, size, out=np.zeros(usual.size), where=size > 0)
        limit = farthest(int(quantity.usable.sum()), len(judged))
        far = (distance > limit) & (quantity.values > WORSE * usual) if quantity.one_sided else np.abs(distance) > limit
        for place in np.flatnonzero(far & quantity.usable).tolist():
            value, level, spreads = (float(column[place]) for column in (quantity.values, usual, distance))
            sentence = sentence_of(quantity, value, level, spreads, beside[place])
            findings.append(Finding(devices[place], quantity.name, spreads, sentence, quantity.one_sided))
    return sorted(findings, key=lambda finding: -abs(finding.distance))


@cache
def farthest(devices: int, quantities: int) -> float:
    """How many spreads from the median one of so many devices is by CHANCE, in one of so many quantities, but FAR at
    least: few devices tell their spread badly. By Student's distribution of the degrees of freedom that a median
    absolute deviation has."""
    from scipy.stats import t

    return max(FAR, float(t.isf(CHANCE / (2 * devices * quantities), WORTH * (devices - 1))))


def _usual(quantity: Quantity, known: Sequence[Trend], columns: Mapping[str, Array]) -> tuple[Array, Array, list[str]]:
    """What is usual for each device, its spread, and the column that it depends on: of a device of which the column
    says nothing it is that of all."""
    usual, beside = np.full(quantity.values.size, quantity.median), np.zeros(quantity.values.size, bool)
    strong = (trend for trend in known if trend.quantity == quantity.name and trend.strong and trend.column in columns)
    if trend := next(strong, None):
        line = trend.at(columns[trend.column])
        beside = np.isfinite(line) & ((line > 0) | (not quantity.one_sided))
        usual[beside] = line[beside]
    least = max(quantity.own_error, LEAST * abs(quantity.median))
    near = max(spread((quantity.values - usual)[quantity.usable & beside]), least) if beside.any() else least
    size = np.where(beside, near, max(quantity.spread, least))
    return usual, size, [trend.column if trend and depends else "" for depends in beside]


def sentence_of(quantity: Quantity, value: float, usual: float, distance: float, beside: str) -> str:
    """Why a device is out of line."""
    if quantity.one_sided:
        return f"{quantity.name} {in_words(value, quantity.unit)}, {number(value / usual, 2)} times the usual"
    where = "above" if distance > 0 else "below"
    at = f" at its {beside.partition(' [')[0]}" if beside else ""
    shown, expected = (f"{text}\u00a0{unit(quantity.unit)}".rstrip() for text in alike([value, usual]))
    return f"{quantity.name} {shown}, usual{at} {expected}: {number(abs(distance), 2)} spreads {where}"
