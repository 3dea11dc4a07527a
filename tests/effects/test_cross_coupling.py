"""Stiffness coupling of two axes against equation 6 and the numbers of Lin & Lin (2012)."""

import numpy as np
import pytest
from scipy.signal import lsim, lti

import lin_lin
from pzt_ident.engine.simulator import simulate
from rig import candidates, model, record, response, triangle

CHAIN = ("bouc_wen", "cross_coupling", "lumped")
BOUC_WEN = {"gain": 0.08, "alpha": 0.4, "beta": 0.04, "gamma": -0.01}
RATIOS = {"x.cross_coupling.ratio": -0.046, "y.cross_coupling.ratio": 0.054}


def test_each_axis_gets_its_share_of_the_other():
    x, y = np.random.default_rng(1).normal(size=(2, 200))
    found = response(["cross_coupling"], RATIOS, x, y)
    np.testing.assert_allclose(found, [x - 0.046 * y, y + 0.054 * x], rtol=0, atol=1e-15)


def test_another_axis_at_rest_adds_nothing():
    x = triangle(130)
    np.testing.assert_array_equal(response(["cross_coupling"], RATIOS, x, 0 * x)[0], x)


def test_displacement_of_another_axis_comes_with_its_hysteresis():
    x, y = triangle(130), triangle(90)
    known = lin_lin.coupled(damping_ratio=0.5)
    both, one = response(CHAIN, known, x, y), response(CHAIN, known, x, 0 * y)
    other = response(CHAIN, known | {"y.cross_coupling.ratio": 0.0}, 0 * x, y)[1]
    np.testing.assert_allclose(both[0] - one[0], known["x.cross_coupling.ratio"] * other, rtol=0, atol=3e-5)


@pytest.mark.parametrize("item", ["displacement", "linear_displacement"])
def test_displacement_of_another_axis_comes_with_its_resonance(item):
    """Against a solver of its own: lsim of G2, with the other axis at rest on its first value."""
    x, y = triangle(130), triangle(90) + 5
    mode = {"ratio": 0.05, "frequency": 40.0, "damping": 0.1}
    known = {f"x.cross_coupling.{name}": value for name, value in mode.items()}
    known |= {f"y.cross_coupling.{name}": value for name, value in (mode | {"ratio": 0.0}).items()}
    known |= {f"{axis}.bouc_wen.{name}": value for axis in "xy" for name, value in BOUC_WEN.items()}
    both, alone = response(["bouc_wen", f"cross_coupling.{item}"], known, x, y), response(["bouc_wen"], known, x, y)
    pace = 2 * np.pi * 40
    other = alone[1] if item == "displacement" else BOUC_WEN["gain"] * y
    moved = lsim(lti([pace**2], [1, 2 * 0.1 * pace, pace**2]), other - other[0], 1e-3 * np.arange(y.size))[1] + other[0]
    np.testing.assert_allclose(both[0] - alone[0], 0.05 * moved, rtol=0, atol=1e-12)
    np.testing.assert_allclose(both[1], alone[1], rtol=0, atol=1e-14)


@pytest.mark.parametrize("word", ["amplitude_gain.running", "creep.voltage", "quadratic_gain", "saturation"])
def test_voltage_of_another_axis_is_no_voltage_of_this_one(word):
    """What acts on an axis' own voltage leaves the other's alone, whichever the job lists first."""
    x, y = triangle(130), triangle(90)
    chain = ["cross_coupling.voltage", word]
    made, other_way = model(*chain), model(*chain[::-1])
    theta = candidates(made, np.array([x, y]), 1, seed=3)
    for entry, value in zip(made.entries, theta.T, strict=True):
        value[:] = entry.parameter.null if entry.axis == 1 and entry.parameter.null is not None else value
    theta[:, made.names.index("x.cross_coupling.ratio")] = 0.05
    alone = theta.copy()
    alone[:, made.names.index("x.cross_coupling.ratio")] = 0
    drives = record(x, y)
    both, without = simulate(made, drives, theta)[0, 0], simulate(made, drives, alone)[0, 0]
    order = [made.names.index(name) for name in other_way.names]
    np.testing.assert_array_equal(simulate(other_way, drives, theta[:, order])[0, 0], both)
    np.testing.assert_allclose(both - without, 0.05 * y, rtol=0, atol=1e-9 * np.ptp(both))


def test_the_axis_that_is_pushed_rings_at_its_own_frequency():
    """What tells stiffness coupling from a kinematic one: it stands ahead of the mechanics."""
    step = np.where(np.arange(4000) < 10, 0.0, 10.0)
    known = lin_lin.coupled(damping_ratio=0.01)
    x = response(CHAIN, known, 0 * step, step, dt=1e-5)[0][10:]
    spectrum = np.abs(np.fft.rfft((x - x[-1]) * np.hanning(x.size)))
    natural = np.sqrt(lin_lin.COUPLED_X["lumped.stiffness"] / lin_lin.COUPLED_X["lumped.mass"]) / (2 * np.pi)
    assert np.argmax(spectrum) / (1e-5 * x.size) == pytest.approx(natural, rel=0.01)


def test_only_the_ratios_matter_to_slow_drives():
    known, time = lin_lin.coupled(damping_ratio=0.02), np.linspace(0, 2 * np.pi, 2000)
    drives = 65 * (1 - np.cos(time)), 45 * (1 - np.cos(2 * time))
    stiffer = known | {f"{axis}.{word}": 1.1 * known[f"{axis}.{word}"] for axis in "xy" for word in lin_lin.WORDS[:3]}
    np.testing.assert_allclose(response(CHAIN, stiffer, *drives), response(CHAIN, known, *drives), atol=1e-10)


@pytest.mark.parametrize("damping_ratio", [0, 0.02])
def test_both_triangles_at_once(damping_ratio):
    peaks = response(CHAIN, lin_lin.coupled(damping_ratio), triangle(130), triangle(90)).max(axis=1)
    assert peaks == pytest.approx([9.55, 10.26], abs=6e-3)


@pytest.mark.parametrize(
    ("sign", "x_band", "y_band"), [(1, (-1.10, 0.64), (-0.28, 0.77)), (-1, (-0.47, 0.85), (-0.28, 0.77))]
)
def test_open_loop_errors_of_case_3(sign, x_band, y_band):
    """x - x_d for the ramps of eq. 33 under U = x_d / d, the voltage coming a sample of 1 ms late."""
    known = lin_lin.coupled(damping_ratio=0.02)
    known["x.cross_coupling.ratio"] *= sign
    time = np.arange(2501) / 1000
    wanted = 10 * (time - 2 * np.maximum(time - 1, 0) + np.maximum(time - 2, 0))
    late = np.append(0, wanted[:-1])
    error = response(CHAIN, known, late / known["x.bouc_wen.gain"], late / known["y.bouc_wen.gain"]) - wanted
    assert [error.min(axis=1), error.max(axis=1)] == pytest.approx(np.transpose([x_band, y_band]), abs=8e-3)


def test_two_axes_on_one_guide_move_as_their_mass_and_stiffness_matrices_say():
    """Against a solver of its own, from rest under drives that are not zero; of second order in the step."""
    mass, stiffness, damping, ratio = (1.2, 0.9), (3e5, 2.6e5), (12.0, 9.0), (0.15, 0.18)
    known = {"lumped.mass": mass, "lumped.stiffness": stiffness, "lumped.damping": damping}
    known |= {"cross_coupling.ratio": ratio}
    named = {
        f"{axis}.{name}": value for name, values in known.items() for axis, value in zip("xy", values, strict=True)
    }
    pace, rate = (
        [k / m for k, m in zip(stiffness, mass, strict=True)],
        [b / m for b, m in zip(damping, mass, strict=True)],
    )
    system = [
        [0, 1, 0, 0],
        [-pace[0], -rate[0], pace[0] * ratio[0], 0],
        [0, 0, 0, 1],
        [pace[1] * ratio[1], 0, -pace[1], -rate[1]],
    ]
    forces = np.array([[0, 0], [pace[0], 0], [0, 0], [0, pace[1]]])
    errors = []
    for dt in (1e-4, 5e-5):
        time = np.arange(0, 0.4, dt)
        drives = np.array([40 * np.cos(2 * np.pi * 60 * time), 25 + 10 * np.sin(2 * np.pi * 85 * time)])
        begun = -np.linalg.solve(system, forces @ drives[:, 0])
        moved = lsim((system, forces, np.eye(4)[[0, 2]], np.zeros((2, 2))), drives.T, time, X0=begun)[1].T
        found = response(["lumped", "cross_coupling.stiffness"], named, *drives, dt=dt)
        errors.append(np.abs(found - moved).max() / np.ptp(moved))
    assert errors[0] < 2e-3
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)
