"""What the page holds of the signals, read back as its scripts read them."""

import base64
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pzt_ident.report.traces import packed
from pzt_ident.run.results import Trace


def made(samples, seed=0, settle=0.0, size=1.0):
    rng = np.random.default_rng(seed)
    time = np.arange(samples) / 500
    drive = 60 * np.sin(2 * np.pi * time)
    response = 0.1 * drive + 0.02 * rng.normal(size=samples)
    residual = size * 0.05 * np.cos(7 * time) + 0.02 * rng.normal(size=samples)
    return Trace("r", "identify", "x", time, drive, response, response + residual, residual, "V", "um", settle)


def numbers(kind, text):
    return np.frombuffer(zlib.decompress(base64.b64decode(text)), kind).astype(float)


def values(item):
    return item["low"] + item["step"] * numbers("<u2", item["data"])


def kept(item):
    return np.arange(item["samples"]) if item["kept"] is None else np.cumsum(numbers("<u2", item["kept"])).astype(int)


def test_a_short_record_is_kept_whole_to_16_bits():
    trace = made(900)
    (item,) = packed({"model": [trace]}, 7000)
    assert item["kept"] is None
    for name in ("drive", "response"):
        own = getattr(trace, name)
        np.testing.assert_allclose(values(item[name]), own, atol=0.51 * np.ptp(own) / 65535)
    assert (item["unit"], item["driveUnit"], item["samples"]) == ("µm", "V", 900)
    assert item["dt"] == pytest.approx(1 / 500)


@settings(deadline=None, max_examples=15)
@given(st.integers(2000, 30000), st.integers(0, 5), st.sampled_from([0.0, 1.3]))
def test_a_thinned_record_keeps_extremes_and_the_squared_error(samples, seed, settle):
    trace = made(samples, seed, settle)
    (item,) = packed({"model": [trace]}, points=1500)
    places = kept(item)
    assert places.size < 1.5 * 1500 and (np.diff(places) > 0).all()
    assert places[0] == 0 and places[-1] == samples - 1
    (model,) = item["models"]
    for own, found in ((trace.response, values(item["response"])), (trace.residual, values(model["residual"]))):
        assert found.max() == pytest.approx(own.max(), rel=1e-3) and found.min() == pytest.approx(own.min(), rel=1e-3)
    squares = (values(model["sizes"]) ** 2).sum() if model["sizes"] else (values(model["residual"]) ** 2).sum()
    assert squares == pytest.approx((trace.residual[trace.scored] ** 2).sum(), rel=1e-3)


def test_models_of_the_same_samples_share_them():
    first, second, other = made(3000), made(3000, size=3.0), made(3000, seed=9)
    items = packed({"improved": [first], "as given": [second], "else": [other]}, 7000)
    assert [[model["name"] for model in item["models"]] for item in items] == [["improved", "as given"], ["else"]]


def test_a_model_that_is_not_finite_does_not_break_the_page():
    trace = made(900)
    trace.residual[5:9] = np.nan, np.inf, -np.inf, 3.0
    (item,) = packed({"model": [trace]}, 7000)
    assert np.isfinite(values(item["models"][0]["residual"])).all()
