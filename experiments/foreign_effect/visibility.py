"""What a model without an effect leaves of it: simulated with and without, less what the model's parameters take up."""

import math
from copy import deepcopy

import numpy as np
from scipy.special import erf

from .campaign import floor
from .operators import everett_table, plays, preisach_density
from .stage import Axis, simulate

FINE = {"amplifier_lag": 8, "sensor_lag": 2, "delay": 4, "slew_limit": 16, "resonance": 2, "amplitude_gain": 4}
PER_PERIOD, MOST_AT_FIRST = 8, 32
SETTLED, MOST_STEPS = 0.1, 128  # noise floors by which twice as many steps to a sample may move readings; steps
HELD = {"bouc_wen": ("gain", "alpha", "beta", "gamma")}
HELD["preisach"] = HELD["free_energy"] = ("gain", "remanence", "coercive", "spread", "interaction")


class Unsettled(Exception):
    """A motion that a fixed step of time does not hold."""


class Rig:
    """The stage of a case, and the directions that the parameters of the user's model can take up."""

    def __init__(self, case):
        self.case, self.axes = case, case["axes"]
        self.records = case["records"]
        self.floor = floor(case["sensor"])
        self.offsets = np.cumsum([0, *(r.samples for r in self.records)])
        self.least = 3.0

    def _fine(self, record, effects):
        """Steps to a sample: more where something is quick against it, and PER_PERIOD in one of the fastest mode, whose
        response to a kink between two steps is that to another one."""
        fine = max([1 if self.axes["x"].base["kind"] == "preisach" else 2, *(FINE.get(e, 1) for e in effects)])
        entry = effects.get("friction", {})
        if self.axes["x"].modes and ("cubic_stiffness" in effects or "inside" in entry.get("form", "")):
            fine = max(fine, math.ceil(2 * math.pi * self.axes["x"].modes[0][0] / record.rate / 0.1))
        fastest = max((mode[0] for axis in self.axes.values() for mode in axis.modes), default=0.0)
        return min(max(fine, math.ceil(PER_PERIOD * fastest / record.rate)), MOST_AT_FIRST)

    def settled_reading(self, i, record):
        """Clean readings of record number i in so many steps to a sample that half of them move none by SETTLED floors,
        root mean square. Raises Unsettled where MOST_STEPS do not suffice."""
        fine = self._fine(record, self.axes["x"].effects)
        coarse = self.reading(i, record, fine=fine)
        while (fine := 2 * fine) <= MOST_STEPS:
            reading = self.reading(i, record, fine=fine)
            moved = [np.sqrt(np.mean((reading[axis] - coarse[axis]) ** 2)) for axis in reading]
            if max(moved) < SETTLED * self.floor:
                return reading
            coarse = reading
        raise Unsettled(f"{MOST_STEPS} steps to a sample do not hold record {i}")

    def reading(self, i, record, axes=None, fine=None):
        """Clean readings of record number i, in so many steps to a sample, by default as many as are enough to size an
        effect."""
        axes = axes or self.axes
        fine = fine or self._fine(record, axes["x"].effects)
        return simulate(axes, record.run, 1 / record.rate, fine, i, self.case["noise_seed"], record.lead)

    def readings(self, axes=None):
        """Clean readings of all records."""
        return [self.reading(i, record, axes) for i, record in enumerate(self.records)]

    def trace(self, axes=None):
        """Clean readings of x, end to end."""
        axes = axes or {"x": self.axes["x"]}
        return np.concatenate([r["x"] for r in self.readings(axes)])

    def _moved(self, key, factor):
        base = dict(self.axes["x"].base)
        base[key] = base[key] * factor
        return {"x": Axis(base, self.axes["x"].modes)}

    def hold_base(self):
        """An orthonormal basis of what the parameters of the job's model and an offset a record take up."""
        still = {"x": Axis(self.axes["x"].base, self.axes["x"].modes)}
        self.rest = self.trace(still)
        self.basis = self.span(self._base_directions() + self._mode_directions())
        self._quieten()

    def span(self, columns):
        """An orthonormal basis of traces and of an offset a record."""
        columns = list(columns)
        for a, b in zip(self.offsets[:-1], self.offsets[1:], strict=True):
            column = np.zeros(len(self.rest))
            column[a:b] = 1.0
            columns.append(column)
        matrix = np.column_stack(columns)
        return np.linalg.qr(matrix / np.linalg.norm(matrix, axis=0))[0]

    def _base_directions(self):
        """Changes of the base's own parameters."""
        kind, columns = self.axes["x"].base["kind"], []
        if kind == "plays":
            columns += self._play_directions()
        for key in HELD.get(kind, ()):
            columns.append(self.trace(self._moved(key, 1.01)) - self.rest)
        return columns

    def _play_directions(self):
        """Eight plays up to the reach, as in a model of eight, and a change of the reach."""
        base, modes, out = self.axes["x"].base, self.axes["x"].modes, []
        for i in range(9):
            weights = [1.0 if j + 1 == i else 0.0 for j in range(8)]
            grid = {"kind": "plays", "gain": 1.0 if i == 0 else 0.0, "weights": weights}
            grid["widths"] = [base["reach"] * (j + 1) / 8 for j in range(8)]
            out.append(self.trace({"x": Axis(grid, modes)}))
        wider = base | {"widths": [1.01 * w for w in base["widths"]]}
        return [*out, self.trace({"x": Axis(wider, modes)}) - self.rest]

    def _mode_directions(self):
        """Changes of frequency and damping of the modes, where the job leaves them open."""
        out, x, fixed = [], self.axes["x"], self.case["truth"]
        if "load_mass" in fixed or "viscous_damping" in fixed:
            changes = [(0, 1)] if "viscous_damping" not in fixed else []
        else:
            changes = [(i, j) for i in range(len(x.modes)) for j in (0, 1)]
        for i, j in changes:
            modes = [list(m) for m in x.modes]
            modes[i][j] *= 1.003 if j == 0 else 1.05
            out.append(self.trace({"x": Axis(x.base, [tuple(m) for m in modes])}) - self.rest)
        return [c for c in out if np.linalg.norm(c) > 0]

    def _quieten(self):
        """Raise the noise where the user's kind of model cannot hold the base itself."""
        base, left = self.axes["x"].base, 0.0
        if base["kind"] == "plays":
            left = np.sqrt(np.mean(self.project(self.rest) ** 2))
        elif base.get("law") == "normal":
            left = self._free_density_left()
        if left > 0.5 * self.floor:
            self.case["sensor"]["sigma"] *= 2 * left / self.floor
            self.case["sensor"]["count"] = 0.0
            self.floor = floor(self.case["sensor"])

    def _free_density_left(self):
        """What 22 coercive fields on an even grid leave of a Preisach operator, by linear least squares."""
        base = self.axes["x"].base
        reach = base["coercive"] * (1 + 3 * base["spread"])
        fields = reach * (np.arange(22) + 0.5) / 22
        worst = 0.0
        for record in self.records:
            u = record.run["x"]
            columns = erf(plays(u, fields) / math.sqrt(2) / base["interaction"])
            columns = np.column_stack([u, np.ones(len(u)), columns])
            table = {k: v for k, v in base.items() if k != "gain"}
            goal = preisach_density(u, 0.0, _table(table))
            columns, goal = columns[record.lead :], goal[record.lead :]
            found = np.linalg.lstsq(columns, goal, rcond=1e-9)[0]
            worst = max(worst, float(np.sqrt(np.mean((goal - columns @ found) ** 2))))
        return worst

    def project(self, residual):
        """What no parameter of the user's model takes up."""
        return residual - self.basis @ (self.basis.T @ residual)

    def put(self, effect, entry):
        """The effect in the stage; what one amplifier, sensor and room do to x they do to a measured y as well."""
        self.axes["x"].effects[effect] = entry
        if "y" in self.axes and effect not in ("cross_coupling", "kinematic_coupling", "outside"):
            self.axes["y"].effects[effect] = deepcopy(entry)

    def scale(self, effect, entry, low, high, target):
        """Find the size that leaves `target` noise floors; the signature, or None where no plausible size does."""
        size = math.sqrt(low * high)
        for _ in range(7):
            entry["size"] = float(entry["sign"] * size)
            trial = {name: Axis(a.base, a.modes) for name, a in self.axes.items()}
            trial["x"].effects = {effect: entry}
            needs_other = effect in ("cross_coupling", "kinematic_coupling")
            trace = self.trace(trial if needs_other else {"x": trial["x"]})
            if not np.all(np.isfinite(trace)):
                return None
            signature = self.project(trace - self.rest)
            left = float(np.sqrt(np.mean(signature**2))) / self.floor
            if abs(math.log(max(left, 1e-9) / target)) < 0.15:
                break
            following = float(np.clip(size * (target / max(left, 1e-9)), max(low, size / 8), min(high, size * 8)))
            if following == size:
                break
            size = following
        seen = self.seen(signature)
        uses = {r.use for r, share in zip(self.records, seen, strict=True) if share > 1.5}
        return signature if self.least <= left <= 60.0 and uses == {"identify", "validate"} else None

    def seen(self, signature):
        """Noise floors left in each record."""
        parts = (signature[a:b] for a, b in zip(self.offsets[:-1], self.offsets[1:], strict=True))
        return [round(float(np.sqrt(np.mean(part**2))) / self.floor, 2) for part in parts]


def _table(base):
    return everett_table(**{k: base[k] for k in ("remanence", "coercive", "spread", "interaction", "law", "reach")})


def apart(one, two, least):
    """Whether each of two signatures leaves `least` (rms) beside the other."""
    cosine = abs(float(one @ two)) / math.sqrt(float(one @ one) * float(two @ two))
    beside = math.sqrt(max(1 - cosine**2, 0.0) / len(one))
    return cosine < 0.9 and beside * min(np.linalg.norm(one), np.linalg.norm(two)) >= least
