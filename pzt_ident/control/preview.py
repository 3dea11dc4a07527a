"""Linear dynamics inverted by a filter that sees what is asked for ahead of time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pzt_ident.control.stage import Blocks, Stage
from pzt_ident.model.block import Place

Array = NDArray[np.float64]

LONGEST = 2**18  # samples of a pulse response
DECAYED = 1e-9  # of its largest value
DROPPED = 1e-12  # share of the taps that may be left away at either end


@dataclass(frozen=True)
class Preview:
    """y_a(i) = sum_b sum_k taps[a, b, k] x_b(i + ahead - k), with x held before its first and after its last sample.

    rings: the dynamics do not decay, so that only their static gain is inverted.
    """

    taps: Array
    ahead: int
    rings: bool = False

    @property
    def is_identity(self) -> bool:
        return self.taps.shape[2] == 1 and np.array_equal(self.taps[:, :, 0], np.eye(len(self.taps)))

    def __call__(self, signal: Array) -> Array:
        """(axes, samples) -> (axes, samples)."""
        from scipy.signal import oaconvolve

        if self.is_identity:
            return signal
        samples = signal.shape[1]
        least, most = max(self.ahead - samples + 1, 0), min(self.ahead + samples, self.taps.shape[2])
        near = self.taps[:, :, least:most]  # the others lead from no sample to another
        held = np.pad(signal, ((0, 0), (most - 1 - self.ahead, self.ahead - least)), "edge")
        before, after = (taps.sum(axis=2) for taps in (self.taps[:, :, most:], self.taps[:, :, :least]))
        ends = before @ signal[:, :1] + after @ signal[:, -1:]
        return ends + np.array([sum(map(lambda h, x: oaconvolve(x, h, "valid"), row, held)) for row in near])


def preview(stage: Stage, places: frozenset[Place], gain: float, size: Array, without: Blocks = ()) -> Preview:
    """The inverse of the linear dynamics of a stage at some places, for small signals about rest.

    gain: the most by which the filter may amplify any frequency, relative to its static gain. At frequencies at which
    the dynamics answer with less than 1 / gain of their static response, they are not made up for. size: of each axis
    a small input. without: blocks to leave out. The taps follow from the frequency response H by singular values s of
    H / H(0) as s^3 / (s^4 + 1 / gain^4) in the place of 1 / s: a regularised inverse, Tikhonov's with a steeper edge.
    """
    axes = len(size)
    if not stage.operations(places, without):
        return Preview(np.eye(axes)[:, :, None], 0)
    pulses, decays = pulse_responses(stage, places, size, without)
    static = pulses.sum(axis=2) if decays else np.cumsum(pulses, axis=2)[:, :, pulses.shape[2] // 2 :].mean(axis=2)
    back = np.linalg.inv(static)
    if not decays:
        return Preview(back[:, :, None], 0, rings=True)
    count = 4 * pulses.shape[2]
    response = np.fft.rfft(back @ pulses.transpose(2, 0, 1), count, axis=0)
    inverse = inverted(response, gain) @ back
    taps = np.roll(np.fft.irfft(inverse, count, axis=0), count // 2, axis=0)
    return trimmed(taps.transpose(1, 2, 0), count // 2, static)


def inverted(response: NDArray[np.complex128], gain: float) -> NDArray[np.complex128]:
    """The regularised inverse of matrices, (frequencies, axes, axes)."""
    if response.shape[1] == 1:
        s = np.abs(response)
        return np.asarray((1 + gain**-4.0) * s**2 / (s**4 + gain**-4.0) * np.conj(response))
    u, s, v = np.linalg.svd(response)
    limited = (1 + gain**-4.0) * s**3 / (s**4 + gain**-4.0)
    return np.asarray(np.conj(v.transpose(0, 2, 1)) @ (limited[:, :, None] * np.conj(u.transpose(0, 2, 1))))


def trimmed(taps: Array, ahead: int, static: Array) -> Preview:
    """Without the ends that hardly count, and with the exact static gain."""
    size = np.abs(taps).sum(axis=(0, 1))
    allowed = DROPPED * size.sum()
    first = min(int(np.searchsorted(np.cumsum(size), allowed)), ahead)
    last = max(size.size - int(np.searchsorted(np.cumsum(size[::-1]), allowed)), ahead + 1)
    kept = taps[:, :, first:last]
    correction = np.linalg.inv(static) @ np.linalg.inv(kept.sum(axis=2))
    return Preview(np.einsum("ab,bck->ack", correction, kept), ahead - first)


def pulse_responses(stage: Stage, places: frozenset[Place], size: Array, without: Blocks = ()) -> tuple[Array, bool]:
    """Responses [a, b, :] of axis a to a pulse of axis b, 1 at one sample and linear to its neighbours, and whether
    they decay."""
    count = 128
    while True:
        count *= 2
        pulses = np.array([pulse_response(stage, places, size, axis, count, without) for axis in range(len(size))])
        rest = np.abs(pulses[:, :, -count // 4 :]).max()
        responds = all(np.abs(pulses[axis, axis]).max() > 0 for axis in range(len(size)))  # a delay may be longer
        decays = bool(responds and rest <= DECAYED * np.abs(pulses).max())
        if decays or count >= LONGEST:
            return pulses.transpose(1, 0, 2), decays


def pulse_response(
    stage: Stage, places: frozenset[Place], size: Array, axis: int, count: int, without: Blocks
) -> Array:
    drive = np.zeros((len(size), count + 1))
    drive[axis, 1] = size[axis]
    return stage.part(places, without).respond(drive)[:, 1:] / size[axis]
