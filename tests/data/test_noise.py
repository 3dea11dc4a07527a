"""The noise floor against noise that was put in."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter

import rig
from noises import record, rising, white
from pzt_ident.data.evidence import still_rests
from pzt_ident.data.noise import error_scales, noise_floor, pooled_floor, units_and_floors

SIGMA = 30e-9


@pytest.fixture
def noise():
    return np.random.default_rng(11).normal(0, SIGMA, 6000)


def test_rest_segments_give_the_noise_despite_creep(noise):
    drive = np.concatenate([np.linspace(0, 100, 3000), np.full(3000, 100.0)])
    creep = 1e-6 * np.log1p(np.maximum(np.arange(6000) - 3000, 0) / 100)
    floor = noise_floor([record(drive, 1e-7 * drive + creep + noise)], 0)
    assert floor.source == "rest segments"
    assert floor.value == pytest.approx(SIGMA, rel=0.1)


def test_repeated_periods_give_the_noise_despite_drift(noise):
    t = np.arange(6000)
    drive = 50 * (1 - np.cos(2 * np.pi * t / 1000))
    floor = noise_floor([record(drive, 1e-7 * drive + 3e-11 * t + noise)], 0)
    assert floor.source == "repeated periods"
    assert floor.value == pytest.approx(SIGMA, rel=0.1)


def test_without_rest_or_repeats_the_evidence_is_weak(noise):
    t = np.arange(6000)
    drive = 50 * (1 - np.cos(2 * np.pi * (t / 1000) ** 1.3))
    floor = noise_floor([record(drive, 1e-7 * drive + noise)], 0)
    assert "weak" in floor.source
    assert floor.value == pytest.approx(SIGMA, rel=0.2)


@pytest.mark.parametrize(("begun", "source"), [(0.0, "two periods"), (1e-4, "short windows (weak)")])
def test_two_periods_give_the_noise_unless_the_first_was_another(noise, begun, source):
    """Of a drive that is full up to half the sample rate, whose response by many modes no window tells from noise."""
    rng = np.random.default_rng(4)
    drive, modes = rng.normal(size=3000), rng.normal(size=200)
    response = np.fft.irfft(np.fft.rfft(drive) * np.fft.rfft(modes, 3000))
    start = begun * np.exp(-np.arange(6000) / 300) * rng.normal(size=6000)
    floor = noise_floor([record(np.tile(drive, 2), 1e-8 * np.tile(response, 2) + noise + start)], 0)
    assert floor.source == source
    assert floor.value == pytest.approx(SIGMA, rel=0.1) or source != "two periods"


@pytest.mark.parametrize("dt", [1e-3, 1e-3 * (1 + 1e-12)])
def test_records_whose_clock_goes_on_are_measured_again(noise, dt):
    drive = np.random.default_rng(3).normal(size=3000)
    first, again = (record(drive, 1e-7 * drive + part) for part in (noise[:3000], noise[3000:]))
    floor = noise_floor([dataclasses.replace(first, dt=1e-3), dataclasses.replace(again, dt=dt)], 0)
    assert floor.source == "repeated records"


def test_records_measured_again_give_the_noise_of_any_signal(noise):
    """Wide-band signals have neither rest nor a smooth course; a settled offset between both counts for nothing."""
    rng = np.random.default_rng(3)
    drive = rng.normal(size=3000)
    again = [record(drive, 1e-7 * drive + part) for part in (noise[:3000], 1e-6 + noise[3000:])]
    floor = noise_floor([*again, record(rng.normal(size=3000), noise[:3000] * 7)], 0)
    assert floor.source == "repeated records"
    assert floor.value == pytest.approx(SIGMA, rel=0.1)
    assert "weak" in noise_floor(again[:1], 0).source
    assert "weak" in noise_floor([again[0], again[0]], 0).source  # listed twice, measured once


def test_never_below_the_quantiser():
    t = np.arange(6000)
    drive = 50 * (1 - np.cos(2 * np.pi * t / 1000))
    response = 1e-7 * np.round(drive * 1e-7 / 1e-7)
    floor = noise_floor([record(drive, response)], 0)
    assert floor.source == "quantiser"
    assert floor.value == pytest.approx(1e-7 / np.sqrt(12), rel=1e-6)


@pytest.mark.parametrize("cycles", [6.3, 10.6, 50.2])
def test_rest_segments_give_the_noise_despite_hum_far_above_it(cycles):
    t = np.arange(2000.0) / 2000
    hum = 20 * np.sin(2 * np.pi * cycles * t + 1)
    (rest,) = still_rests(np.zeros((1, 2000)), hum + np.random.default_rng(3).normal(size=2000))
    assert rest.estimate().value == pytest.approx(1, rel=0.1)


def test_responses_of_different_kinds_are_weighed_by_their_noise(noise):
    drive = np.sin(2 * np.pi * np.arange(noise.size) / 500)
    both = [1e-7 * drive + noise, 1e-2 * drive + 3e4 * noise]
    lengths = record([drive, drive], both, axes=("x", "y"), drive_units=("V", "V"), response_units=("um", "nm"))
    assert error_scales([lengths]).tolist() == [1, 1]
    mixed = dataclasses.replace(lengths, response_units=("um", "uC/cm2"))
    assert error_scales([mixed]) == pytest.approx(noise.std() * np.array([1, 3e4]), rel=0.1)
    smooth = dataclasses.replace(
        mixed, response=mixed.response + np.array([[0], [1]]) * (1e-2 * drive - mixed.response)
    )
    assert error_scales([smooth])[1] == pytest.approx(5e-3 * 2e-2, rel=1e-3)


def test_floors_are_in_the_unit_of_their_axis_and_over_all_axes_in_that_of_the_first(noise):
    drive = np.sin(2 * np.pi * np.arange(noise.size) / 500)
    units = {"axes": ("x", "y"), "drive_units": ("V", "V"), "response_units": ("um", "nm")}
    lengths = [record([drive, drive], [1e-7 * drive + noise, 1e-7 * drive + 3 * noise], **units)]
    found = units_and_floors(lengths)
    x, y = (noise_floor(lengths, axis).value for axis in (0, 1))
    assert (found["unit"], found["units"]) == ("um", {"x": "um", "y": "nm"})
    assert found["noise_floor"] == pytest.approx({"x": x / 1e-6, "y": y / 1e-9})
    assert found["noise_floor_source"] == dict.fromkeys("xy", "repeated periods")
    assert found["floor"] == pytest.approx(np.hypot(x, y) / np.sqrt(2) / 1e-6)


def test_rest_is_better_evidence_than_repeated_periods():
    drive = np.tile(np.concatenate([rising(300, 300), rising(300, 300)[::-1]]), 5)
    assert noise_floor([record(drive, drive + white(drive.size))], 0).source == "rest segments"
    moving = np.tile(np.concatenate([rising(300), rising(300)[::-1]]), 5)
    assert noise_floor([record(moving, moving + white(moving.size))], 0).source == "repeated periods"


def test_what_is_not_scored_is_no_evidence():
    drive = np.concatenate([np.zeros(1000), rising(1000, 2000)])
    loud = np.where(np.arange(drive.size) < 1000, 100, 1)
    assert noise_floor([record(drive, loud * white(4000), settle=1000)], 0).value == pytest.approx(1, rel=0.1)
    drive = white(4000, seed=1)
    again = [record(drive, loud * white(4000, seed=seed), settle=settle) for seed, settle in ((2, 0), (3, 1000))]
    assert noise_floor(again, 0).value == pytest.approx(1, rel=0.1)
    assert noise_floor(again[::-1], 0).value == pytest.approx(1, rel=0.1)


def test_rests_count_by_how_long_they_last():
    """10 s of 1 and 4 s of 1.2: the mean square is (10 + 4 * 1.44) / 14, whatever the samples are."""
    long = dataclasses.replace(record(rising(500, 1000), white(1500)), dt=1e-2)
    short = record(rising(500, 4000), white(4500, 1.2, seed=1))
    assert noise_floor([short, long], 0).value == pytest.approx(np.sqrt(15.76 / 14), rel=0.03)


RINGING = np.exp(-np.arange(4000) / 1500) * np.sin(np.arange(4000) / 3)  # a mode that rings through all of a rest


@pytest.mark.parametrize("louder", [1.4, 2.0, 5.0])
@pytest.mark.parametrize("rests", [5, 17])
def test_rests_that_are_louder_are_no_evidence_beside_the_one_before_the_first_step(rests, louder):
    """As where a stage rings after each of many steps."""
    drive = np.repeat(np.append(0.0, np.random.default_rng(rests).uniform(1, 100, rests)), 300)
    response = drive + white(drive.size) * np.repeat(np.append(1.0, louder * np.linspace(1, 2, rests)), 300)
    floor = noise_floor([record(drive, response)], 0)
    assert (floor.source, floor.value) == ("rest segments", pytest.approx(1, rel=0.1))


def test_a_reading_that_hung_for_a_moment_is_no_evidence():
    drive = np.repeat([0.0, 50.0, 10.0], [150, 3000, 3000])
    response = drive + white(drive.size) * np.repeat([0.1, 1.0, 1.0], [150, 3000, 3000])
    assert noise_floor([record(drive, response)], 0).value == pytest.approx(1, rel=0.05)


@pytest.mark.parametrize("rings", [(), (1,), (1, 3), (0, 1, 2)])
@pytest.mark.parametrize("size", [3, 1000])
def test_rests_that_ring_are_no_evidence_while_a_quarter_is_quiet(rings, size):
    records = [record((1 + n) * rising(500, 4000), white(4500, seed=n)) for n in range(4)]
    for n in rings:
        records[n].response[0, 500:] += size * RINGING
    floor = noise_floor(records, 0)
    assert (floor.source, floor.value) == ("rest segments", pytest.approx(1, rel=0.15))


@pytest.mark.parametrize("seed", (0, 20))
@pytest.mark.parametrize(("period", "growth", "size"), [(60, 1, 10), (60, 3, 100), (20, 5, 3)])
def test_rests_that_all_ring_are_no_evidence(period, growth, size, seed):
    """Slowly, or so unlike each other that the quiet quarter rings, too: up to 200,000 times the noise."""
    records = [record((1 + n) * rising(500, 4000), white(4500, seed=seed + n)) for n in range(8)]
    ringing = np.exp(-np.arange(4000) / 1500) * np.sin(2 * np.pi * np.arange(4000) / period)
    for n in range(8):
        records[n].response[0, 500:] += size * float(growth) ** n * ringing
    assert noise_floor(records, 0).value == pytest.approx(1, rel=0.2)


@pytest.mark.parametrize("decay", [30, 100, 400])
def test_a_rest_counts_from_where_it_has_settled(decay):
    response = white(4500)
    response[500:] += 50 * np.exp(-np.arange(4000) / decay) * np.sin(np.arange(4000) / 3)
    assert noise_floor([record(rising(500, 4000), response)], 0).value == pytest.approx(1, rel=0.1)


@given(
    change=st.floats(-0.3, 0.3),
    delay=st.floats(-2, 2),
    shape=st.sampled_from(["sine", "triangle"]),
    seed=st.integers(0, 99),
)
@settings(deadline=None, max_examples=20)
def test_a_gain_and_a_delay_that_change_over_repeated_periods_are_no_noise(change, delay, shape, seed):
    """By so much, and by so many samples, from the first period to the last."""
    t = np.arange(4800)
    later = t - delay * t / t.size
    phase, bent = t / 800 % 1, later / 800 % 1
    drive, moved = (
        50 - 50 * (np.cos(2 * np.pi * p) if shape == "sine" else 1 - 4 * np.minimum(p, 1 - p)) for p in (phase, bent)
    )
    response = (1 + change * t / t.size) * (moved + 2e-3 * moved**2) + white(4800, 0.5, seed)
    floor = noise_floor([record(drive, response)], 0)
    assert (floor.source, floor.value) == ("repeated periods", pytest.approx(0.5, rel=0.2))


@pytest.mark.parametrize(("period", "source"), [(600, "repeated"), (600.4, "weak"), (600.005, "repeated")])
def test_periods_of_no_whole_number_of_samples_are_no_repeats(period, source):
    """With 0.4 samples the response is off by 15 times the noise, root mean square; with 0.005 by a fifth of it."""
    drive = 50 - 50 * np.cos(2 * np.pi * np.arange(4000) / period)
    floor = noise_floor([record(drive, 1e3 * drive + white(4000, 10.0))], 0)
    assert source in floor.source
    assert floor.value == pytest.approx(10, rel=0.15)


def test_a_record_of_wide_band_says_nothing_of_the_noise_of_smooth_ones():
    drives = [50 - 50 * np.cos(2 * np.pi * (np.arange(4000) / 1000) ** power) for power in (1.2, 1.3)]
    records = [record(drive, drive + white(4000, seed=n)) for n, drive in enumerate((*drives, white(4000, 50)))]
    assert noise_floor(records, 0).value == pytest.approx(1, rel=0.1)


@pytest.mark.parametrize("memory", [0.0, 0.9])
@pytest.mark.parametrize("unscored_motion", [0, 200])
def test_a_rest_that_is_not_scored_says_more_than_windows_and_less_than_periods(memory, unscored_motion):
    """Noise behind a lag, which windows take for signal; the stage rests ahead of the scored samples."""
    sweep = 50 - 50 * np.cos(2 * np.pi * (np.arange(4000) / 1000) ** 1.2)
    noise = lfilter([(1 - memory**2) ** 0.5], [1, -memory], white(4600))
    ahead = [
        record(np.append(np.zeros(600), sweep), np.append(np.zeros(600), sweep) + noise, settle=600 + unscored_motion)
    ]
    floor = noise_floor(ahead, 0)
    assert (floor.source, floor.value) == ("rest segments that are not scored", pytest.approx(1, rel=0.15))
    periods = 50 - 50 * np.cos(2 * np.pi * np.arange(4000) / 800)
    louder = np.append(np.zeros(600), periods) + noise * np.repeat([1.0, 2.0], [600, 4000])
    again = noise_floor([record(np.append(np.zeros(600), periods), louder, settle=600)], 0)
    assert (again.source, again.value) == ("repeated periods", pytest.approx(2, rel=0.15))


@pytest.mark.parametrize("share", [0.0, 0.02, 30.0])
@pytest.mark.parametrize("hung", [300, 600])
def test_a_rest_before_a_recorder_began_or_a_stage_had_settled_is_no_evidence(share, hung):
    """Ahead of the scored samples the reading hangs, or has another noise, as where an amplifier is switched on."""
    sweep = 50 - 50 * np.cos(2 * np.pi * (np.arange(4000) / 1000) ** 1.2)
    ahead = record(np.append(np.zeros(600), sweep), np.append(np.zeros(600), sweep) + white(4600), settle=600)
    ahead.response[0, :hung] *= share
    ahead.response[0, hung:600] *= max(share, 1e-3)
    scored = record(sweep, ahead.response[0, 600:])
    assert noise_floor([ahead], 0) == pytest.approx(noise_floor([scored], 0))


def test_the_start_of_a_rest_is_left_to_settle():
    drive, settling = rising(500, 3000), 1000 * np.exp(-np.arange(3000) / 50)
    response = np.append(np.zeros(500), settling) + white(3500)
    assert noise_floor([record(drive, response)], 0).value == pytest.approx(1, rel=0.1)


@pytest.mark.parametrize(("samples", "rests"), [(29, 0), (30, 1)])
def test_a_rest_has_a_least_number_of_steps_after_its_first_fifth(samples, rests):
    drive = np.concatenate([rising(300), np.full(samples - 1, 100.0), 100 - rising(300)[1:]])
    assert len(still_rests(drive[None], white(drive.size))) == rests


def beginning_at_rest(still, records=9, hum=0.0, behind=0.0):
    """Records of white noise that rest ahead of a rise, for so many samples, and ring behind it. hum: its size;
    behind: how far the drive goes on behind the rise."""
    made = []
    for seed in range(records):
        drive = (1 + seed / 9) * np.concatenate([np.zeros(still), rising(400), 100 + np.linspace(0, behind, 300)])
        ringing = np.append(np.zeros(still + 400), 200 * np.exp(-np.arange(300) / 900) * np.sin(np.arange(300) / 2))
        tone = hum * np.sin(np.arange(drive.size) / 1.8 + seed)
        made.append(record(drive, drive + ringing + tone + white(drive.size, seed=seed)))
    return made


@pytest.mark.parametrize("behind", [0.0, 3.0])
def test_short_rests_count_together_whatever_is_behind(behind):
    """A long rest in which the stage rings, or none."""
    floor = noise_floor(beginning_at_rest(40, behind=behind), 0)
    assert (floor.source, floor.value) == ("rest segments", pytest.approx(1, rel=0.15))


@pytest.mark.parametrize("seed", range(5))
def test_short_rests_have_the_memory_of_the_long_ones(seed):
    """By themselves they showed less of it, were quieter and passed for the noise: 0.53 of it."""
    drive = np.concatenate([np.zeros(40), rising(300), np.full(60, 100.0), 100 - rising(300), np.zeros(330)])
    slow = [lfilter([np.sqrt(1 - 0.9**2)], [1, -0.9], white(drive.size, seed=10 * seed + part)) for part in range(5)]
    made = [record(drive * (1 + part / 9), drive + each) for part, each in enumerate(slow)]
    floor = noise_floor(made, 0)
    assert (floor.source, floor.value) == ("rest segments", pytest.approx(1, rel=0.2))


@pytest.mark.parametrize(("still", "records"), [(40, 3), (20, 20)])
def test_short_rests_are_no_evidence_below_a_hundred_samples(still, records):
    assert noise_floor(beginning_at_rest(still, records, behind=3.0), 0).source != "rest segments"


def test_a_hum_that_short_rests_do_not_tell_from_noise_is_told_in_windows():
    assert noise_floor(beginning_at_rest(60, hum=30.0, behind=3.0), 0).source != "rest segments"


@pytest.mark.parametrize(("first", "orders"), [(72.02, (1,)), (50.01, (1, 3, 5, 7))])
def test_a_hum_is_told_from_noise_in_the_records_that_hold_its_periods(first, orders):
    """Of several rates, without a rest: windows of the fast ones are shorter than a period, and the floor was 44 times
    the noise."""
    made = []
    for seed, (rate, samples) in enumerate([(400, 3700), (1000, 2300), (10000, 3100), (100, 3200), (10000, 4700)]):
        t = np.arange(samples) / rate
        drive = 100 * np.sin(2 * np.pi * rate / 900 * t) + 40 * np.sin(2 * np.pi * rate / 333 * t + seed)
        hum = sum(40 / order * np.sin(2 * np.pi * first * order * t + seed) for order in orders)
        made.append(dataclasses.replace(record(drive, drive + hum + white(samples, seed=seed)), dt=1 / rate))
    assert noise_floor(made, 0).value == pytest.approx(1, rel=0.3)


@pytest.mark.parametrize("value", [0.0, 1.23e3])
def test_a_short_rest_in_which_the_reading_hangs_is_no_evidence(value):
    made = beginning_at_rest(40)
    for one in made:
        one.response[:, :41] = value
    assert noise_floor(made, 0).value > 0.5


def test_records_measured_again_with_a_hum_give_the_noise():
    drive, t = white(3000, seed=9), np.arange(3000)
    again = [record(drive, drive + 15 * np.sin(t / 7 + phase) + white(3000, seed=phase)) for phase in (1, 3)]
    floor = noise_floor(again, 0)
    assert (floor.source, floor.value) == ("repeated records", pytest.approx(1, rel=0.1))


def test_a_rest_is_one_of_all_drives():
    still, moving = np.zeros(1000), white(1000, seed=1)
    assert len(still_rests(np.array([still, still]), white(1000))) == 1
    assert still_rests(np.array([still, moving]), white(1000)) == []


@pytest.mark.parametrize("gain", [0.0, 5e3])
def test_a_drive_that_rests_but_for_its_noise_rests(gain):
    """And what the stage follows of that noise is none of its reading."""
    noise = np.random.default_rng(8).normal(0, 1e-3, 2000)
    drive = np.concatenate([np.linspace(0, 50, 500), np.full(1000, 50.0), np.linspace(50, 0, 500)]) + noise
    found = still_rests(drive[None], white(2000) + gain * drive)
    longest = max(found, key=lambda rest: rest.noise.size)
    assert longest.noise.size > 400 and sum(rest.noise.size for rest in found) <= 800
    assert longest.estimate().value == pytest.approx(1, rel=0.1)


def test_records_are_measured_again_where_all_drives_and_the_sample_time_are_the_same():
    one, two, other = (white(1000, seed=seed) for seed in (1, 2, 3))
    more = {"axes": ("x", "y"), "drive_units": ("V", "V"), "response_units": ("m", None)}
    first = record([one, two], [white(1000), np.full(1000, np.nan)], **more)
    again = dataclasses.replace(first, response=first.response + 1e-3 * white(1000, seed=5))
    assert noise_floor([first, again], 0).source == "repeated records"
    for change in ({"dt": 2e-3}, {"drive": np.array([one, other])}, {"drive": np.array([other, two])}):
        assert "weak" in noise_floor([first, dataclasses.replace(again, **change)], 0).source


def test_a_knock_in_one_period_is_not_noise():
    drive = np.tile(np.concatenate([rising(300), rising(300)[::-1]]), 6)
    knock = 300 * ((np.arange(drive.size) > 1900) & (np.arange(drive.size) < 2100))
    assert noise_floor([record(drive, knock + white(drive.size))], 0).value == pytest.approx(1, rel=0.1)


def test_a_rest_that_is_quieter_than_the_quantiser_has_the_noise_of_the_quantiser():
    """One value in fifty is a step higher: 0.14 steps of scatter."""
    drive, step = rising(500, 3000), 1e-9
    flips = np.random.default_rng(2).random(3500) < 0.02
    floor = noise_floor([record(drive, step * flips)], 0)
    assert (floor.source, floor.value) == ("quantiser", pytest.approx(step / np.sqrt(12), rel=0.01))


@pytest.mark.parametrize("size", [0.15, 0.25, 0.5])
def test_rests_of_coarse_readings_give_the_noise_and_the_quantisers(size):
    heights = np.random.default_rng(3).uniform(50, 100, 30)
    drives = [np.concatenate([np.linspace(0, height, 300), np.full(400, height)]) for height in heights]
    records = [record(drive, np.round(drive + white(700, size, seed=n))) for n, drive in enumerate(drives)]
    assert noise_floor(records, 0).value == pytest.approx(np.sqrt(size**2 + 1 / 12), rel=0.1)


def test_the_finest_quantiser_of_several_records_counts():
    drive = np.tile(np.concatenate([rising(300), rising(300)[::-1]]), 4)
    steps = ((0.5, 1.0), (2.0, 0.7))
    records = [record(scale * drive, np.round(scale * drive / step) * step) for step, scale in steps]
    for ordered in (records, records[::-1]):
        assert noise_floor(ordered, 0).value == pytest.approx(0.5 / np.sqrt(12))


def test_the_widest_record_sets_the_least_size():
    drive = np.tile(np.concatenate([rising(300), rising(300)[::-1]]), 4)
    more = {"axes": ("x", "y"), "drive_units": ("V", "V"), "response_units": ("um", "uC/cm2")}
    records = [record([top * drive] * 2, [top * drive, 7 * top * drive], **more) for top in (1.0, 0.3)]
    for ordered in (records, records[::-1]):
        assert error_scales(ordered) == pytest.approx(5e-3 * 100 * np.array([1, 7]))


@pytest.mark.parametrize("samples", [200, 1000, 4321])
def test_a_rest_that_is_exactly_constant_has_no_noise(samples):
    """What rounding leaves of it is taken for no line."""
    levels = np.random.default_rng(3).uniform(-10, 10, 60)
    drive = np.concatenate([np.linspace(0, 1, 50), np.ones(samples)])[None]
    for level in levels:
        response = np.concatenate([np.linspace(0, level, 50), np.full(samples, level)])
        assert all(rest.estimate().value <= 1e-12 * abs(level) for rest in still_rests(drive, response))


def test_the_noise_of_an_axis_is_estimated_once_for_a_result(monkeypatch):
    drive = np.sin(0.01 * np.arange(4000))
    records = [rig.record(drive, drive, response=drive + white((2, drive.size)))]
    floor, asked = pooled_floor(records), []
    monkeypatch.setattr(
        "pzt_ident.data.noise.noise_floor", lambda records, axis: asked.append(axis) or noise_floor(records, axis)
    )
    assert units_and_floors(records)["floor"] == floor
    assert asked == [0, 1]


@pytest.mark.parametrize(
    ("grown", "source"), [(0.0, "repeated records"), (0.02, "repeated records"), (0.5, "rest segments; ")]
)
def test_a_stage_that_changed_between_repeats_is_no_noise(grown, source):
    """grown: by how much its gain did."""
    drive = rising(2000, rest=1500)
    first, again = (
        record(drive, gain * drive + white(drive.size, seed=seed)) for seed, gain in ((0, 1), (1, 1 + grown))
    )
    floor = noise_floor([first, again], 0)
    assert floor.source.startswith(source)
    assert floor.value == pytest.approx(1, rel=0.2)
    if grown > 0.1:
        assert floor.source.endswith("repeated records differ 4.5 times as much")


@pytest.mark.parametrize("size", [0.15, 0.25, 0.35, 0.5])
@pytest.mark.parametrize("seed", range(4))
def test_steps_of_the_readings_that_rests_hardly_see_are_in_the_noise(size, seed):
    """Noise of that size in steps, at three rests anywhere between two of them, and in motion between: with that of the
    steps, 1 / sqrt(12), it makes the floor."""
    random = np.random.default_rng(seed)
    levels = np.cumsum(random.uniform(200, 300, 4))
    drive = np.concatenate([np.append(np.full(1500, a), np.linspace(a, b, 2000)) for a, b in pairwise(levels)])
    read = np.round(drive + white(drive.size, size, seed=seed))
    floor = noise_floor([record(drive, read)], 0)
    assert floor.value == pytest.approx(np.hypot(size, 1 / 12**0.5), rel=0.12)


def test_readings_without_any_noise_are_good_to_a_part_of_their_range():
    """As of a formula; a floor of zero would be divided by."""
    drive = 50 * (1 - np.cos(2 * np.pi * np.arange(6000) / 1000))
    for made in (record(drive, 1e-7 * drive), record(np.minimum(drive, 60.0), 1e-7 * np.minimum(drive, 60.0))):
        floor = noise_floor([made], 0)
        assert floor.value == pytest.approx(1e-4 * np.ptp(made.response)) and floor.source.startswith("no noise")


@pytest.mark.parametrize("decimals", [8, 9, 10, 12])
def test_a_copy_that_was_rounded_is_no_repeat(noise, decimals):
    """Its differences are those of the rounding, and no noise; a wide-band response is no other."""
    for drive in (50 * (1 - np.cos(2 * np.pi * np.arange(6000) / 6000)), np.random.default_rng(3).normal(size=6000)):
        first = record(drive, 1e-7 * drive + noise)
        copy = dataclasses.replace(first, response=np.round(first.response, decimals))
        assert noise_floor([first, copy], 0).source != "repeated records"
        again = 1e-7 * drive + np.random.default_rng(12).normal(0, SIGMA, 6000)
        for other in (again, np.round(again, decimals)):
            floor = noise_floor([copy, dataclasses.replace(first, response=other[None])], 0)
            assert floor.source == "repeated records" and floor.value == pytest.approx(SIGMA, rel=0.1)
