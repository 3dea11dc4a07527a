"""No fault is told where there is none, whatever the drive, the noise, the counts and what the stage does."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from data.faults.motions import DT, MOTIONS, followed
from pzt_ident.data.faults import fault_phrases


def lagging(drive, seconds=0.03):
    from scipy.signal import lfilter

    share = np.exp(-DT / seconds)
    return 1e-7 * lfilter([1 - share], [1, -share], drive - drive[0]) + 1e-7 * drive[0]


LAWS = {
    "gain": lambda drive: 1e-7 * drive,
    "lag": lagging,
    "play": lambda drive: 1e-7 * np.array([*played(drive, 3.0)]),
    "saturation": lambda drive: 2e-6 * np.tanh(drive / 20),
    "lead": lambda drive: 1e-7 * (drive + 0.02 * np.gradient(drive, DT)),
}


def played(drive, width):
    state = drive[0]
    for value in drive:
        state = min(max(state, value - width), value + width)
        yield state


@settings(max_examples=120, deadline=None)
@given(
    kind=st.sampled_from([*MOTIONS]),
    law=st.sampled_from([*LAWS]),
    seed=st.integers(0, 10**6),
    noise=st.sampled_from([1e-9, 1e-8, 5e-8]),
    step=st.sampled_from([0.0, 2e-9, 5e-8]),
)
def test_a_sound_measurement_has_none(kind, law, seed, noise, step):
    assert not fault_phrases(followed(MOTIONS[kind], seed, noise, step, LAWS[law]))
