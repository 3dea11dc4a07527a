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
