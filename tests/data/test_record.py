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
