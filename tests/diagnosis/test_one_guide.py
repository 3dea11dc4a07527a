"""Two axes whose guide moves both, simulated by a solver of its own, and the model of two stages apart."""

from dataclasses import replace

import numpy as np
from scipy.signal import lsim

import rig
import stage
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.staircase import improve
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.model.registry import blocks, word_of

DT, NOISE = 2e-4, 5e-3
GAIN = {"bouc_wen.gain": 0.1, "bouc_wen.alpha": 0.3, "bouc_wen.beta": 0.05, "bouc_wen.gamma": -0.01}
MASS, STIFFNESS, DAMPING, SHARE = (0.3, 0.4), (9e4, 1.4e5), (12.0, 15.0), (0.06, 0.05)


def system():
    """Modes at 85 and 96 Hz, which the guide moves apart."""
    pace, rate = np.divide(STIFFNESS, MASS), np.divide(DAMPING, MASS)
    moved = [
        [0, 1, 0, 0],
        [-pace[0], -rate[0], pace[0] * SHARE[0], 0],
        [0, 0, 0, 1],
        [pace[1] * SHARE[1], 0, -pace[1], -rate[1]],
    ]
    return moved, [[0, 0], [pace[0], 0], [0, 0], [0, pace[1]]], np.eye(4)[[0, 2]], np.zeros((2, 2))


def chirp(low, high, reach, start):
    t = DT * np.arange(3000)
    wave = np.sin(2 * np.pi * (low + (high - low) * t / t[-1] / 2) * t + start) - np.sin(start)
    return 50 * np.minimum(1, t / 0.02) + reach * wave


def two_on_one_guide():
    rng, made = np.random.default_rng(5), []
    known = {f"{axis}.{name}": value for axis in "xy" for name, value in GAIN.items()}
    for use, x, y in (
        ("identify", chirp(2, 30, 40, 0), chirp(40, 160, 20, 0)),
        ("identify", chirp(50, 150, 20, 1), chirp(1, 15, 40, 0)),
        ("validate", chirp(20, 120, 20, 0), chirp(120, 30, 25, 1)),
    ):
        force = rig.response(["bouc_wen"], known, x, y, dt=DT)
        response = lsim(system(), force.T, DT * np.arange(x.size))[1].T + rng.normal(0, NOISE, force.shape)
        record = rig.record(x, y, response=[*response], dt=DT)
        made.append(replace(record, use=use, name=f"{use} {len(made)}", response_units=("um", "um")))
    masses = dict(zip(("x.lumped.mass", "y.lumped.mass"), MASS, strict=True))
    return Case(("bouc_wen", "lumped"), (), made, stage.specs(masses))


def test_a_guide_that_two_axes_share_is_one_coupling_and_no_second_mode():
    case = stage.considering(two_on_one_guide(), "cross_coupling", "kinematic_coupling", "resonance")
    found = improve(case, first_fit(case, 0))
    end = found.steps[-1].fit
    assert found.last.verdict == "adequate" and [*map(word_of, end.effects)] == ["cross_coupling"]
    assert blocks[end.effects[0]] is blocks["cross_coupling.stiffness"]
    ratios = [end.values[f"{axis}.cross_coupling.ratio"] for axis in "xy"]
    np.testing.assert_allclose(ratios, SHARE, rtol=0.05)
