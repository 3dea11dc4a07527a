"""Stretches cover what is marked, and rests what does not move."""

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pzt_ident.data.stretches import rests, stretches


@given(st.lists(st.booleans(), max_size=40))
def test_they_cover_what_is_marked_and_touch_nowhere(marks):
    parts = stretches(np.array(marks, dtype=bool))
    covered = [any(start <= place < stop for start, stop in parts) for place in range(len(marks))]
    assert covered == marks
    assert all(stop < start for (_, stop), (start, _) in pairwise(parts))


def test_a_rest_is_where_no_drive_moves():
    drives = np.array([[0, 0, 0, 1, 2, 2, 2, 2], [5, 5, 5, 5, 5, 5, 6, 6]], float)
    assert rests(drives) == [(0, 2), (4, 5), (6, 7)]
