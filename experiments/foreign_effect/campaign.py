"""Records of a campaign: drives as they are run on a rig, rests, sampling, sensor noise and quantisers."""

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.signal import butter, lfilter, sosfilt

BROAD = ("chirp", "multisine", "random")
CALM = ("triangle", "sines", "nested", "steps", "two_amplitudes", "two_rates")
RATES = {"slow": (200, 500, 1000), "fast": (5000, 10000, 20000, 50000)}


@dataclass
class Record:
    """One record: what was run, at which sample rate, for which use, and the voltage of every axis.

    `ahead` has the voltages that the stage went through ahead of the first sample, or none: a start from rest.
    """

    kind: str
    use: str
    rate: float
    drives: dict = field(default_factory=dict)
    ahead: dict = field(default_factory=dict)

    @property
    def samples(self):
        return len(self.drives["x"])

    @property
    def lead(self):
        """Samples ahead of the first one."""
        return len(self.ahead["x"]) if self.ahead else 0

    @property
    def run(self):
        """Voltages of every axis, with those ahead."""
        return {axis: np.concatenate([self.ahead[axis], u]) if self.ahead else u for axis, u in self.drives.items()}


def through(t, points, speeds=None):
    """A line through turning points at constant speed, over the time t."""
    points = np.asarray(points, float)
    way = np.concatenate([[0], np.cumsum(np.abs(np.diff(points)) + 1e-9)])
    return np.interp(t / t[-1] * way[-1], way, points)


def triangle(rng, t, low, high):
    """Triangles over the range, three to six periods."""
    return through(t, [0.0, *([high, low] * int(rng.integers(3, 7)))])


def sines(rng, t, low, high):
    """From rest up to the middle, then whole sines."""
    cycles = rng.integers(3, 9)
    phase = 2 * math.pi * cycles * t / t[-1]
    return (low + high) / 2 + (high - low) / 2 * -np.cos(phase) - low * np.exp(-20 * t / t[-1])


def nested(rng, t, low, high):
    """First-order reversals or loops that shrink, with revisits."""
    if rng.random() < 0.5:
        turns = [0.0]
        for share in np.linspace(0.15, 0.9, int(rng.integers(4, 8))):
            turns += [high, high - share * (high - low)]
        return through(t, [*turns, high, low])
    middle, turns = (low + high) / 2, [0.0]
    for share in np.linspace(1, 0.15, int(rng.integers(4, 8))):
        turns += [middle + share * (high - middle), middle - share * (middle - low)]
    return through(t, [*turns, high, low])


def steps(rng, t, low, high):
    """Steps with holds; each edge takes a thousandth of the record."""
    count = int(rng.integers(4, 8))
    levels = [0.0, *rng.uniform(low + 0.1 * (high - low), high, count)]
    levels[2] = high
    edges = np.linspace(0.05, 1, count + 1)[:-1] * t[-1]
    rise = max(t[-1] / 1000, 2 * (t[1] - t[0]))
    out = np.zeros(len(t))
    for before, after, edge in zip(levels[:-1], levels[1:], edges, strict=True):
        out += (after - before) * np.clip((t - edge) / rise, 0, 1)
    return out


def _risen(t, middle, wave, share=0.12):
    """Up to the middle in the first part, where the wave fades in."""
    rise = np.clip(t / (share * t[-1]), 0, 1)
    soft = 0.5 - 0.5 * np.cos(math.pi * rise)
    window = 0.5 - 0.5 * np.cos(math.pi * np.clip((t / t[-1] - share) / 0.05, 0, 1))
    return middle * soft + wave * window


def chirp(rng, t, low, high):
    """A logarithmic chirp of small amplitude about a bias, up to a sixth of the sample rate."""
    top, bottom = 1 / (t[1] - t[0]) / rng.uniform(6, 12), 8 / t[-1]
    rise = t / t[-1]
    phase = 2 * math.pi * bottom * t[-1] / math.log(top / bottom) * ((top / bottom) ** rise - 1)
    size = rng.uniform(0.05, 0.25) * (high - low)
    return _risen(t, rng.uniform(0.3, 0.6) * (high + low), size * np.sin(phase))


def multisine(rng, t, low, high):
    """Tones spaced evenly in the logarithm, with random phases, about a bias."""
    top, bottom = 1 / (t[1] - t[0]) / rng.uniform(8, 25), 3 / t[-1]
    tones = np.geomspace(bottom, top, int(rng.integers(8, 20)))
    wave = sum(np.sin(2 * math.pi * f * t + rng.uniform(0, 6.28)) / f**0.3 for f in tones)
    wave *= rng.uniform(0.2, 0.48) * (high - low) / np.max(np.abs(wave))
    return _risen(t, 0.5 * (high + low), wave)


def noise_drive(rng, t, low, high):
    """Low-passed random voltage about a bias."""
    top = 1 / (t[1] - t[0]) / rng.uniform(15, 60)
    wave = sosfilt(butter(2, top, fs=1 / (t[1] - t[0]), output="sos"), rng.standard_normal(len(t)))
    wave *= rng.uniform(0.25, 0.48) * (high - low) / np.max(np.abs(wave))
    return _risen(t, 0.5 * (high + low), wave)


def two_amplitudes(rng, t, low, high):
    """Triangles at a part of the range, then over all of it."""
    part = rng.uniform(0.25, 0.5)
    small = [part * high, part * low] * 3
    return through(t, [0.0, *small, *([high, low] * 2)])


def two_rates(rng, t, low, high):
    """A slow loop, then as many fast ones as a decade holds."""
    half = int(0.6 * len(t))
    slow = through(t[:half], [0.0, high, low])
    fast = through(t[: len(t) - half], [low, *([high, low] * int(rng.integers(8, 13)))])
    return np.concatenate([slow, fast])


DRIVES = {
    "triangle": triangle,
    "sines": sines,
    "nested": nested,
    "steps": steps,
    "chirp": chirp,
    "multisine": multisine,
    "random": noise_drive,
    "two_amplitudes": two_amplitudes,
    "two_rates": two_rates,
}


def drive(rng, kind, samples, rate, low, high, rest=0, gentle=False):
    """Voltage of one record from 0 V: what its kind draws, ahead and behind a rest of some samples.

    A stage with a resonance in the band is driven gently by whoever wants to keep it.
    """
    t = np.arange(samples - 2 * rest) / rate
    if gentle and kind in BROAD:
        middle, part = (low + high) * rng.uniform(0.35, 0.65), (0.05 if kind == "chirp" else 0.15) * (high - low)
        out = DRIVES[kind](rng, t, middle - part, middle + part)
    else:
        out = DRIVES[kind](rng, t, low, high)
    return np.concatenate([np.full(rest, out[0]), out, np.full(rest, out[-1])]) if rest else out


def plan(rng, pace, wanted, most=26000):
    """Records of a campaign without voltages: (kind, rate, samples); `wanted` are kinds that it must contain twice."""
    slow = float(rng.choice(RATES["slow"]))
    fast = slow if pace == "slow" else float(rng.choice(RATES["fast"] if pace == "fast" else (2000, 5000, 10000)))
    count = int(rng.choice([2, 3, 4, 5, 6, 8, 10], p=[0.12, 0.22, 0.22, 0.18, 0.12, 0.08, 0.06]))
    kinds = list(wanted)
    if not set(kinds) & set(CALM):
        kinds.append(str(rng.choice(CALM)))  # a loop over the whole range
    while len(kinds) < max(count, len(wanted) + 2):
        kinds.append(str(rng.choice(CALM if rng.random() < (0.7 if pace != "fast" else 0.4) else BROAD)))
    records = []
    for kind in kinds:
        rate = fast if (kind in BROAD or pace == "fast") else slow
        seconds = rng.uniform(6, 40) if rate <= 1000 else rng.uniform(2000, 9000) / rate
        samples = int(min(max(seconds * rate, 600), 12000) * (0.3 if rng.random() < 0.15 else 1.0))
        records.append((kind, rate, max(samples, 600)))
    total = sum(r[2] for r in records)
    if total > most:
        records = [(k, r, max(600, int(n * most / total))) for k, r, n in records]
    return records


def split(rng, records, wanted):
    """Which records are identified from: a loop and each kind that is wanted among them; the others are kept."""
    order, kinds = [int(i) for i in rng.permutation(len(records))], [r[0] for r in records]
    identify = {next(i for i in order if kinds[i] == kind) for kind in wanted}
    if not any(kinds[i] in CALM for i in identify):
        identify.add(next(i for i in order if kinds[i] in CALM))
    left = sorted((i for i in order if i not in identify), key=lambda i: kinds[i] not in wanted)
    kept = left[: max(1, round(0.35 * len(records)))]
    return ["validate" if i in kept else "identify" for i in range(len(records))]


def campaign(rng, pace, wanted, span, others=(), gentle=False):
    """Records with the voltages of x and of the `others`; some with rests, some with the other axis still."""
    low, high = span
    plans = plan(rng, pace, wanted)
    rests, out = rng.random() < 0.5, []
    for (kind, rate, samples), use in zip(plans, split(rng, plans, wanted), strict=True):
        rest = int(min(0.08 * samples, 2 * rate)) if rests and rng.random() < 0.7 else 0
        record = Record(kind, use, rate, {"x": drive(rng, kind, samples, rate, low, high, rest, gentle)})
        for name in others:
            moves = str(rng.choice(["triangle", "multisine", "steps", "nested", "sines"]))
            still = rng.random() < 0.2 and len(out) > 1
            record.drives[name] = (
                np.zeros(samples) if still else drive(rng, moves, samples, rate, 0.0, 0.8 * high, rest)
            )
        out.append(record)
    return out


def slow_loops(rng, span, others):
    """Slow loops only: three to five records at one rate, no step, no second rate, nothing broad."""
    rate, out = float(rng.choice(RATES["slow"])), []
    for i in range(int(rng.integers(3, 6))):
        kind = str(rng.choice(["triangle", "sines", "nested", "two_amplitudes"]))
        samples = min(int(rng.uniform(6, 30) * rate), 6000)
        record = Record(kind, "validate" if i == 1 else "identify", rate, {"x": drive(rng, kind, samples, rate, *span)})
        for name in others:
            moves = str(rng.choice(["triangle", "sines", "nested"]))
            record.drives[name] = drive(rng, moves, samples, rate, 0.0, 0.8 * span[1])
        out.append(record)
    return out


def one_tone(t, low, high, period, shape):
    """Triangles or sines of one period between two voltages, from 0 V upwards."""
    start = -low / (high - low)
    if shape == "triangle":
        phase = t / period + start / 2
        return low + (high - low) * (1 - np.abs(1 - 2 * (phase % 1)))
    return low + (high - low) * (1 - np.cos(2 * math.pi * t / period + math.acos(1 - 2 * start))) / 2


def one_frequency(rng, pace, span, others):
    """Triangles, or sines, of one frequency only: two to four records that differ in amplitude and length."""
    rate, shape = float(rng.choice(RATES[pace])), str(rng.choice(["triangle", "sines"]))
    low, high, period, out = *span, int(rng.integers(200, 1200)), []
    for i in range(int(rng.integers(2, 5))):
        share = 1.0 if i == 0 else float(rng.uniform(0.4, 1))
        t = np.arange(int(period * rng.integers(3, 8))) / rate
        record = Record(shape, "validate" if i == 1 else "identify", rate)
        record.drives["x"] = one_tone(t, share * low, share * high, period / rate, shape)
        for name in others:
            late = np.maximum(t - period / rate / 4, 0.0)
            record.drives[name] = one_tone(late, 0.0, float(rng.uniform(0.3, 0.8)) * high, period / rate, shape)
        out.append(record)
    return out


def noise(rng, samples, sigma, memory):
    """Sensor noise of standard deviation sigma: white, or e_k = memory e_k-1 + w_k."""
    white = rng.standard_normal(samples)
    if not memory:
        return sigma * white
    start = white[0]
    white = white * math.sqrt(1 - memory**2)
    return sigma * lfilter([1], [1, -memory], white, zi=[start - white[0]])[0]


def read(y, rng, sensor):
    """Reading of a sensor {sigma, memory, count}: noise, then counts."""
    seen = y + noise(rng, len(y), sensor["sigma"], sensor["memory"])
    return sensor["count"] * np.round(seen / sensor["count"]) if sensor["count"] else seen


def floor(sensor):
    """Standard deviation of noise and counts together."""
    return math.hypot(sensor["sigma"], sensor["count"] / math.sqrt(12))
