"""However a measurement is given, it is the same record, and in any unit the same physics."""

import numpy as np
import pandas as pd
import pytest

import pzt_ident as pzt

HEADERS = ["t [s]", "u [V]", "x [um]"]


def frame_of(t, u, y):
    return pd.DataFrame(dict(zip(HEADERS, (t, u, y), strict=True)))


def from_frame(t, u, y):
    return pzt.Record.from_frame(frame_of(t, u, y), time=HEADERS[0], drive=HEADERS[1], response=HEADERS[2])


def from_file(t, u, y, path):
    frame_of(t, u, y).to_csv(path, index=False)
    return pzt.Record.read(path, time="t", drive="u", response="x", name="train")


FORMS = {
    "lists": lambda t, u, y: pzt.Record(list(t), list(u), list(y)),
    "series": lambda t, u, y: pzt.Record(t, pd.Series(u, index=t), pd.Series(y)),
    "a column": lambda t, u, y: pzt.Record(t, u[:, None], y[:, None]),
    "a row": lambda t, u, y: pzt.Record(t, u[None], y[None]),
    "dict": lambda t, u, y: pzt.Record(t, {"x": u}, {"x": y}),
    "frame": from_frame,
    "time differences": lambda t, u, y: pzt.Record(pd.to_timedelta(t, unit="s"), u, y),
    "dates": lambda t, u, y: pzt.Record(pd.Timestamp(2024, 5, 1) + pd.to_timedelta(t, unit="s"), u, y),
}


@pytest.mark.parametrize("form", FORMS)
def test_all_forms_of_one_axis_give_one_fit(form, part, quick):
    assert str(quick(FORMS[form](*part))) == str(quick())


def test_a_file_gives_the_same_fit(part, quick, tmp_path):
    assert str(quick(from_file(*part, tmp_path / "loops.csv"))) == str(quick())


@pytest.mark.parametrize("shape", [np.array, lambda pair: np.array(pair).T])
def test_rows_and_columns_of_two_axes_are_a_dict(shape, part, quick):
    t, u, y = (column[:300] for column in part)
    by_name = pzt.Record(t, {"x": u, "y": u[::-1]}, {"x": y, "y": y})
    assert str(quick(pzt.Record(t, shape([u, u[::-1]]), shape([y, y])))) == str(quick(by_name))
    rate = pzt.Record("200 Hz", shape([u, u[::-1]]), shape([y, y]))
    assert rate.axes == ("x", "y") and rate.samples == t.size


@pytest.mark.parametrize(
    ("units", "scaled", "factors"),
    [
        ({"response": "nm"}, lambda t, u, y: (t, u, 1e3 * y), {"gain": 1e3}),
        ({"drive": "mV"}, lambda t, u, y: (t, 1e3 * u, y), {"gain": 1e-3, "beta": 1e-3, "gamma": 1e-3}),
        ({}, lambda t, u, y: (1 / (t[1] - t[0]), u, y), {}),
        ({}, lambda t, u, y: ("0.2 kHz", u, y), {}),
        ({}, lambda t, u, y: (t + 17, u, y), {}),
    ],
)
def test_physics_is_the_same_in_any_unit(units, scaled, factors, part, quick):
    plain, other = quick(), quick(*scaled(*part), **units)
    scale = 1e3 if "response" in units else 1
    assert other.rmse["identify"] == pytest.approx(scale * plain.rmse["identify"], rel=1e-6)
    assert other.noise_floor["x"] == pytest.approx(scale * plain.noise_floor["x"], rel=1e-6)
    for name, item in plain.parameters.items():
        expected = item.value * factors.get(name.split(".")[1], 1)
        assert other.parameters[name].value == pytest.approx(expected, rel=1e-4)
        assert other.parameters[name].verdict == item.verdict


def test_records_in_different_units_are_fitted_together(part, quick):
    t, u, y = part
    other = pzt.Record(t, 1e3 * u, 1e3 * y, drive="mV", response="nm")
    fit = pzt.identify("bouc_wen", pzt.Record(t, u, y), validate=other, evaluations=300)
    np.testing.assert_allclose(fit.residuals["train"], fit.residuals["test"], rtol=0, atol=1e-9)


def test_a_column_of_a_frame_is_in_the_unit_of_its_own_header(part):
    t, u, y = part
    frame = pd.DataFrame({"clock [ms]": 1e3 * t, "u [mV]": 1e3 * u, "x [nm]": 1e3 * y})
    record = pzt.Record.from_frame(frame, time="clock [ms]", drive="u [mV]", response="x [nm]")
    np.testing.assert_allclose(record.stamps, t, rtol=1e-12)
    assert (record.drive, record.response) == ({"x": "mV"}, {"x": "nm"})


def test_a_record_read_from_a_file_is_called_as_it_is_told_or_like_its_file(part, tmp_path):
    path = tmp_path / "loops.csv"
    frame_of(*part).to_csv(path, index=False)
    names = [pzt.Record.read(path, time="t", drive="u", response="x", **name).name for name in ({}, {"name": "slow"})]
    assert names == ["loops", "slow"]


def test_records_without_a_name_are_called_by_their_use(part, quick):
    record = pzt.Record(*part)
    named = pzt.Record(*part, name="train_1")
    fit = pzt.identify("bouc_wen", [record, named, record], validate=record, evaluations=100)
    assert [*fit.residuals] == ["train_2", "train_1", "train_3", "test"]
    assert [*quick(record).residuals] == ["train"]
    assert record.name == ""


def test_a_record_says_what_it_holds(part):
    t, u, y = part
    assert repr(pzt.Record(t, u, y, name="slow")) == "Record 'slow': 700 samples in 3.5 s (200 Hz); x: V -> um"
    assert "in 3500 s (0.2 Hz)" in repr(pzt.Record(1e3 * t, u, y))
    assert "y: V (not measured)" in repr(pzt.Record(t, {"x": u, "y": u}, {"x": y}))


def test_what_is_masked_is_a_gap(part, quick):
    t, u, y = part
    with pytest.raises(pzt.InputError, match="y: axis x: 1 value is missing: row 5"):
        quick(t, u, np.ma.masked_array(y, np.arange(t.size) == 5))


class TestArraysOfOthers:
    """What a lab has in its hands: buffers that are filled again, frames, masks and dates."""

    T = np.arange(300) * 1e-2
    U = 50 - 50 * np.cos(T)

    def test_a_buffer_that_is_filled_again_changes_no_record(self):
        t, u, y = self.T.copy(), self.U.copy(), 0.1 * self.U
        record = pzt.Record(t, u, y)
        t[:], u[:], y[:] = 0, 0, 0
        assert np.array_equal(record.t, self.T) and np.array_equal(record.u["x"], self.U) and record.y["x"].any()

    def test_series_of_other_indices_are_refused(self):
        u, y = pd.Series(self.U, index=self.T), pd.Series(0.1 * self.U, index=self.T)
        for same in (y, y.reset_index(drop=True), y.to_numpy()):
            assert pzt.Record("100 Hz", u, same).samples == 300
        for other in (y.sample(frac=1, random_state=1), y.rename(lambda second: second + 0.1)):
            with pytest.raises(pzt.InputError, match="different indices"):
                pzt.Record("100 Hz", u, other)
            with pytest.raises(pzt.InputError, match="different indices"):
                pzt.Record("100 Hz", {"x": u}, {"x": other})

    def test_a_time_that_is_masked_is_a_gap(self):
        masked = np.ma.masked_array(self.T, mask=np.arange(300) == 5)
        with pytest.raises(pzt.InputError):
            pzt.identify(pzt.Model("bouc_wen"), pzt.Record(masked, self.U, 0.1 * self.U))

    @pytest.mark.parametrize("zone", [None, "Europe/Berlin"])
    def test_dates_are_stamps_however_they_are_held(self, zone):
        dates = pd.date_range("2026-03-01 10:00", periods=300, freq="10ms", tz=zone)
        frame = pd.DataFrame({"time": dates, "u [V]": self.U, "x [um]": 0.1 * self.U})
        records = [
            pzt.Record(held, self.U, 0.1 * self.U)
            for held in (dates, pd.Series(dates), list(dates), dates.to_pydatetime())
        ]
        records.append(pzt.Record.from_frame(frame, time="time", drive="u [V]", response="x [um]"))
        for record in records:
            assert np.allclose(record.t, self.T, atol=1e-6)

    def test_true_and_false_are_no_drive(self):
        with pytest.raises(pzt.InputError, match="no number"):
            pzt.Record("100 Hz", self.U > 50, 0.1 * self.U)
