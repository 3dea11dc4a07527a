"""The public measurements, read with nothing but what a job file can say; numbers from the README of each set."""

import os
from pathlib import Path

import numpy as np
import pytest

from pzt_ident.data.readers import read_records
from pzt_ident.data.record import Axis, Channel, Source

DATA = Path(os.environ.get("PZT_IDENT_DATA", ""))
pytestmark = pytest.mark.skipif("PZT_IDENT_DATA" not in os.environ, reason="PZT_IDENT_DATA is not set")


def records(sources, drive, response, time=None, folder="."):
    channels = [Channel(item) if isinstance(item, str) else item for item in (drive, response)]
    clock = Channel(time) if isinstance(time, str) else time
    return read_records(sources, {"x": Axis(*channels)}, clock, DATA / folder)


def span(values):
    return np.min(values), np.max(values)


def test_picma_stack():
    sources = [
        Source("Model_Vi_Do.dat", sample_rate=200.0),
        Source("Test_Vi_Do_Di.dat", use="validate", sample_rate=200.0, rows=(0, 5070)),
        Source("Test_Vi_Do_Di.dat", use="validate", sample_rate=200.0, rows=(3880, 5070), time=(1.0, None)),
    ]
    drive, response = Channel(column=1, unit="V"), Channel(column=5, unit="um")
    model, test, hold = records(sources, drive, response, folder="picma_stack_minor_loops")
    assert (model.samples, model.dt, test.samples) == (8027, 0.005, 5070)
    assert span(model.drive) == (0, 3.6)
    assert np.ptp(model.response[:, 1000:]) == pytest.approx(45.1e-6, abs=0.9e-6)
    assert np.std(hold.response) == pytest.approx(0.065e-6, abs=0.03e-6)


def test_piezo_bender():
    drive, response = Channel(column=4, unit="V"), Channel(column=3, unit="um")
    source = Source("hysteresis_v_150_1hz.csv")
    (record,) = records([source], drive, response, Channel(column=2, unit="s"), "piezo_bender_1hz")
    assert record.samples == 50001
    assert record.dt == pytest.approx(2e-4)
    assert span(record.drive) == pytest.approx((-150, 150), abs=1e-3)
    rest = record.response[0, record.time < 3.25]
    assert (rest.mean(), rest.std()) == pytest.approx((-1.68e-6, 0.049e-6), rel=0.01)
    assert np.ptp(record.response[0, 35000:45000]) == pytest.approx(39.3e-6, abs=0.3e-6)


def test_bouc_wen_benchmark():
    sources = [
        Source("train.h5", dataset="multisine"),
        Source("test.h5", use="validate", dataset="multisine"),
        Source("test.h5", use="validate", dataset="sinesweep"),
    ]
    drive, response, rate = (Channel(name, unit=unit) for name, unit in (("u", "N"), ("y", "m"), ("fs", "Hz")))
    train, test, sweep = records(sources, drive, response, rate, "boucwen_benchmark")
    assert [record.samples for record in (train, test, sweep)] == [40960, 8192, 153000]
    assert {record.dt for record in (train, test, sweep)} == {1 / 750}
    assert np.sqrt(np.mean(test.drive**2)) == pytest.approx(50, rel=0.01)
    assert span(sweep.drive) == pytest.approx((-40, 40), abs=0.01)


@pytest.mark.parametrize(("level", "gain", "rms"), [(100, -2.69, 1.4), (200, -2.74, 2.7), (300, -2.83, 4.0)])
def test_steering_mirror(level, gain, rms):
    sources = [
        Source(
            f"u_{level}mV_train.npy",
            sample_rate=6400.0,
            index=(":", ":", realisation, 1),
            channels={"response": Channel(file=f"y_{level}mV_train.npy")},
        )
        for realisation in range(3)
    ]
    axes = {axis: Axis(Channel(column=k, unit="V"), Channel(column=k, unit="m")) for k, axis in enumerate("xyz", 1)}
    loaded = read_records(sources, axes, None, DATA / "fsm_piezo_mimo")
    assert {record.drive.shape for record in loaded} == {(3, 8192)}
    drives, responses = (np.fft.rfft([getattr(r, name) for r in loaded]) for name in ("drive", "response"))
    lines = range(20, 200)
    gains = [np.linalg.solve(drives[:, :, k], responses[:, :, k]).T for k in lines]
    assert 1e6 * np.mean(gains, axis=0)[0, 0].real == pytest.approx(gain, abs=0.03)
    assert 1e6 * np.sqrt(np.mean([record.response**2 for record in loaded])) == pytest.approx(rms, abs=0.1)


SLOW = {1: (16.9, -20.6), 2: (24.4, -26.2), 3: (2.2, -2.2), 4: (3.8, -3.6), 5: (7.1, -6.6), 6: (12.5, -13.3)}
STRAIN = {1: 1646, 2: 1870, 3: 628, 4: 734, 5: 916, 6: 1045}


def test_pnzt_loops():
    sources = [Source("RMN_TRAP_SLOW.dat", table=k) for k in range(1, 11)]
    charge = records(sources, "V+ [V]", "P1 [uC/cm2]", "Time [s]", "pnzt_butterfly_creep")
    strain = records(sources, "V+", "D1", "Time", "pnzt_butterfly_creep")
    assert {record.samples for record in charge} == {401}
    assert [record.dt for record in charge] == pytest.approx([0.025, 0.25, *[0.0025] * 8])
    for table, (top, bottom) in SLOW.items():
        assert span(100 * charge[table - 1].response) == pytest.approx((bottom, top), abs=0.05)
        assert 1e9 * np.ptp(strain[table - 1].response) == pytest.approx(STRAIN[table], abs=1)


def test_pnzt_hold_steps():
    sources = [Source("RMN_TRAP_1400V_1000V_CREEP.dat", table=k) for k in (1, 2, 3, "CREEP_1400V_1000V_1400S")]
    loaded = records(sources, "V+ [V]", "P1 [uC/cm2]", "Time [s]", "pnzt_butterfly_creep")
    assert {record.samples for record in loaded} == {5000}
    assert [1e3 * record.dt for record in loaded] == pytest.approx([13.6, 13.6, 21, 280], rel=1e-3)
    assert 100 * loaded[3].response.min() == pytest.approx(-420, abs=5)


def test_pnzt_matlab_files():
    steps = [
        (f"V_S1_{amplitude}V_05Hz", f"D1_S1_{amplitude}V_05Hz", amplitude) for amplitude in (1300, 1400, 1500, 1600)
    ]
    sources = [
        Source("CDC2019_Serie1.mat", sample_rate=200.0, channels={"drive": Channel(v), "response": Channel(d)})
        for v, d, _ in steps
    ]
    volt, nanometre = Channel("V", unit="V"), Channel("D", unit="nm")
    for record, (_, _, amplitude) in zip(
        records(sources, volt, nanometre, None, "pnzt_butterfly_creep"), steps, strict=True
    ):
        assert record.samples == 401
        assert np.ptp(record.drive) / 2 == pytest.approx(amplitude, rel=0.01)
    for step, amplitude in (("08", 800), ("1", 1000), ("11", 1100), ("15", 1500), ("19", 1900)):
        channels = Channel(f"Vplus_{step}kv", unit="V"), Channel(f"Displacement_{step}kv", unit="nm")
        source = Source("CDC2019_MeasurementData.mat", sample_rate=400.0)
        (record,) = records([source], *channels, None, "pnzt_butterfly_creep")
        assert record.samples == 401
        assert np.ptp(record.drive) / 2 == pytest.approx(amplitude, rel=0.05)
    channels = Channel("voltage", unit="V"), Channel("strain", unit="1")
    (record,) = records([Source("AnjaPlots_plot_data.mat", sample_rate=400.0)], *channels, None, "pnzt_butterfly_creep")
    assert record.samples == 1604


PERIODS = {"00400": 0.1, "00404": 0.5, "00406": 1, "00408": 2, "00410": 5, "00412": 10}


@pytest.mark.parametrize("number", PERIODS)
def test_pulse_pairs(number):
    sources = [Source(f"{number}_0{k}.txt") for k in range(5)]
    drive, response = Channel("Ch1", unit="20 V"), Channel("Ch2,V", unit="100 nC")
    loaded = records(sources, drive, response, "Time,s", "pzt_pe_loops_rate_temp/PZT4p1_2022_60V_120C")
    assert {record.samples for record in loaded} == {1000 * PERIODS[number]}
    assert [record.dt for record in loaded] == pytest.approx([1e-3] * 5)
    assert loaded[1].drive.max() == pytest.approx(60, abs=0.5)
    assert loaded[3].drive.min() == pytest.approx(-60, abs=0.5)


def test_every_pulse_file_is_readable():
    folder = "pzt_pe_loops_rate_temp"
    files = sorted((DATA / folder).glob("*/*.txt"))
    sources = [Source(str(file.relative_to(DATA / folder))) for file in files]
    loaded = records(sources, Channel("Ch1", unit="20 V"), Channel("Ch2", unit="100 nC"), "Time", folder)
    assert len(loaded) == 30 + 20 + 36
    amplitudes = {60: "PZT4p1", 90: "PMN20PT"}
    for amplitude, name in amplitudes.items():
        highest = max(np.abs(record.drive).max() for record in loaded if name in record.file)
        assert highest == pytest.approx(amplitude, rel=0.01)


@pytest.mark.parametrize(
    ("file", "samples", "amplitude"),
    [
        ("PZT19_2023/001.mat", 550, 453),
        ("PZT19_2023/002.mat", 10050, 453),
        ("PZT19_2023/003.mat", 2050, 453),
        ("PMN33PT_2023/001.mat", 20300, 115),
    ],
)
def test_loops_in_matlab_structs(file, samples, amplitude):
    halves = {
        half: Source(
            file,
            sample_rate=1000.0,
            dataset="Loops.feloop.init",
            channels={"drive": Channel(f"E.{half}"), "response": Channel(f"P.{half}")},
        )
        for half in "pn"
    }
    volt, coulomb = Channel("E.p", unit="V"), Channel("P.p", unit="C")
    loaded = records(halves.values(), volt, coulomb, None, "pzt_pe_loops_rate_temp")
    assert {record.samples for record in loaded} == {samples}
    lowest, highest = sorted(record.drive[0, np.abs(record.drive[0]).argmax()] for record in loaded)
    assert (lowest, highest) == pytest.approx((-amplitude, amplitude), rel=0.06)


def test_every_matlab_loop_is_readable():
    folder = "pzt_pe_loops_rate_temp"
    files = sorted((DATA / folder).glob("*/*.mat"))
    sources = [Source(str(f.relative_to(DATA / folder)), sample_rate=1000.0, dataset="Loops/feloop/ref") for f in files]
    assert len(records(sources, Channel("E/p", unit="V"), Channel("P/p", unit="C"), None, folder)) == 28


def test_thin_film_reversal_curves():
    sources = [
        Source("RTWhiteB_FORC/RTWhiteB 0Hz 5V 1Average Table1.tsv"),
        Source("RTWhiteA_FORC/RT WhiteA 0Hz 7V 1Average Table2.tsv"),
    ]
    b, a = records(sources, "Vplus V", "P1 uC_per_cm2", "Time s", "thinfilm_forc_rate")
    assert (b.samples, a.samples) == (10000, 10000)
    assert b.time[-1] == pytest.approx(1.35)
    assert (100 * b.response.min(), 100 * b.response[0, -1]) == pytest.approx((-176, -122), abs=0.5)
    assert b.drive.max() == pytest.approx(5, rel=0.01)
    assert a.drive.max() == pytest.approx(7, rel=0.01)


@pytest.mark.parametrize(
    ("pattern", "volt"),
    [
        ("RTWhiteB_freqs/RTWhiteB {}Hz 5V 1Average Table{}.tsv", 5),
        ("linear_cap_2p2nF_freqs/2.2nF discrete cap {}Hz 3V 1Average Table{}.tsv", 3),
    ],
)
def test_thin_film_and_capacitor_at_ten_frequencies(pattern, volt):
    sources = [Source(pattern.format(100 * k, k)) for k in range(1, 11)]
    loaded = records(sources, "Vplus", "P1", "Time", "thinfilm_forc_rate")
    assert {record.samples for record in loaded} == {401}
    assert [1 / (400 * record.dt) for record in loaded] == pytest.approx([100.0 * k for k in range(1, 11)], rel=1e-3)
    assert [record.drive.max() for record in loaded] == pytest.approx([volt] * 10, rel=0.03)


@pytest.mark.parametrize("table", [1, 2])
def test_pulse_train(table):
    """Five pulses side by side, each with its own four columns, the drive in every second one negative."""
    source = Source("RTWhiteA_PUND/RTWhiteAPUND.dat", table=table)
    for pulse in range(5):
        columns = (Channel(column=4 * pulse + k) for k in (2, 4))
        time = Channel(column=1) if pulse == 0 else None
        rated = Source(source.file, table=table, sample_rate=None if time else 40100.0)
        (record,) = records([rated], *columns, time, "thinfilm_forc_rate")
        assert record.samples == 401
        assert record.dt == pytest.approx(24.94e-6, rel=1e-3)
        assert np.abs(record.drive).max() == pytest.approx(8, rel=0.01)
