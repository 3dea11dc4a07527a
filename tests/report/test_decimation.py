import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from pzt_ident.report.decimation import decimate, decimate_curve

NUMBER = st.floats(-1e6, 1e6) | st.just(np.nan)


@given(arrays(float, st.integers(2, 400), elements=NUMBER), st.integers(2, 40))
def test_decimation_keeps_extremes_ends_and_order(values, bins):
    kept = decimate(values, bins)
    assert kept.size <= max(2 * bins + 2, values.size if values.size <= 2 * bins else 0)
    assert (np.diff(kept) > 0).all()
    assert (kept[0], kept[-1]) == (0, values.size - 1)
    known = np.nan_to_num(values)
    assert known[kept].max() == known.max()
    assert known[kept].min() == known.min()


def test_points_along_a_loop_are_even_and_reach_its_turns():
    time = np.linspace(0, 20, 20_001)
    drive, response = np.sin(2 * np.pi * time), np.sin(2 * np.pi * time - 0.3)
    shown = decimate_curve(drive, response, 900)
    assert shown.size < 1400
    assert np.hypot(np.diff(drive[shown]), np.diff(response[shown])).max() < 0.15
    assert (drive[shown].min(), drive[shown].max()) == (drive.min(), drive.max())
    assert np.count_nonzero(drive[shown] > 0.9999) >= 20
