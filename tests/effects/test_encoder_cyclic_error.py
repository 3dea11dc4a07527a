"""The cyclic error of an encoder: a function of the position alone, of the period of its grating."""

import numpy as np

from pzt_ident.engine.simulator import Simulator
from rig import model, record, response


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


def test_an_encoder_that_is_set_to_zero_anew_has_a_phase_of_its_own_in_each_record():
    """Of one size and pitch, about another place on the grating: what is left is nothing but the noise."""
    x = 20 * np.abs(np.sin(np.linspace(0, 9, 2000)))
    chain = model("encoder_cyclic_error.rezeroed")
    theta = np.array([[0.5]])
    for zero in (0.0, 0.11, 0.37):
        measured = x + 0.03 * np.sin(2 * np.pi * (x + zero) / 0.5)
        simulator = Simulator(chain, record(x, response=measured[None]))
        phase = 2 * np.pi * zero / 0.5
        found = simulator.amounts.complete(theta)[0, 1:]
        np.testing.assert_allclose(found, [0.03 * np.cos(phase), 0.03 * np.sin(phase)], atol=1e-8)
        assert simulator.squares(theta)[0, 0] < 1e-12 * np.square(measured).sum()


def test_two_signals_on_an_ellipse_are_read_by_their_angle():
    """Offsets, unequal gains and a phase that is no quarter of a period, read by atan2."""
    pitch, x = 0.5, np.linspace(-3, 3, 4000)
    theta = 2 * np.pi * x / pitch
    for size in (0.6, 0.05):
        offset, gain, phase = size * (0.2 - 0.3j), 1 + 0.5 * size, 0.4 * size
        signals = np.cos(theta) + offset.real, gain * np.sin(theta + phase) + offset.imag
        mean = (1 + gain * np.exp(1j * phase)) / 2  # of the circle beside which the ellipse is
        beside, oval = offset / mean, (1 - gain * np.exp(-1j * phase)) / 2 / mean
        known = dict(zip(("sine", "cosine"), (-beside.real, beside.imag), strict=True))
        known |= dict(zip(("second_sine", "second_cosine"), (-oval.real, oval.imag), strict=True))
        known = {word: value * pitch / (2 * np.pi) for word, value in known.items()} | {"pitch": pitch}
        named = {f"encoder_cyclic_error.{word}": value for word, value in known.items()}
        angle = np.unwrap(np.arctan2(*signals[::-1]))
        expected = angle * pitch / (2 * np.pi)
        found = response(["encoder_cyclic_error.elliptic"], named, x)
        np.testing.assert_allclose(found - found[2000], expected - expected[2000], atol=1e-11)
        by_harmonics = response(["encoder_cyclic_error.second"], named, x)
        assert np.abs(by_harmonics - found).max() < size**2 * pitch / (2 * np.pi)
    np.testing.assert_allclose(response(["encoder_cyclic_error.elliptic"], named, np.zeros(3)), 0, atol=1e-15)
