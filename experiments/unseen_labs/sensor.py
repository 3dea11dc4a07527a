"""What a sensor adds to a displacement."""

import numpy as np


def quadrature(x, period, gain, phase, offset, other):
    """An interferometer whose second channel has a gain and a phase error, and both an offset (Heydemann 1981)."""
    angle = 2 * np.pi * x / period
    first, second = np.cos(angle) + offset, (1 + gain) * np.sin(angle + phase) + other
    return x + period / 2 / np.pi * np.angle((first + 1j * second) * np.exp(-1j * angle))


def hum(t, number):
    """50.02 Hz and harmonics at 2, 3 and 5 times, of another phase and height in each record."""
    waves = 0.03 * np.sin(2 * np.pi * 50.02 * t + 1.3 * number)
    waves = waves + 0.007 * np.sin(2 * np.pi * 100.04 * t + 0.4 + 2 * number)
    waves = waves + 0.009 * np.sin(2 * np.pi * 150.06 * t + number) + 0.003 * np.sin(2 * np.pi * 250.1 * t)
    return (1, 0.95, 0.85, 1.0)[number] * waves


def warming(t, size, time):
    """size (1 - exp(-t / time))."""
    return size * (1 - np.exp(-t / time))
