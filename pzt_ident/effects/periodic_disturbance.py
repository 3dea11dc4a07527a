"""Mains hum and vibration of the floor."""

from math import pi

import numpy as np

from pzt_ident.model.block import Addition, Block, Place, cos, sin
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks

GUESS_PERIODS = 8  # that a record must have for a guess of the frequency
MAINS = (50, 60, 100, 120)  # Hz, and as rectifiers double it
MIN_PERIODS = 3  # in a record; with fewer the disturbance could be the response itself
HARMONICS = 20  # of the drive, which hysteresis leaves in the residual


class Line:
    """What all forms of a periodic disturbance declare."""

    form = Form(
        "sine", ("sine", "harmonics", "odd_harmonics", "ripple"), "The course of the disturbance, and where it enters."
    )
    frequency = Parameter("Hz", (1, 1000), "Frequency of the disturbance, f.", scale="log")
    line = "frequency"
    look_alikes = ()
    separate_by = "Record at constant voltage, then with the driver off: a line that stays is not the drive's."
    remedy = "Ground and shield against hum, isolate the stage from the floor, or filter the line out."

    def guess(times, drives, residuals, low, high):
        """The strongest spectral lines of the residuals of all records, Hz, without those of the drive, and those of
        mains, which a hysteresis that they shake leaves as little of as of the drive."""
        grid = np.arange(low, high, 0.1 / max(t[-1] - t[0] for t in times))
        power = np.zeros(grid.size)
        for t, drive, residual in zip(times, drives, residuals, strict=True):
            frequency, lines = spectrum(t, residual)
            power += np.interp(grid, frequency, lines, right=0) * independent_of_drive(grid, t, drive)
        peaks = np.flatnonzero((power[1:-1] > power[:-2]) & (power[1:-1] >= power[2:])) + 1
        mains = [line for line in MAINS if low < line < high and power[np.abs(grid - line).argmin()]]
        return np.append(grid[peaks[np.argsort(-power[peaks])[:3]]], mains)


@blocks.register
class PeriodicDisturbance(Line, Addition):
    """Hum or vibration adds to the displacement: y = x + a sin(2 pi f t) + b cos(2 pi f t), t from the start.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems. Each record has its own phase; in a
    record of fewer than three periods it is zero.
    """

    place = Place.OUTPUT
    sine = Parameter("response", (-1, 1), "Part in phase at the start of a record, a.", null=0, per_record=True)
    cosine = Parameter("response", (-1, 1), "Part a quarter period ahead of it, b.", null=0, per_record=True)

    def basis(t, frequency, duration):
        phase, enough = 2 * pi * frequency * t, 1.0 if frequency * duration >= MIN_PERIODS else 0.0
        return enough * sin(phase), enough * cos(phase)


def spectrum(t, signal):
    """Frequencies in Hz, eight or more per line width, and the power at these."""
    size = 2 ** int(np.ceil(np.log2(8 * t.size)))
    rate = (t.size - 1) / (t[-1] - t[0])
    return np.arange(size // 2 + 1) * rate / size, np.abs(np.fft.rfft(signal, size)) ** 2 / t.size


def independent_of_drive(grid, t, drive):
    """Whether a line at each frequency of the grid can be a disturbance: the record has GUESS_PERIODS of it, and it is
    no harmonic of a periodic drive (one with more than a third of its power at one frequency)."""
    seconds = t[-1] - t[0]
    frequency, lines = spectrum(t, drive - drive.mean())
    first = frequency[np.argmax(lines)]
    near = np.abs(frequency - first) < 1 / seconds
    independent = grid * seconds >= GUESS_PERIODS
    if first * seconds >= 3 and lines[near].sum() > lines.sum() / 3:
        order = np.round(grid / first)
        independent &= (order > HARMONICS) | (np.abs(grid - order * first) > 1 / seconds)
    return independent


class Harmonics(PeriodicDisturbance):
    """Mains with its second and third harmonic, as rectifiers and transformers make them: y = x + sum_n a_n sin(2 pi n
    f t) + b_n cos(2 pi n f t), n = 1, 2 and 3.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems.
    """

    second_sine = Parameter("response", (-1, 1), "Second harmonic, in phase at the start.", null=0, per_record=True)
    second_cosine = Parameter("response", (-1, 1), "Second harmonic, a quarter period ahead.", null=0, per_record=True)
    third_sine = Parameter("response", (-1, 1), "Third harmonic, in phase at the start.", null=0, per_record=True)
    third_cosine = Parameter("response", (-1, 1), "Third harmonic, a quarter period ahead.", null=0, per_record=True)

    def basis(t, frequency, duration):
        phase, enough = 2 * pi * frequency * t, 1.0 if frequency * duration >= MIN_PERIODS else 0.0
        s, c = sin(phase), cos(phase)
        second, third = (2 * s * c, 1 - 2 * s * s), (s * (3 - 4 * s * s), c * (4 * c * c - 3))
        return enough * s, enough * c, enough * second[0], enough * second[1], enough * third[0], enough * third[1]


class OddHarmonics(PeriodicDisturbance):
    """Mains with its third and fifth harmonic, as saturated transformers and switched supplies make them: y = x + sum_n
    a_n sin(2 pi n f t) + b_n cos(2 pi n f t), n = 1, 3 and 5.

    Arrillaga & Watson (2003), Power System Harmonics, ch. 3.
    """

    third_sine, third_cosine = Harmonics.third_sine, Harmonics.third_cosine
    fifth_sine = Parameter("response", (-1, 1), "Fifth harmonic, in phase at the start.", null=0, per_record=True)
    fifth_cosine = Parameter("response", (-1, 1), "Fifth harmonic, a quarter period ahead.", null=0, per_record=True)

    def basis(t, frequency, duration):
        phase, enough = 2 * pi * frequency * t, 1.0 if frequency * duration >= MIN_PERIODS else 0.0
        s, c = sin(phase), cos(phase)
        third, fifth = s * (3 - 4 * s * s), s * (5 - 20 * s * s + 16 * s * s * s * s)
        third_c, fifth_c = c * (4 * c * c - 3), c * (5 - 20 * c * c + 16 * c * c * c * c)
        return enough * s, enough * c, enough * third, enough * third_c, enough * fifth, enough * fifth_c


class Ripple(Line, Block):
    """Ripple of the amplifier's supply adds to the drive, with its third harmonic, and the hysteresis bends it:
    v = u + sum_n a_n sin(2 pi n f t) + b_n cos(2 pi n f t), n = 1 and 3.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems. From sample to sample the phase
    advances by a rotation; in a record of less than a period there is none.
    """

    place = Place.SUPPLY
    drive_sine = Parameter("drive", (-0.1, 0.1), "Part in phase at the start of a record, a.", null=0, per_record=True)
    drive_cosine = Parameter("drive", (-0.1, 0.1), "Part a quarter period ahead of it, b.", null=0, per_record=True)
    drive_third_sine = Parameter(
        "drive", (-0.1, 0.1), "Third harmonic, in phase at the start.", null=0, per_record=True
    )
    drive_third_cosine = Parameter(
        "drive", (-0.1, 0.1), "Third harmonic, a quarter period ahead.", null=0, per_record=True
    )

    def prepare(drive_sine, drive_cosine, drive_third_sine, drive_third_cosine, frequency, duration, dt):
        turn, enough = 2 * pi * frequency * dt, 1.0 if frequency * duration >= 1 else 0.0
        sizes = drive_sine, drive_cosine, drive_third_sine, drive_third_cosine
        return enough * sizes[0], enough * sizes[1], enough * sizes[2], enough * sizes[3], sin(turn), cos(turn)

    def start(u, a, b, third_a, third_b, sine, cosine):
        return -sine, cosine

    def step(s, c, u, a, b, third_a, third_b, sine, cosine):
        s, c = s * cosine + c * sine, c * cosine - s * sine
        return s, c, u + a * s + b * c + third_a * s * (3 - 4 * s * s) + third_b * c * (4 * c * c - 3)


PeriodicDisturbance.forms = {"harmonics": Harmonics, "odd_harmonics": OddHarmonics, "ripple": Ripple}
