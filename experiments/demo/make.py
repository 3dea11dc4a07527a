"""Make the measurement that `pzt-ident demo` ships: records of a stage that shares no code with the package, with two
hidden effects, a job that knows of none, and the truth, apart."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from experiments.hidden_effect.campaign import Drive, Track
from experiments.hidden_effect.cases import Sensor
from experiments.hidden_effect.hidden import EFFECTS, Dose, respond
from experiments.hidden_effect.stage import Axis, Stage

RATE = 200  # Hz
STAGE = Axis(mass=0.1566, damping=120.0, stiffness=7.0028e7, gain=0.082, alpha=0.48, beta=0.018, gamma=0.05)
SENSOR = Sensor(white=0.004, coloured=0.003, correlation=4e-3, quantum=0.001, seed=11)
HIDDEN = [Dose("creep", 0.012, {}), Dose("quadratic_gain", 6e-5, {})]
FOLDER = Path(__file__).parents[2] / "pzt_ident" / "job" / "examples" / "demo"


def drives() -> list[Drive]:
    """Nested loops, steps and holds to identify; other loops, speeds and holds to validate."""
    first = Track(RATE).rest(1).triangles(120, 20, 100, 40, 80, 40, 100, 0, speed=160)
    first.ramp(0.1, x=90).rest(2.5).ramp(0.1, x=30).rest(2).ramp(0.2, x=0).rest(1.5)
    other = Track(RATE).rest(1).triangles(70, 10, 140, 50, 110, 0, speed=220).sine(1.5, 3, x=30)
    other.ramp(0.1, x=110).rest(2).ramp(0.2, x=50).rest(1.5).ramp(0.3, x=0).rest(1)
    return [first.drive("identify", "identify"), other.drive("validate", "validate")]


def main() -> None:
    for index, drive in enumerate(drives()):
        x = respond(Stage(STAGE, STAGE), HIDDEN, drive, index, 0.1 * index, 5e-6)
        rows = np.column_stack([drive.time, drive.u_x, SENSOR.read(x, RATE, index)])
        file = FOLDER / f"{drive.name}.csv"
        np.savetxt(file, rows, "%.7g", ",", header="time [s],u_x [V],x [um]", comments="")
        print(file.name, len(rows), "samples")
    truth = [{"effect": dose.effect, "strength": dose.strength, "unit": EFFECTS[dose.effect].unit} for dose in HIDDEN]
    (FOLDER / "hidden.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
