"""Noise, counts, data files and job of a campaign, and the truth beside them."""

import json
import math
from pathlib import Path

import numpy as np
from scipy.io import savemat
from scipy.signal import lfilter

from .campaign import simulate
from .declared import keep, truth
from .names import CAMPAIGNS

SIZES = json.loads((Path(__file__).parent / "sizes.json").read_text())
UNITS = {"um": 1, "nm": 1e3, "mm": 1e-3}
DRIVE_UNITS = {"V": 1, "kV": 1e-3}
TIME_UNITS = {"s": 1, "ms": 1e3}
SEPARATORS = {"csv": ",", "tsv": "\t", "dat": " "}
MECHANICS = ("mass", "damping", "stiffness")
VOLTAGES = ("remanence", "coercive", "interaction", "reach", "width", "pinning")
PER_VOLT = ("beta", "gamma")
BLOCKS = {"generalised_bouc_wen": "bouc_wen", "preisach": "homogenized_energy"}


def noise(count, size, memory, coloured, rng):
    """White noise, of which the share `coloured` of the variance is first-order autoregressive with pole `memory`."""
    white = rng.normal(size=count)
    if memory:
        slow = lfilter([math.sqrt(1 - memory**2)], [1, -memory], rng.normal(size=count))
        white = math.sqrt(1 - coloured) * white + math.sqrt(coloured) * slow
    return size * white


def quantised(signal, counts):
    return np.round(signal / counts) * counts if counts else signal


def noise_size(name, campaign):
    """Standard deviation of the noise of the sensor in um, without its counts."""
    return SIZES[name]["noise"] if campaign.noise is None else campaign.noise


def _columns(campaign, number, size, rng):
    """{heading: samples} of a record."""
    record, ahead = campaign.records[number], campaign.records[number].ahead
    out = {}
    if campaign.timed:
        times = record.times[ahead:] - record.times[ahead]
        out[f"t [{campaign.time_unit}]"] = times * TIME_UNITS[campaign.time_unit]
    for axis, drive in record.drives.items():
        shown = quantised(drive[ahead:], campaign.drive_counts)
        out[f"U{axis} [{campaign.drive_unit}]"] = shown * DRIVE_UNITS[campaign.drive_unit]
    for axis, y in simulate(campaign, number).items():
        y = y + noise(len(y), size, campaign.memory, campaign.coloured, rng)
        out[f"{axis} [{campaign.unit}]"] = quantised(y, campaign.counts) * UNITS[campaign.unit]
    return out


def _save(path, columns, form):
    """Write the columns of a record as a file of that format."""
    table = np.stack(list(columns.values()), 1)
    if form == "mat":
        savemat(path, {heading.split(" [")[0]: samples for heading, samples in columns.items()})
    elif form == "npy":
        np.save(path, table)
    else:
        separator = SEPARATORS[form]
        header = "" if form == "dat" else separator.join(columns)
        np.savetxt(path, table, "%.9g", separator, header=header, comments="")


def _channels(headings, form):
    """{name of a signal: its channel in the job}."""
    out = {}
    for column, heading in enumerate(headings, 1):
        signal, unit = heading.rstrip("]").split(" [")
        if form == "mat":
            out[signal] = f"{{dataset: {signal}, unit: {unit}}}"
        elif form in ("csv", "tsv"):
            out[signal] = f'"{heading}"'
        else:
            out[signal] = f"{{column: {column}, unit: {unit}}}"
    return out


def _outwards(value, up):
    """Two digits, rounded up or down."""
    if value == 0:
        return 0.0
    step = 10.0 ** (np.floor(np.log10(abs(value))) - 1)
    return float((np.ceil if up else np.floor)(value / step) * step)


def _limits(how, value, rng):
    """Bounds of a user about the true value: `wide`, `tight`, or 5 % wrong, too `low` or too `high`."""
    if how == "low":
        ends = value * 0.4, value / 1.05
    elif how == "high":
        ends = value * 1.05, value * 2.5
    elif how == "tight":
        ends = value * (1 - rng.uniform(0.06, 0.15)), value * (1 + rng.uniform(0.06, 0.15))
    else:
        ends = value * rng.uniform(0.1, 0.4), value * rng.uniform(2.2, 5)
    low, high = sorted(ends)
    if how in ("low", "high"):
        return float(f"{low:.4g}"), float(f"{high:.4g}")
    return _outwards(low, False), _outwards(high, True)


def _in_units(name, value, campaign):
    """A parameter in the units of the job."""
    unit, volt = UNITS[campaign.unit], DRIVE_UNITS[campaign.drive_unit]
    if name == "gain":
        return value * unit / volt
    if name in PER_VOLT:
        return value / volt
    if name in VOLTAGES:
        return value * volt
    return value * unit if name == "saturation" else value


def _parameters(campaign, rng):
    """Lines of the job for the parameters."""
    several = len(campaign.parameters) > 1
    out = []
    for key, how in campaign.bounds.items():
        axis, _, name = key.rpartition(".")
        block = "lumped" if name in MECHANICS else BLOCKS.get(campaign.base, campaign.base)
        for each in [axis] if axis else campaign.measured:
            value = _in_units(name, campaign.parameters[each][name], campaign)
            if how == "fix":
                entry = f"value: {value:.6g}"
            elif isinstance(how, list):
                entry = f"bounds: [{how[0]:g}, {how[1]:g}]"
            else:
                entry = "bounds: [{:.6g}, {:.6g}]".format(*_limits(how, value, rng))
            out.append(f"  {f'{each}.' if several else ''}{block}.{name}: {{{entry}}}")
    for name, given in campaign.more.items():
        entry = f"bounds: [{given[0]:g}, {given[1]:g}]" if isinstance(given, list) else f"value: {given:g}"
        out.append(f"  {name}: {{{entry}}}")
    return ["parameters:", *out] if out else []


def _job(name, campaign, channels, seed, rng):
    lines = [f"# {campaign.title}", f"name: {name}", "records:"]
    for record in campaign.records:
        rate = "" if campaign.timed else f", sample_rate: {record.rate:g} Hz"
        settle = f", settle: {record.settle}" if record.settle else ""
        lines.append(f"  - {{file: {record.name}.{campaign.format}, use: {record.use}{rate}{settle}}}")
    lines.append("channels:")
    if campaign.timed:
        lines.append(f"  time: {channels['t']}")
    lines.append("  axes:")
    for axis in campaign.parameters:
        response = f", response: {channels[axis]}" if axis in campaign.measured else ""
        lines.append(f"    {axis}: {{drive: {channels[f'U{axis}']}{response}}}")
    lines.append(f"model: {campaign.model}")
    if campaign.effects:
        lines.append(f"effects: {campaign.effects}")
    lines += _parameters(campaign, rng)
    lines += ["optimizers:", *(f"  - {optimizer}" for optimizer in campaign.optimizers)]
    return "\n".join([*lines, f"repeats: {campaign.repeats}", f"seed: {seed}"]) + "\n"


def _truth(name, campaign):
    floor = math.sqrt(noise_size(name, campaign) ** 2 + campaign.counts**2 / 12)
    samples = sum(len(record.times) - record.ahead for record in campaign.records)
    known = {"noise_um": floor, "samples": samples, "records": len(campaign.records), "base": campaign.base}
    return truth(name, CAMPAIGNS[name], SIZES[name], known)


def write(name, out):
    """Make a campaign in out/name: rig/ with the job and its data, and last truth.json, all at once."""
    campaign, home = CAMPAIGNS[name].build(), Path(out) / name
    rig, seed = home / "rig", 700 + int(name[1:])
    rig.mkdir(parents=True, exist_ok=True)
    rng, size = np.random.default_rng(seed), noise_size(name, campaign)
    for number, record in enumerate(campaign.records):
        columns = _columns(campaign, number, size, rng)
        _save(rig / f"{record.name}.{campaign.format}", columns, campaign.format)
    (rig / "job.yaml").write_text(_job(name, campaign, _channels(columns, campaign.format), seed, rng))
    keep(home, _truth(name, campaign))
    return home
