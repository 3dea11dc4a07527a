from dataclasses import replace

import numpy as np

from pzt_ident.data.record import Record, drive_correlation


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


def test_drive_and_response_are_correlated_over_all_records_about_the_means_of_each():
    rng = np.random.default_rng(3)
    drives = [rng.normal(size=(2, count)) + 5 for count in (30, 50)]
    responses = [np.stack([2 * drive[0], -drive[1]]) + rng.normal(size=drive.shape) for drive in drives]
    both = zip(drives, responses, strict=True)
    records = [Record("r", "identify", 0.5, *each, axes=("x", "y"), drive_units=("V", "V")) for each in both]
    for axis in range(2):
        drive, response = (
            np.concatenate([rows[axis] - rows[axis].mean() for rows in table]) for table in (drives, responses)
        )
        assert np.isclose(drive_correlation(records, axis), np.corrcoef(drive, response)[0, 1])
    still = Record("r", "identify", 0.5, np.ones((1, 9)), np.arange(9.0)[None])
    assert drive_correlation([still], 0) == 0


def test_the_swing_of_a_response_and_of_what_is_scored_of_it():
    record = Record("r", "identify", 0.5, np.zeros((1, 4)), np.array([[9.0, 1, 2, 5]]), settle=1)
    assert (record.swings, record.scored_swings.tolist()) == ([8.0], [4.0])
