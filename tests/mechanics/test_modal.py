"""Modes of several axes against one dense system, the transfer matrix, and the other mechanics."""

import numpy as np
import pytest

from pzt_ident.engine.simulator import simulate
from pzt_ident.errors import InputError
from pzt_ident.job.schema import Job
from pzt_ident.model.registry import blocks
from rig import model, record, response
from twins import lumped_twin, modal_twin, rod_twin

FREQUENCY, DAMPING = np.array([700.0, 900.0, 2100.0]), np.array([0.01, 0.05, 0.3])
PUSH = np.array([[1.0, 1.0, 1.0], [0.4, -2.0, 1.5], [-0.7, 0.1, 3.0]])
SHAPE = np.array([[0.6, 0.3, -0.1], [-0.2, 0.5, 0.4], [0.0, 1.0, 0.2]])
DT = 1 / 6400


def parameters(axes=3, modes=3, **other):
    """By name: of the stage, of each axis, and the push of the axes after the first."""
    known = {"frequency": FREQUENCY, "damping": DAMPING} | other
    named = {f"modal.{word}_{i + 1}": known[word][i] for word in ("frequency", "damping") for i in range(modes)}
    for a in range(axes):
        prefix = f"{'xyz'[a]}." if axes > 1 else ""
        for i in range(modes):
            named[f"{prefix}modal.shape_{i + 1}"] = SHAPE[a, i]
            if a > 0:
                named[f"{prefix}modal.push_{i + 1}"] = PUSH[a, i]
    return named


def moved(forces, known=None, modes=3, chain=(), **more):
    found = response([blocks["modal"].make(modes=modes), *chain], known or parameters(len(forces)), *forces, **more)
    return np.atleast_2d(found)


def walks(axes, samples=300):
    return np.random.default_rng(axes).normal(size=(axes, samples)).cumsum(axis=1)


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_modes_of_all_axes_are_one_system(axes):
    expected = modal_twin.modal(walks(axes), DT, FREQUENCY, DAMPING, PUSH[:axes], SHAPE[:axes])
    np.testing.assert_allclose(moved(walks(axes), dt=DT), expected, rtol=0, atol=1e-11)


def test_one_mode_of_one_axis_is_lumped_mechanics():
    omega = 2 * np.pi * FREQUENCY[0]
    expected = lumped_twin.lumped(walks(1)[0], DT, 1.0, 2 * DAMPING[0] * omega, omega**2)
    found = moved(walks(1), parameters(1, 1) | {"modal.shape_1": 1.0}, 1, dt=DT)
    np.testing.assert_allclose(found[0], expected, rtol=0, atol=1e-12)


def test_at_rest_it_holds_the_static_gains():
    """y = sum_i shape_i push_i^T f."""
    forces = np.array([[2.0], [-1.0], [0.5]]) * np.ones(50)
    np.testing.assert_allclose(moved(forces, dt=DT), SHAPE @ PUSH.T @ forces, rtol=1e-13)


def test_a_sine_on_one_axis_comes_out_with_its_column_of_the_transfer_matrix():
    hertz, dt = 850.0, 1e-5
    t = dt * np.arange(40000)
    forces = np.zeros((3, t.size))
    forces[1] = np.sin(2 * np.pi * hertz * t)
    settled, last = moved(forces, dt=dt)[:, 30588:], t[30588:]  # eight whole periods of 850 Hz in 100 / 850 s
    settled, last = settled[:, :9400], last[:9400]
    found = 2j * np.mean(settled * np.exp(-2j * np.pi * hertz * last), axis=1)
    r = hertz / FREQUENCY
    expected = SHAPE @ (PUSH[1] / (1 - r**2 + 2j * DAMPING * r))
    np.testing.assert_allclose(found, expected, atol=3e-3 * np.abs(expected).max())


def test_an_axis_that_is_not_measured_neither_moves_nor_pushes():
    made = model(blocks["modal"].make(modes=2), axes=2, measured=[0])
    assert made.names == tuple(f"modal.{word}_{i}" for word in ("frequency", "damping", "shape") for i in (1, 2))
    theta = np.array([[700.0, 900.0, 0.01, 0.05, 0.6, 0.3]])
    one, two = (simulate(made, record(walks(1)[0], other, dt=DT), theta) for other in (walks(1)[0], 0 * walks(1)[0]))
    np.testing.assert_array_equal(one, two)


def test_a_second_mode_beside_them_is_driven_by_each_axis_force():
    """Its share of y_a comes from f_a, kept from before the modes."""
    known = parameters(2) | {
        f"{a}.resonance.{word}": value
        for a in "xy"
        for word, value in {"share": 0.2, "frequency": 1500.0, "damping": 0.02}.items()
    }
    omega = 2 * np.pi * 1500
    beside = [lumped_twin.lumped(force, DT, 1.0, 0.04 * omega, omega**2) for force in walks(2)]
    expected = 0.8 * moved(walks(2), dt=DT) + 0.2 * np.array(beside)
    found = moved(walks(2), known, chain=["resonance"], dt=DT)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11)


def test_a_rod_in_modal_coordinates_is_the_rod():
    """The elements of a rod with damping in proportion: share of each mode as the shape, the static gain its sum."""
    rod = {"density": 7600.0, "area": 1e-4, "length": 0.06, "modulus": 7e10, "viscosity": 1e5}
    rod |= {"end_mass": 0.05, "end_damping": 0.0, "end_stiffness": 0.0}
    mass, _, stiffness = rod_twin.matrices(4, rod)
    squares, shapes = np.linalg.eig(np.linalg.solve(mass, stiffness))
    omega = np.sqrt(squares)
    share = shapes[-1] * np.linalg.solve(shapes, np.linalg.solve(mass, np.eye(4)[-1])) / squares
    share *= rod["modulus"] * rod["area"] / rod["length"]
    known = {f"modal.frequency_{i + 1}": omega[i] / (2 * np.pi) for i in range(4)}
    known |= {f"modal.damping_{i + 1}": omega[i] * 1e5 / 7e10 / 2 for i in range(4)}
    known |= {f"modal.shape_{i + 1}": share[i] for i in range(4)}
    expected = response([blocks["rod"].make(elements=4)], {f"rod.{k}": v for k, v in rod.items()}, walks(1)[0], dt=1e-5)
    np.testing.assert_allclose(moved(walks(1), known, 4, dt=1e-5)[0], expected, rtol=0, atol=1e-10)


JOB = """
records: [{file: a.csv}]
channels:
  axes: {x: {drive: "u [V]", response: "x [um]"}, y: {drive: "v [V]", response: "y [um]"}}
model: [bouc_wen, {name: modal, modes: 3}]
parameters:
  bouc_wen.gain: {value: 1}
  modal.frequency_3: {bounds: [1000, 2000]}
  y.modal.push_1: {bounds: [-1, 1]}
  modal.shape_2: {bounds: [0, 1]}
"""


def test_a_job_names_modes_of_the_stage_and_of_an_axis():
    assert "modal.frequency_3" in Job.from_text(JOB).parameters


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("modal.frequency_4", "'modal' has no parameter 'frequency_4'"),
        ("y.modal.frequency_1", "belongs to the whole stage, not to an axis\n  write modal.frequency_1"),
        ("x.modal.push_1", "is relative to that of the first axis"),
    ],
)
def test_a_job_cannot_name_what_is_not_there(name, said):
    with pytest.raises(InputError, match=said):
        Job.from_text(JOB.replace("y.modal.push_1", name))
