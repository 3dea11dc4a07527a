"""Draw cases: a stage, hidden effects of a wanted size, a sensor, the records, the job, and the sealed truth."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from scipy.signal import lfilter

from experiments.hidden_effect.campaign import CAMPAIGNS, Array, Drive
from experiments.hidden_effect.hidden import CATALOGUE, EFFECTS, OUTSIDE, Dose, respond
from experiments.hidden_effect.stage import Axis, Stage

KINDS = {"single": 1, "pair": 2, "triple": 3, "none": 0, "outside": 1, "loops": 1, "one_frequency": 1, "short": 1}
SIZES = (1.5, 50.0)  # noise floors
COARSE = 2e-5  # s, the step while a strength is searched
FITTED = ("gain", "alpha", "beta", "gamma")
GAPS = 0.1  # hours in the laboratory between records


@dataclass(frozen=True)
class Sensor:
    """White and first-order coloured noise in um, and the quantiser."""

    white: float
    coloured: float
    correlation: float
    quantum: float
    seed: int

    def read(self, x: Array, rate: float, index: int) -> Array:
        rng = np.random.default_rng([self.seed, index])
        keep = np.exp(-1 / (rate * self.correlation))
        start = self.coloured * rng.normal()
        drive = self.coloured * np.sqrt(1 - keep**2) * rng.normal(size=len(x))
        slow, _ = lfilter([1], [1, -keep], drive, zi=[keep * start])
        noisy = x + slow + self.white * rng.normal(size=len(x))
        return self.quantum * np.round(noisy / self.quantum)


@dataclass(frozen=True)
class Case:
    """Everything that makes the data of a case."""

    name: str
    kind: str
    campaign: str
    stage: Stage
    sensor: Sensor
    doses: list[Dose]

    def drives(self) -> list[Drive]:
        seed = int(self.name.rpartition("-")[2])
        return CAMPAIGNS[self.campaign](np.random.default_rng([seed, 1]))

    def response(self, drive: Drive, index: int, step: float = 5e-6) -> Array:
        return respond(self.stage, self.doses, drive, index, GAPS * index, step)


def draw_axis(rng: np.random.Generator) -> Axis:
    """Lin & Lin's X stage, mechanics within 20 %, damping ratio 0.01 to 0.05."""
    mass, stiffness = 0.1566 * rng.uniform(0.8, 1.2), 7.0028e7 * rng.uniform(0.8, 1.2)
    damping = 2 * 0.01 * 5 ** rng.uniform() * np.sqrt(mass * stiffness)
    hysteresis = (rng.uniform(*ends) for ends in ((0.06, 0.11), (0.3, 0.65), (0.01, 0.03), (0.03, 0.07)))
    return Axis(mass, damping, stiffness, *hysteresis)


def draw_sensor(rng: np.random.Generator) -> Sensor:
    sigma, share = 0.002 * 5 ** rng.uniform(), rng.uniform(0.2, 0.7)
    quantum = 0.0005 * 10 ** rng.uniform()
    correlation = 1e-3 * 20 ** rng.uniform()
    return Sensor(sigma * (1 - share) ** 0.5, sigma * share**0.5, correlation, quantum, int(rng.integers(2**31)))


class Bench:
    """Sizes of effects on the identify records of one stage, by the stage itself."""

    def __init__(self, stage: Stage, drives: Sequence[Drive], floor: float) -> None:
        self.stage, self.floor = stage, floor
        self.drives = [(i, drive) for i, drive in enumerate(drives) if drive.use == "identify"]
        self.plain = self.respond([])
        self.basis = self._basis()

    def respond(self, doses: list[Dose], stage: Stage | None = None) -> Array:
        stage = stage or self.stage
        parts = [respond(stage, doses, drive, i, GAPS * i, COARSE) for i, drive in self.drives]
        return np.concatenate(parts)

    def _basis(self) -> Array:
        """Orthonormal: an offset of each record, and the derivatives with respect to what is always fitted."""
        lengths = [len(drive.u_x) for _, drive in self.drives]
        columns = list(np.repeat(np.eye(len(lengths)), lengths, axis=0).T)
        for name in FITTED:
            value = getattr(self.stage.x, name)
            moved = self.stage._replace(x=self.stage.x._replace(**{name: 1.001 * value}))
            columns.append((self.respond([], moved) - self.plain) / 0.001)
        return np.linalg.qr(np.array(columns).T)[0]

    def project(self, difference: Array, others: Sequence[Array] = ()) -> Array:
        basis = np.linalg.qr(np.column_stack([self.basis, *others]))[0] if others else self.basis
        return difference - basis @ (basis.T @ difference)

    def size(self, difference: Array, others: Sequence[Array] = ()) -> float:
        return float(np.sqrt(np.mean(self.project(difference, others) ** 2))) / self.floor

    def scale(self, dose: Dose, wanted: float) -> tuple[Dose, float]:
        """The strength, up to the one given, at which the effect has the wanted size; and the size it has."""
        size = self.size(self.respond([dose]) - self.plain)
        low, high, slope = 0.0, dose.strength, 1.0
        for _ in range(14):
            if abs(size / wanted - 1) < 0.03 or (size < wanted and dose.strength == high):
                break
            low, high = (dose.strength, high) if size < wanted else (low, dose.strength)
            before, last = dose.strength, size
            guess = before * (wanted / size) ** (1 / slope) if size > 0 else 0.0
            ends = low + 0.03 * (high - low), high - 0.03 * (high - low)
            inside = min(ends) < guess < max(ends)
            dose = replace(dose, strength=guess if inside else (low + high) / 2)
            size = self.size(self.respond([dose]) - self.plain)
            if last > 0 < size != last:
                slope = float(np.clip(np.log(size / last) / np.log(dose.strength / before), 0.3, 6))
        return dose, size


def draw(kind: str, seed: int, effect: str | None = None) -> tuple[Case, dict[str, object]]:
    """A case of a kind and its truth; a draw that cannot be seen in the data is drawn again."""
    rng = np.random.default_rng([seed, list(KINDS).index(kind)])
    campaign = kind if kind in CAMPAIGNS else "rich"
    while True:
        x = draw_axis(rng)
        y = Axis(*(value * rng.uniform(0.9, 1.1) for value in x))
        case = Case(f"{kind}-{seed}", kind, campaign, Stage(x, y), draw_sensor(rng), [])
        bench = Bench(case.stage, case.drives(), noise_floor(case))
        chosen = [effect] if effect else _choose(rng, kind, seed)
        found = [_draw_dose(rng, bench, name) for name in chosen]
        case = replace(case, doses=[dose for dose, _ in found])
        joint = _joint(bench, case.doses)
        if all(size >= SIZES[0] for size in joint):
            return case, {"effects": [_entry(*pair, left) for pair, left in zip(found, joint, strict=True)]}


def _choose(rng: np.random.Generator, kind: str, seed: int) -> list[str]:
    """One after the other where every effect can be seen, else by chance."""
    names = list(OUTSIDE if kind == "outside" else CATALOGUE)
    if kind in ("single", "outside"):
        return [names[seed % len(names)]]
    return rng.choice(names, KINDS[kind], replace=False).tolist()


def _draw_dose(rng: np.random.Generator, bench: Bench, name: str) -> tuple[Dose, float]:
    hidden = EFFECTS[name]
    strength = hidden.most * rng.choice(hidden.signs)
    wanted = SIZES[0] * (SIZES[1] / SIZES[0]) ** rng.uniform()
    return bench.scale(Dose(name, float(strength), hidden.shape(rng)), wanted)


def _joint(bench: Bench, doses: list[Dose]) -> list[float]:
    """Size of each effect among the others, after a refit of these too."""
    whole = bench.respond(doses)
    own = [whole - bench.respond([other for other in doses if other is not dose]) for dose in doses]
    return [bench.size(part, [other for other in own if other is not part]) for part in own]


def _entry(dose: Dose, size: float, joint: float) -> dict[str, object]:
    unit = EFFECTS[dose.effect].unit
    return {**asdict(dose), "unit": unit, "size": size, "joint_size": joint}


def noise_floor(case: Case) -> float:
    """rms in um of noise and quantiser over the records."""
    errors = []
    for i, drive in enumerate(case.drives()):
        x = case.stage.x.gain * drive.u_x
        errors.append(case.sensor.read(x, drive.rate, i) - x)
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))


def write(case: Case, truth: dict[str, object], out: Path) -> None:
    """The records and the job into cases/NAME, the truth into sealed/NAME.json."""
    folder = out / "cases" / case.name
    folder.mkdir(parents=True, exist_ok=True)
    records, errors = [], []
    for i, drive in enumerate(case.drives()):
        x = case.response(drive, i)
        read = case.sensor.read(x, drive.rate, i)
        errors.append(read - x)
        write_record(folder / f"{drive.name}.csv", drive, read)
        records.append(f"  - {{file: {drive.name}.csv, use: {drive.use}}}")
    (folder / "job.yaml").write_text(job(case, records), encoding="utf-8")
    floor = float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))
    sealed = {
        "name": case.name,
        "kind": case.kind,
        "campaign": case.campaign,
        "noise_floor": floor,
        "sensor": asdict(case.sensor),
        "x": case.stage.x._asdict(),
        "y": case.stage.y._asdict(),
        **truth,
    }
    (out / "sealed").mkdir(exist_ok=True)
    (out / "sealed" / f"{case.name}.json").write_text(json.dumps(sealed, indent=1) + "\n", encoding="utf-8")


def write_record(path: Path, drive: Drive, x: Array) -> None:
    rows = np.column_stack([drive.time, drive.u_x, drive.u_y, x])
    header = "time [s],u_x [V],u_y [V],x [um]"
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt=["%.10g", "%.9g", "%.9g", "%.7g"])


def job(case: Case, records: list[str]) -> str:
    lines = [f"name: {case.name}", "records:", *records, "channels:", '  time: "time [s]"', "  axes:"]
    lines += ['    x: {drive: "u_x [V]", response: "x [um]"}', '    y: {drive: "u_y [V]"}']
    lines += ["model: [bouc_wen, lumped]", "effects: []", "parameters:  # mechanics from the data sheet"]
    for word, unit in (("mass", "kg"), ("damping", "N s/m"), ("stiffness", "N/m")):
        for name, axis in (("", case.stage.x), ("y.", case.stage.y)):
            lines.append(f"  {name}lumped.{word}: {{value: {getattr(axis, word):.9g}}}  # {unit}")
    lines += ["optimizers:", "  - {name: least_squares, budget: 2000}", "repeats: 1", "seed: 7"]
    return "\n".join(lines) + "\n"


def opened(path: Path) -> Case:
    """The case again, out of its sealed truth."""
    truth = json.loads(path.read_text(encoding="utf-8"))
    doses = [Dose(entry["effect"], entry["strength"], entry["shape"]) for entry in truth["effects"]]
    stage = Stage(Axis(**truth["x"]), Axis(**truth["y"]))
    return Case(truth["name"], truth["kind"], truth["campaign"], stage, Sensor(**truth["sensor"]), doses)
