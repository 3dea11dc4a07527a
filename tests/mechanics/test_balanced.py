"""Reduced rod and shell against the whole ones, within the bound of balanced truncation."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import expm

from pzt_ident.errors import InputError
from pzt_ident.mechanics import _balanced, _linear, _rod, _shell
from pzt_ident.model.registry import blocks
from rig import response

ROD = {
    "density": 7600.0,
    "area": 1e-4,
    "length": 0.06,
    "modulus": 7e10,
    "viscosity": 1e5,
    "end_mass": 0.05,
    "end_damping": 0.0,
    "end_stiffness": 0.0,
}
SOFT = ROD | {"end_mass": 2e-3, "end_damping": 50.0, "end_stiffness": 3e7}
TABLE_1 = ROD | {"area": 2.5e-5, "length": 0.02, "viscosity": 5e6, "end_mass": 4.015, "end_damping": 440.0}
TUBE = {"density": 7600.0, "modulus": 7.1e10, "viscosity": 1e5, "length": 0.0396, "end_mass": 0.0}
TUBE |= {"radius": 0.0056, "thickness": 0.0015, "poisson": 0.3}


def rod(given=ROD, elements=30):
    end = np.eye(elements)[-1]
    own = SimpleNamespace(**given, load=0.0, extra_damping=0.0, elements=elements)
    return *_rod.matrices(own), end, end


def shell(harmonic):
    return _shell.matrices(SimpleNamespace(**TUBE, load=0.0, elements=10, harmonic=harmonic))


SYSTEMS = {"rod": rod(), "soft": rod(SOFT), "table 1": rod(TABLE_1), "tube": shell(0), "bent tube": shell(1)}


def transfer(system, frequencies):
    """Output over its value at rest: the dense matrices solved at each frequency in rad/s."""
    mass, damping, stiffness, load, output = system
    rest = output @ np.linalg.solve(stiffness, load)
    return np.array(
        [output @ np.linalg.solve(stiffness + s * damping + s**2 * mass, load) / rest for s in 1j * frequencies]
    )


def of_sections(found, frequencies):
    omega, zeta, share, speed = (each[:, None] for each in found)
    s = 1j * frequencies / omega
    x = 1 / (1 + 2 * zeta * s + s**2)
    return 1 - share.sum() + (share * x + speed * s * x).sum(axis=0)


@pytest.mark.parametrize("order", [1, 2, 4])
@pytest.mark.parametrize("name", SYSTEMS)
def test_error_is_within_the_bound_at_every_frequency(name, order):
    """2 sum sigma_i of what is left out, and not far below it; 1e-7 of rounding where nothing is."""
    system = SYSTEMS[name]
    found, values = _balanced.balanced(order, *system)
    slowest = _linear.modes(system[0], system[2])[0][0]
    grid = np.concatenate([[0], slowest * np.logspace(-2, 3, 400)])
    error = np.abs(of_sections(found, grid) - transfer(system, grid))
    bound = 2 * values[2 * order :].sum()
    assert error.max() <= bound + 1e-7
    assert error[0] < 1e-9
    if bound > 1e-5:
        assert error.max() > 0.05 * bound


@pytest.mark.parametrize("name", SYSTEMS)
def test_sections_of_a_reduced_body_are_stable(name):
    for order in (1, 2, 3, 6):
        omega, zeta, *_ = _balanced.balanced(order, *SYSTEMS[name])[0]
        assert omega.size == order and (omega > 0).all() and (zeta > 0).all()


def test_first_hankel_values_are_those_of_the_step_response_operator():
    """Of 3 elements: the singular values of the Hankel matrix of a fine discretisation, with gramians by sums."""
    system = rod(elements=3)
    mass, damping, stiffness, load, output = system
    inverse, still = np.linalg.inv(mass), np.zeros((3, 3))
    a = np.block([[still, np.eye(3)], [-inverse @ stiffness, -inverse @ damping]])
    b = np.concatenate([np.zeros(3), inverse @ load]) / (output @ np.linalg.solve(stiffness, load))
    dt, steps = 2e-7, 2**15
    states, step = [expm(a * dt / 2) @ b], expm(a * dt)
    outputs = [np.concatenate([output, np.zeros(3)]) @ expm(a * dt / 2)]
    for _ in range(steps):
        states.append(step @ states[-1])
        outputs.append(outputs[-1] @ step)
    reached, seen = (np.array(each).T @ np.array(each) * dt for each in (states, outputs))
    expected = np.sqrt(np.sort(np.linalg.eigvals(reached @ seen).real)[::-1])
    np.testing.assert_allclose(_balanced.balanced(1, *system)[1], expected, rtol=2e-3)


@pytest.mark.parametrize(("word", "given"), [("rod", ROD), ("shell", TUBE)])
def test_a_reduced_body_moves_like_the_whole_one(word, given):
    """Root mean square within the bound, of a force over a rest at both ends."""
    rng = np.random.default_rng(1)
    force = np.concatenate([np.zeros(10), rng.normal(size=400).cumsum() * np.hanning(400), np.zeros(600)])
    parts = []
    for full, settings in ((word, {"elements": 18, "modes": 6}), (f"{word}_reduced", {"elements": 18, "order": 3})):
        known = {f"{full}.{name}": value for name, value in given.items()}
        parts.append(response([blocks[full].make(**settings)], known, force, dt=2e-6))
    system = rod(elements=18) if word == "rod" else shell(0)
    bound = 2 * _balanced.balanced(3, *system)[1][6:].sum()
    off = np.sqrt(np.sum((parts[0] - parts[1]) ** 2) / np.sum(force**2))
    assert 0 < off < bound + 2e-3


def test_an_order_beyond_the_elements_is_refused():
    with pytest.raises(InputError, match="3 elements do not have 4 sections") as raised:
        blocks["rod_reduced"].make(elements=3, order=4)
    assert "elements: 8" in raised.value.remedy
