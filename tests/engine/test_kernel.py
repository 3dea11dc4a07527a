"""What every block's C function is given: scratch on a cache line, and where the runs of a drive end."""

import numpy as np
import pytest

from pzt_ident.engine import kernel


@pytest.mark.parametrize("shape", [(1,), (3, 5, kernel.WIDTH), (0, 4)])
def test_scratch_begins_on_a_cache_line(shape):
    scratch = kernel.aligned_zeros(*shape)
    assert scratch.shape == shape
    assert not scratch.any()
    assert scratch.size == 0 or scratch.ctypes.data % 64 == 0


def test_runs_end_where_the_drive_turns_or_its_step_changes():
    from pzt_ident.engine.kernel import UNROLL, runs_of

    ramp = np.arange(40.0)
    drive = np.concatenate([[0.0, 0.3], 0.3 + ramp[1:], 39.3 - 2 * ramp[1:], [-40.0, -39.0, -40.5]])
    runs = runs_of(drive)
    up = slice(2, 2 + 39 - 2 * UNROLL)
    assert set(runs[up]) == {41.0}
    assert set(runs[41 : 80 - 2 * UNROLL]) == {80.0}
    assert (np.abs(runs) > np.arange(drive.size)).all()
    assert runs[-1] == -drive.size
    for first, end in enumerate(np.abs(runs).astype(int)):
        steps = np.diff(drive[max(first - 1, 0) : end])
        assert (steps >= 0).all() or (steps <= 0).all()
        if runs[first] > 0:
            assert np.ptp(np.abs(steps)) <= 1e-9
