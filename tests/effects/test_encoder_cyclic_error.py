"""The cyclic error of an encoder: a function of the position alone, of the period of its grating."""

import numpy as np

from rig import response


def read(x, sine=0.03, cosine=-0.02, pitch=0.5):
    known = {"sine": sine, "cosine": cosine, "pitch": pitch}
    return response(["encoder_cyclic_error"], {f"encoder_cyclic_error.{word}": known[word] for word in known}, x)


def test_repeats_with_the_pitch():
    x = np.random.default_rng(1).uniform(-20, 20, 1000)
    phase = 2 * np.pi * x / 0.5
    np.testing.assert_allclose(read(x), x + 0.03 * np.sin(phase) - 0.02 * (np.cos(phase) - 1), rtol=0, atol=1e-13)
    np.testing.assert_allclose(read(x + 0.5) - 0.5, read(x), rtol=0, atol=1e-12)


def test_none_at_zero_and_half_a_pitch_on_the_other_sign():
    assert read(np.zeros(3)).tolist() == [0, 0, 0]
    x = np.linspace(-3, 3, 100)
    error, shifted = read(x) - x, read(x + 0.25) - (x + 0.25)
    np.testing.assert_allclose(error + shifted, 2 * 0.02, rtol=0, atol=1e-13)
