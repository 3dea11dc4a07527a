"""The figures of a lot can be read, however close its values are."""

from itertools import pairwise

import numpy as np
import pytest

from lot.test_table import row_of
from pzt_ident.lot.figures import plates
from pzt_ident.lot.outcome import Lot
from pzt_ident.report.figures import drawn
from pzt_ident.report.style import COLUMN, PAGE


@pytest.mark.parametrize("width", [COLUMN, PAGE])
@pytest.mark.parametrize("size", [1e-5, 0.004, 1.0, 50.0, 12345.0, 3e7])
@pytest.mark.parametrize("span", [1.0, 1e-2, 1e-3, 1e-4, 1e-6])
def test_labels_of_ticks_stand_apart_and_differ(tmp_path, width, size, span):
    errors = {"sha256": "", "rmse": {"identify": 0.1, "validate": None}}
    rows = [row_of(f"d{place}") | errors for place in range(20)]
    for row, place in zip(rows, np.random.default_rng(0).uniform(-0.5, 0.5, 20), strict=True):
        ends = dict.fromkeys(("value", "low", "high"), size * (1 + span * place))
        row["parameters"] = {"gain": row["parameters"]["gain"] | ends}
    plate = next(plates(Lot(tmp_path, {"improve": False}, rows)))
    figure = drawn(plate, width)
    axis, (low, high) = figure.axes[0].xaxis, figure.axes[0].get_xlim()
    labels = [label for label in axis.get_ticklabels() if low <= label.get_position()[0] <= high]
    boxes = sorted((label.get_window_extent() for label in labels), key=lambda box: box.x0)
    assert labels and all(left.x1 + 1 < right.x0 for left, right in pairwise(boxes))
    assert len({label.get_text() for label in labels}) == len(labels)


def test_a_device_far_off_hides_none_of_the_others(tmp_path):
    """One reads nm under a heading of um: it is an arrow at the rim, and in the outer bar for who clicks on that."""
    errors = {"sha256": "", "rmse": {"identify": 0.1, "validate": None}}
    rows = [row_of(f"d{place}") | errors for place in range(40)]
    values = [*np.random.default_rng(0).normal(0.08, 0.002, 39), 80.0]
    for row, value in zip(rows, values, strict=True):
        ends = dict.fromkeys(("value", "low", "high"), value)
        row["parameters"] = {"gain": row["parameters"]["gain"] | ends}
    plate = next(plates(Lot(tmp_path, {"improve": False}, rows)))
    axes = drawn(plate, PAGE).axes[0]
    assert axes.get_xlim()[1] < 0.2 and max(bar.get_height() for bar in axes.patches if bar.get_width() < 0.01) < 20
    assert [line.get_marker() for line in axes.lines if line.get_marker() == ">" and len(line.get_xdata())] == [">"]
    told = [part for name, part in plate.parts.items() if name.startswith("bar-0-")]
    assert sum(int(part["data-count"]) for part in told) == 40
    for value in values:
        assert sum(float(part["data-low"]) <= value < float(part["data-below"]) for part in told) == 1
