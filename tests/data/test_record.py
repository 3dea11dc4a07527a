from dataclasses import replace

import numpy as np

from pzt_ident.data.record import Record


def test_time_and_measured_axes():
    record = Record(
        name="r",
        use="identify",
        dt=0.5,
        drive=np.zeros((2, 3)),
        response=np.array([[1.0, 2, 3], [np.nan] * 3]),
        start=10.0,
        axes=("x", "y"),
        drive_units=("V", "V"),
        response_units=("um", None),
    )
    assert record.samples == 3
    assert record.measured == (0,)
    np.testing.assert_array_equal(record.time, [10.0, 10.5, 11.0])


def test_a_record_from_rest_has_a_sample_ahead_on_every_axis():
    drive = np.array([[1.0, 2, 3], [4.0, 5, 6]])
    record = Record("r", "identify", 0.5, drive, drive, axes=("x", "y"), drive_units=("V", "V"))
    assert (record.ahead, record.levels) == (0, [1.0, 4.0])
    stepped = replace(record, rest_at=(7.0, None))
    assert (stepped.ahead, stepped.levels, stepped.samples) == (1, [7.0, 4.0], 3)
