"""A line of the spectrum is told from what is left elsewhere, and from the harmonics of the drive."""

from dataclasses import replace

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.limit import curve_of, harmonic_of, is_limited
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.spectral_line import is_own_line, order_of, power_near, stands_alone
from pzt_ident.diagnosis.staircase import improve
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.model.registry import blocks, word_of

HUM = "periodic_disturbance"


GRATING = "encoder_cyclic_error"


def others(word=HUM):
    return tuple({*blocks.effects()} - {word})


def slow(samples, seed, size):
    """What no effect of the catalogue explains: noise below a few Hz."""
    steps = np.random.default_rng(seed).normal(size=samples // 40 + 2)
    course = np.interp(np.arange(samples), 40 * np.arange(steps.size), steps)
    return size * course / np.std(course)


def hum_of(record, frequency, size, cycles=np.inf):
    seed = len(record.name)
    burst = (record.time * frequency) % (3 * cycles) < cycles if np.isfinite(cycles) else 1.0
    return np.sqrt(2) * size * np.sin(2 * np.pi * frequency * record.time + seed) * burst


@pytest.mark.parametrize(("size", "cycles", "named"), [(25e-9, np.inf, True), (0.0, np.inf, False), (40e-9, 20, False)])
def test_a_hum_beside_what_nothing_explains_is_named(size, cycles, named):
    """And none that comes and goes, of which a line takes up a part of its band."""

    def change(record):
        return slow(record.samples, record.samples, 40e-9) + hum_of(record, 31.3, size, cycles)

    case = stage.with_response(stage.case(), change)
    case.ruled_out = others()
    found = improve(case, first_fit(case, 0))
    assert found.end.effects == ((HUM,) if named else ())
    assert found.last.verdict == "unexplained"


@pytest.mark.parametrize(
    ("size", "pitch", "named"), [(35e-9, 0.7e-6, True), (0.0, 0.7e-6, False), (35e-9, 8e-6, False)]
)
def test_a_grating_beside_what_nothing_explains_is_named(size, pitch, named):
    """And none whose period the stroke does not hold often: that is any curve."""

    def change(record):
        error = np.sqrt(2) * size * np.sin(2 * np.pi * record.response / pitch)
        return slow(record.samples, record.samples, 40e-9) + error

    case = stage.with_response(stage.case(), change)
    case.ruled_out = others(GRATING)
    found = improve(case, first_fit(case, 0))
    assert list(map(word_of, found.end.effects)) == [GRATING] * named
    assert found.last.verdict == "unexplained"


@pytest.mark.parametrize("course", [np.linspace(0, 3, 4000), 3 - np.linspace(0, 3, 4000) ** 2 / 3])
def test_a_band_is_that_of_its_course_whatever_its_pace(course):
    """A sine of the course is in its band, and white noise has its mean square everywhere."""
    noise = np.random.default_rng(2).normal(size=(400, course.size))
    assert np.mean(power_near(noise, course, 20.0)) == pytest.approx(1, rel=0.1)
    line = np.sin(2 * np.pi * 20 * course)[None]
    there, elsewhere = power_near(line, course, 20.0)[0], power_near(line, course, 10.0)[0]
    assert elsewhere < 1e-3 * there


def line_of(course, wave, seed):
    """A line in noise, and the noise."""
    noise = np.random.default_rng(seed).normal(size=course.size)
    return np.sin(2 * np.pi * wave * course + seed) + noise, noise


@pytest.mark.parametrize("seed", range(20))
def test_a_line_stands_alone_where_the_stage_moves_more_and_has_none(seed):
    course = np.arange(4000) * 1e-3
    line, noise = line_of(course, 60.0, seed)
    motion = 1e3 * np.random.default_rng(seed + 100).normal(size=course.size)
    assert stands_alone(np.array([line, motion]), course, 60.0)
    assert not stands_alone(np.array([noise, motion]), course, 60.0)
    assert not stands_alone(np.array([line, 1e3 * line]), course, 60.0)
    assert not stands_alone(np.array([line, motion])[:, :200], course[:200], 60.0)


@pytest.mark.parametrize("frequency", [31.3, 12.9])
def test_a_hum_is_a_line_beside_a_drive_that_moves_the_stage_at_its_frequency(frequency):
    """And what a drive leaves that moves it there is none."""
    noise = [np.random.default_rng(seed).normal(0, 60, 3000) for seed in (1, 2)]
    drives = [np.pad(np.convolve(drive, np.ones(9) / 9, "valid"), 400) for drive in noise]
    for hum in (25e-9, 0.0):
        case = stage.with_response(
            stage.case({"amplifier_lag.tau": 3e-4}, drives=drives),
            lambda record, hum=hum: hum_of(record, frequency, hum),
        )
        first = first_fit(case, 0)
        now = refit(case, first, (HUM,), {f"{HUM}.frequency": frequency})
        assert is_own_line(case, first, now, HUM) == (hum > 0)


def periodic(frequency):
    """A stage that is driven by a sine of 2 Hz, and a hum."""
    drive = 50 - 50 * np.cos(4 * np.pi * 5e-3 * np.arange(1000))
    case = stage.case(drives=[drive, 0.8 * drive])
    return stage.with_response(case, lambda record: hum_of(record, frequency, 50e-9))


@pytest.mark.parametrize(("frequency", "limited"), [(6.0, True), (6.9, False), (50.0, False)])
def test_a_low_harmonic_of_the_drive_is_as_well_the_stage_itself(frequency, limited):
    case = periodic(frequency)
    first = first_fit(case, 0)
    problem = case.problem((HUM,))
    point = problem.unit_point(first.values | {f"{HUM}.frequency": frequency})
    assert is_limited(fit_at((HUM,), problem, point)) == limited


@pytest.mark.parametrize("step", [0.0, 2e-8, 1e-7])
def test_the_counts_of_the_sensor_are_no_cyclic_error(step):
    """The rounding of readings to counts is a function of the displacement, of the period of a count."""
    rounded = lambda record: step * np.round(record.response / step) - record.response if step else 0.0  # noqa: E731
    found = improve(case := stage.with_response(stage.case({}), rounded), first_fit(case, 0))
    assert found.end.effects == () and found.last.verdict == "adequate"


@pytest.mark.parametrize(("counts", "limited"), [(1.0, True), (3.0, True), (4.0, False)])
def test_a_cyclic_error_of_few_counts_may_be_theirs(counts, limited):
    step = 1e-7
    case = stage.with_response(stage.case({}), lambda record: step * np.round(record.response / step) - record.response)
    first, problem = first_fit(case, 0), case.problem((GRATING,))
    grating = {f"{GRATING}.sine": 0.01, f"{GRATING}.cosine": 0.0, f"{GRATING}.pitch": counts * step * 1e6}
    fit = fit_at((GRATING,), problem, problem.unit_point(first.values | grating))
    assert bool(harmonic_of(fit, GRATING)) == limited


@pytest.mark.parametrize(("periods", "few"), [(2.3, True), (2.7, False)])
def test_a_cyclic_error_of_few_periods_is_a_curve(periods, few):
    case = stage.case({})
    first, problem = first_fit(case, 0), case.problem((GRATING,))
    stroke = max(np.ptp(record.response) for record in case.records) * 1e6
    grating = {f"{GRATING}.sine": 0.01, f"{GRATING}.cosine": 0.0, f"{GRATING}.pitch": stroke / periods}
    fit = fit_at((GRATING,), problem, problem.unit_point(first.values | grating))
    assert bool(curve_of(fit, GRATING)) == few


def test_a_drive_that_does_not_repeat_has_no_harmonics():
    record = periodic(6.0).records[0]
    assert order_of(record, 6.0) == 3
    assert order_of(replace(record, drive=np.cumsum(record.drive, axis=1)), 6.0) == 0


@pytest.mark.parametrize(
    "item", [item for word in blocks.effects() for item in blocks.forms(word) if blocks[item].line]
)
def test_a_line_has_a_frequency_or_a_period(item):
    assert blocks[item].parameters()[blocks[item].line].unit in ("Hz", "response")


def test_an_effect_without_a_frequency_is_no_line():
    case = stage.case(stage.EFFECTS["creep"])
    first = first_fit(case, 0)
    assert not is_own_line(case, first, refit(case, first, ("creep",), {}), "creep")
