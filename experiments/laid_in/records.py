"""The measurements that effects are laid into: the jobs of other experiments, their responses in files of our own."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.signal import resample

from experiments.laid_in.effects import Array, Response

HERE = Path(__file__).parents[1]
VARIABLE = "${PZT_IDENT_DATA}/"


def data() -> Path:
    return Path(os.environ["PZT_IDENT_DATA"])


@dataclass(frozen=True)
class Record:
    """job: of which experiment; unit: what sizes are counted in, um; hints: what an effect needs besides its size, the
    effects without one are not laid in; read: responses; write: a folder with those given in their place."""

    job: str
    unit: float
    sizes: tuple[int, ...]
    hints: dict[str, float]
    read: Callable[[], list[Response]]
    write: Callable[[Path, list[Array]], None]
    edits: dict[str, str] = field(default_factory=dict)

    def text(self) -> str:
        """The job with the data beside it."""
        found = (HERE / self.job).read_text(encoding="utf-8").replace(VARIABLE, "")
        for old, new in self.edits.items():
            found = found.replace(old, new)
        return found


BENDER = "piezo_bender_1hz/hysteresis_v_150_1hz.csv"


def read_bender() -> list[Response]:
    table = np.loadtxt(data() / BENDER, delimiter=",", usecols=(1, 2, 3))
    return [Response(table[:, 1], 2e-4, rest=5000, scored=slice(21000, None))]


def write_bender(folder: Path, responses: list[Array]) -> None:
    lines = (data() / BENDER).read_text().splitlines()
    split = [line.split(",") for line in lines]
    rows = [f",{row[1]},{value:.9g},{row[3]}" for row, value in zip(split, responses[0], strict=True)]
    put(folder / BENDER, rows)


STACK = ("picma_stack_minor_loops/Model_Vi_Do.dat", "picma_stack_minor_loops/Test_Vi_Do_Di.dat")


def read_stack() -> list[Response]:
    scored = (slice(200, None), slice(200, 5070))
    tables = [np.loadtxt(data() / name)[:, 4] for name in STACK]
    return [Response(values, 5e-3, scored=part) for values, part in zip(tables, scored, strict=True)]


def write_stack(folder: Path, responses: list[Array]) -> None:
    for name, values in zip(STACK, responses, strict=True):
        rows = [line.split() for line in (data() / name).read_text().splitlines() if line.strip()]
        for row, value in zip(rows, values, strict=True):
            row[4] = f"{value:.9g}"
        put(folder / name, ["\t".join(row) for row in rows])


CAPACITOR = [
    f"thinfilm_forc_rate/linear_cap_2p2nF_freqs/2.2nF discrete cap {100 * i}Hz 3V 1Average Table{i}.tsv"
    for i in range(4, 11)
]


def read_capacitor() -> list[Response]:
    out = []
    for name in CAPACITOR:
        table = np.loadtxt(data() / name, skiprows=1)
        out.append(Response(table[:, 4], float(np.median(np.diff(table[:, 0])))))
    return out


def write_capacitor(folder: Path, responses: list[Array]) -> None:
    for name, values in zip(CAPACITOR, responses, strict=True):
        header, *lines = (data() / name).read_text().splitlines()
        rows = [line.split("\t") for line in lines if line.strip()]
        for row, value in zip(rows, values, strict=True):
            row[4] = f"{value:.9e}"
        put(folder / name, [header, *("\t".join(row) for row in rows)])


MIRROR = ("100mV_train", "200mV_train", "300mV_train", "100mV_test", "300mV_test")
COARSE = 8  # to 800 Hz: period by period, since each is one of a steady state


def coarse(kind: str, name: str) -> Array:
    found = np.load(data() / "fsm_piezo_mimo" / f"{kind}_{name}.npy")
    return resample(found, found.shape[0] // COARSE, axis=0)


def read_mirror() -> list[Response]:
    out = []
    for name in MIRROR:
        values = 1e6 * coarse("y", name)
        out += [Response(column, COARSE / 6400, periodic=True) for column in values.reshape(values.shape[0], -1).T]
    return out


def write_mirror(folder: Path, responses: list[Array]) -> None:
    left = list(responses)
    (folder / "fsm_piezo_mimo").mkdir(parents=True, exist_ok=True)
    for name in MIRROR:
        drive = coarse("u", name)
        columns = [left.pop(0) for _ in range(int(np.prod(drive.shape[1:])))]
        np.save(folder / "fsm_piezo_mimo" / f"u_{name}.npy", drive)
        np.save(folder / "fsm_piezo_mimo" / f"y_{name}.npy", 1e-6 * np.array(columns).T.reshape(drive.shape))


def put(path: Path, lines: list[str]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


RECORDS = {
    "bender": Record(
        "piezo_bender/missing.yaml",
        0.050,
        (5, 15, 50),
        {"lag": 0, "delay": 0, "creep": 0.5, "drift": 15, "hum": 50.02, "encoder": 8, "bend": 0},
        read_bender,
        write_bender,
    ),
    "stack": Record(
        "picma_stack/missing.yaml",
        0.060,
        (5, 15),
        {"lag": 0, "delay": 0, "creep": 4, "drift": 20, "hum": 50.02, "encoder": 8, "bend": -96.6},
        read_stack,
        write_stack,
    ),
    "capacitor": Record(
        "capacitor/linear.yaml",
        7e-4,
        (5, 15, 50),
        {"lag": 0, "delay": 0, "drift": 0, "encoder": 0.3, "bend": 0},
        read_capacitor,
        write_capacitor,
    ),
    "mirror": Record(
        "steering_mirror/below_400_hz.yaml",
        0.0031,
        (15, 50),
        {"lag": 0, "delay": 0, "creep": 0.1, "hum": 50, "encoder": 0.8, "bend": 0},
        read_mirror,
        write_mirror,
        {"sample_rate: 6400 Hz, decimate: 8": "sample_rate: 800 Hz"},
    ),
}
