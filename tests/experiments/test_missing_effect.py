"""A slice of what an inverse is worth on a stage that shares nothing with the package."""

import numpy as np

from experiments.hidden_effect.stage import Axis, Stage, simulate
from experiments.missing_effect import tracking
from pzt_ident.api.drive import drive
from pzt_ident.control.identified import Identified
from rig import model

X = Axis(gain=0.082, alpha=0.56, beta=0.015, gamma=0.055, mass=0.157, damping=66.0, stiffness=7e7)


def identified(words, **values):
    chain = model("bouc_wen", "lumped", *words)
    parameters = {f"bouc_wen.{word}": getattr(X, word) for word in ("alpha", "beta", "gamma")}
    parameters |= {f"lumped.{word}": getattr(X, word) for word in ("mass", "damping", "stiffness")}
    parameters |= {"bouc_wen.gain": 1e-6 * X.gain} | values
    theta = np.array([parameters[name] for name in chain.names])
    blank = ("1",) * len(theta), (None,) * len(theta)
    return Identified("x", chain, theta, *blank, 1e-3, np.array([[0.0, 130.0]]), ("V",), ("um",), (20.0,))


def followed(one):
    """Largest error in um of the stage with an amplifier of 2 ms under the drive of a model."""
    time, x, _ = tracking.reference()
    time, x = time[9000:12000] - time[9000], x[9000:12000]
    voltage = drive(one, time, x).drive["x"]
    moved = simulate(Stage(X, X, amplifier_lag=2e-3), time, voltage, np.zeros_like(voltage))
    return np.abs(moved - moved[0] - (x - x[0])).max()


def test_an_inverse_with_the_lag_leaves_a_fraction():
    without, with_lag = identified([]), identified(["amplifier_lag"], **{"amplifier_lag.tau": 2e-3})
    assert followed(with_lag) < 0.05 * followed(without)


def test_the_table_says_medians_and_ranges():
    row = {"effect": "creep", "named": ["creep"], "noise": 4e-3}
    row |= {way: {"rmse": size} for way, size in zip(tracking.WAYS, (0.6, 0.03, 3e-4), strict=True)}
    assert "| creep | 2 | 2 | 600 (600 to 600) |" in tracking.table([row, row])
