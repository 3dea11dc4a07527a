"""Noise, counts, data files and job of a campaign, and the truth beside them."""

import json
import math
from pathlib import Path

import numpy as np
from scipy import signal

from experiments.other_labs.declared import keep, truth

from .campaign import MECHANICS, simulate
from .formats import channels, file_name, save
from .names import CAMPAIGNS

SIZES = json.loads((Path(__file__).parent / "sizes.json").read_text())
VOLTS = {"V": 1.0, "kV": 1e3}
MICROMETRES = {"um": 1.0, "nm": 1e-3, "m": 1e6}
WEIGHTS = tuple(f"weight_{i}" for i in range(1, 9))
OF_BASE = {
    "bouc_wen": ("gain", "alpha", "beta", "gamma"),
    "prandtl_ishlinskii": ("gain", *WEIGHTS),
    "homogenized_energy": ("gain", "remanence", "coercive", "spread", "interaction"),
    "domain_wall": ("saturation", "width", "coupling", "pinning", "reversible"),
}
POWERS = {"saturation": (0, 1), "beta": (-1, 0), "gamma": (-1, 0)}  # of the units of drive and response
POWERS |= dict.fromkeys(("gain", *WEIGHTS), (-1, 1))
POWERS |= dict.fromkeys(("remanence", "coercive", "interaction", "width", "pinning"), (1, 0))
LIMITS = {"tight": (0.86, 1.17), "tight2": (0.93, 1.2), "wide": (0.2, 5), "wide2": (0.25, 4)}
LIMITS |= {"off": (1.05, 2.2), "edge": (0.995, 1.9)}  # 5 % beside the truth, and just about it


def noise(count, memory, rng):
    """Noise of a standard deviation of one, first-order autoregressive with the pole `memory`."""
    white = rng.standard_normal(count)
    if not memory:
        return white
    ahead = np.concatenate([rng.standard_normal(500), white])
    return signal.lfilter([math.sqrt(1 - memory**2)], [1, -memory], ahead)[500:]


def quantised(samples, counts):
    return np.round(samples / counts) * counts if counts else samples


def _signals(campaign):
    """Names and units of the columns."""
    yield from [("time", "s")] if campaign.timed else []
    for axis in campaign.parameters:
        yield f"u_{axis}", campaign.drive_unit
        if axis in campaign.measured:
            yield axis, campaign.unit


def _columns(campaign, number, rng):
    """Columns of a record: names, units and samples."""
    record = campaign.records[number]
    samples = {"time": np.arange(record.count) / record.rate}
    samples |= {f"u_{axis}": drive / VOLTS[campaign.drive_unit] for axis, drive in record.drives.items()}
    for axis, y in simulate(campaign, number).items():
        y = y + campaign.noise * noise(record.count, campaign.memory, rng)
        samples[axis] = quantised(y, campaign.counts) / MICROMETRES[campaign.unit]
    return [(name, unit, samples[name]) for name, unit in _signals(campaign)]


def _records(campaign):
    for record in campaign.records:
        rate = "" if campaign.timed else f", sample_rate: {record.rate:g} Hz"
        yield f"  - {{file: {file_name(record.name, campaign.format)}, use: {record.use}{rate}}}"


def _axes(campaign, channel):
    for axis in campaign.parameters:
        response = f", response: {channel[axis]}" if axis in campaign.measured else ""
        yield f"    {axis}: {{drive: {channel[f'u_{axis}']}{response}}}"


def _blocks(campaign):
    """{block of the job: its parameters}."""
    return {campaign.base: OF_BASE[campaign.base]} | ({"lumped": MECHANICS} if campaign.mechanics else {})


def limits(how, value):
    """Bounds of a user about the true value."""
    return sorted(value * share for share in LIMITS[how]) if isinstance(how, str) else how


def _digits(value):
    return float(f"{value:.4g}")


def _entry(campaign, axis, name, how):
    """A parameter of the job, in its units."""
    volts, metres = POWERS.get(name, (0, 0))
    unit = VOLTS[campaign.drive_unit] ** -volts * MICROMETRES[campaign.unit] ** -metres
    value = campaign.parameters[axis][name]
    if how == "fix":
        return f"{{value: {_digits(value * unit)}}}"
    low, high = (_digits(end * unit) for end in limits(how, value))
    return f"{{bounds: [{low}, {high}]}}"


def _parameters(campaign):
    """Lines of the job for the parameters."""
    out = []
    for axis in campaign.measured:
        of_axis = f"{axis}." if len(campaign.measured) > 1 else ""
        for block, names in _blocks(campaign).items():
            for name in names:
                if how := campaign.bounds.get(name):
                    out.append(f"  {of_axis}{block}.{name}: {_entry(campaign, axis, name, how)}")
    out += [f"  {line}" for line in campaign.lines]
    return ["parameters:", *out] if out else []


def job(name, campaign):
    """The job of a user, who knows what the campaign says of bounds."""
    channel = channels(_signals(campaign), campaign.format)
    lines = [f"name: {name}", "records:", *_records(campaign), "channels:"]
    if campaign.timed:
        lines.append(f"  time: {channel['time']}")
    lines += ["  axes:", *_axes(campaign, channel), f"model: [{', '.join(_blocks(campaign))}]"]
    lines += [*_parameters(campaign), "optimizers:", *(f"  - {each}" for each in campaign.optimizers)]
    return "\n".join([*lines, "repeats: 2", "seed: 7"]) + "\n"


def _truth(name, campaign):
    floor = math.sqrt(campaign.noise**2 + campaign.counts**2 / 12)
    samples = sum(record.count for record in campaign.records)
    known = {"noise_um": floor, "samples": samples, "records": len(campaign.records), "base": campaign.base}
    return truth(name, CAMPAIGNS[name], SIZES[name], known)


def write(name, out):
    """Make a campaign in out/name: rig/ with the job and its data, and last truth.json, all at once."""
    campaign, home = CAMPAIGNS[name].build(), Path(out) / name
    rig, rng = home / "rig", np.random.default_rng(1000 + int(name[1:]))
    rig.mkdir(parents=True, exist_ok=True)
    for number, record in enumerate(campaign.records):
        save(rig / file_name(record.name, campaign.format), _columns(campaign, number, rng), campaign.format)
    (rig / "job.yaml").write_text(job(name, campaign))
    keep(home, _truth(name, campaign))
    return home
