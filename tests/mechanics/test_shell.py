"""The shell against closed forms: membrane, rod and beam, a shell on diaphragms, and one dense system."""

from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import eigh

from pzt_ident.errors import InputError
from pzt_ident.mechanics import _linear, _shell
from pzt_ident.model.registry import blocks
from rig import response
from twins import modal_twin

TUBE = {
    "density": 7600.0,
    "modulus": 7.1e10,
    "viscosity": 1e5,
    "length": 0.0396,
    "radius": 0.0056,
    "thickness": 0.0015,
    "poisson": 0.3,
    "end_mass": 0.0,
}
"""Smith et al., the cylindrical actuator."""
DIAPHRAGMS = ((0, 0), (1, 1), (1, 1))
"""v = w = 0 at both ends, u free."""


def matrices(elements=12, harmonic=0, left_out=_shell.CLAMPED, **other):
    own = SimpleNamespace(**(TUBE | other), load=0.0, elements=elements, harmonic=harmonic)
    return _shell.matrices(own, left_out)


def frequencies(*given, **more):
    """Hz, slowest first."""
    mass, _, stiffness, *_ = matrices(*given, **more)
    return np.sqrt(eigh(stiffness, mass, eigvals_only=True)) / (2 * np.pi)


def lengthening(elements, **other):
    """Displacement of the end over that of a membrane, l a1 (P - P_R) / Y."""
    _, _, stiffness, load, output = matrices(elements, **other)
    return output @ np.linalg.solve(stiffness, load) * TUBE["modulus"] / TUBE["length"]


def test_clamping_lengthens_the_tube():
    """By 1.7 % for nu = 0.3, which 12 elements have to 5e-4; without Poisson's ratio it is a membrane exactly."""
    assert lengthening(48) == pytest.approx(1.0171, abs=5e-5)
    assert lengthening(12) == pytest.approx(lengthening(48), abs=5e-4)
    assert lengthening(12, poisson=0.0) == pytest.approx(1, rel=1e-12)
    errors = [lengthening(n) - lengthening(60) for n in (12, 24)]
    assert errors[0] > 12 * errors[1] > 0


def test_axisymmetric_frequencies_without_poisson_are_those_of_rod_and_beam():
    """(i - 1/2) c / 2 l, and w^2 = c^2 / R^2 + D b^4 / (rho h) with b l = 1.8751, 4.6941, 7.8548 of a cantilever."""
    c = np.sqrt(TUBE["modulus"] / TUBE["density"])
    rod = (np.arange(6) + 0.5) * c / (2 * TUBE["length"])
    beta = np.array([1.8751040687, 4.6940911330, 7.8547574382]) / TUBE["length"]
    bend = TUBE["modulus"] * TUBE["thickness"] ** 2 / (12 * TUBE["density"])
    beam = np.sqrt((c / TUBE["radius"]) ** 2 + bend * beta**4) / (2 * np.pi)
    expected = np.sort(np.concatenate([rod, beam]))[:5]
    errors = np.array([frequencies(n, poisson=0.0)[:5] / expected - 1 for n in (12, 24)])
    np.testing.assert_allclose(errors[0], 0, atol=2e-5)
    assert np.all((errors[1] < errors[0] / 12) | (errors[1] < 1e-9))


def on_diaphragms(half_waves, harmonic):
    """The three natural frequencies of each shape cos k x, sin k x, sin k x, in Hz: Donnell's closed form."""
    found = []
    nu, r = TUBE["poisson"], TUBE["radius"]
    stretch = TUBE["modulus"] * TUBE["thickness"] / (1 - nu**2)
    bend, m = stretch * TUBE["thickness"] ** 2 / 12, harmonic / r
    for k in np.arange(1, half_waves + 1) * np.pi / TUBE["length"]:
        uu, vv = k**2 + (1 - nu) / 2 * m**2, m**2 + (1 - nu) / 2 * k**2
        uv, uw, vw = -(1 + nu) / 2 * k * m, -nu * k / r, m / r
        form = stretch * np.array([[uu, uv, uw], [uv, vv, vw], [uw, vw, 1 / r**2]])
        form[2, 2] += bend * (k**2 + m**2) ** 2
        found += [*np.sqrt(np.linalg.eigvalsh(form) / (TUBE["density"] * TUBE["thickness"])) / (2 * np.pi)]
    return np.sort(found)


@pytest.mark.parametrize("harmonic", [1, 2, 3, 7])
def test_higher_circumferential_modes_converge_to_the_closed_form(harmonic):
    """On diaphragms, to fourth order and better; axial shapes without v and w are on the list too."""
    exact = on_diaphragms(8, harmonic)[:4]
    errors = []
    for n in (6, 12, 24):
        found = frequencies(n, harmonic, DIAPHRAGMS)
        errors.append([np.abs(found / each - 1).min() for each in exact])
    errors = np.array(errors)
    assert errors[1].max() < 1e-3 and errors[2].max() < 5e-5
    assert np.all((errors[1:] < errors[:-1] / 12) | (errors[1:] < 1e-9))


def test_donnell_resists_the_shift_of_a_section():
    """v = -sin, w = cos is no deformation, but D / R^4 of energy a length in Donnell's curvature."""
    _, _, stiffness, *_ = matrices(6, 1, ((0, 0), (0, 0), (0, 0)))
    shift = np.concatenate([np.zeros(9), -np.ones(9), np.ones(9)])
    bend = TUBE["modulus"] * TUBE["thickness"] ** 3 / (12 * (1 - TUBE["poisson"] ** 2))
    assert shift @ stiffness @ shift == pytest.approx(bend * TUBE["length"] / TUBE["radius"] ** 4, rel=1e-9)


def test_a_thin_long_tube_bends_as_a_beam():
    """1.8751^2 sqrt(Y / rho) R / sqrt(2) / (2 pi l^2), where shear and Donnell's error are small."""
    long = {"length": 0.1, "radius": 0.004, "thickness": 1e-5, "poisson": 0.0}
    beam = 1.8751040687**2 * np.sqrt(TUBE["modulus"] / TUBE["density"] / 2) * 0.004 / 0.1**2 / (2 * np.pi)
    assert frequencies(24, 1, **long)[0] == pytest.approx(beam, rel=0.02)


def test_a_heavy_end_is_one_mass_on_the_spring_of_the_tube():
    _, _, stiffness, _, output = matrices(12, end_mass=5.0)
    spring = 2 * np.pi * TUBE["radius"] / (output @ np.linalg.solve(stiffness, output))
    assert frequencies(12, end_mass=5.0)[0] == pytest.approx(np.sqrt(spring / 5.0) / (2 * np.pi), rel=1e-3)
    membrane = TUBE["modulus"] * 2 * np.pi * TUBE["radius"] * TUBE["thickness"] / TUBE["length"]
    assert spring == pytest.approx(membrane, rel=0.03)


@pytest.mark.parametrize("harmonic", [0, 1, 4])
def test_forms_are_well_posed_with_the_closed_constants(harmonic):
    """H1 to H5: all damping is inside, so sigma2 = C / Y sigma1."""
    _, damping, stiffness, *_ = matrices(8, harmonic)
    found = _linear.forms(damping, stiffness, stiffness)
    assert (found.c1, found.c2) == pytest.approx((1, 1)) and found.skew < 1e-9
    assert (found.c3, found.c4) == pytest.approx((1e5 / 7.1e10, 1e5 / 7.1e10), rel=1e-6)


@pytest.mark.parametrize("harmonic", [0, 1])
def test_sections_are_the_whole_system(harmonic):
    """All modes of 4 elements against one dense system, some of them beyond a megahertz."""
    mass, damping, stiffness, load, output = matrices(4, harmonic)
    squares, shapes = eigh(stiffness, mass)
    omega = np.sqrt(squares)
    share = (output @ shapes) * (load @ shapes) / squares
    share /= share.sum()
    zeta = np.einsum("ij,ik,kj->j", shapes, damping, shapes) / (2 * omega)
    force, dt = np.random.default_rng(1).normal(size=200).cumsum(), 2e-6
    expected = modal_twin.modal(force[None], dt, omega / (2 * np.pi), zeta, np.ones((1, omega.size)), share[None])[0]
    known = {f"shell.{word}": value for word, value in TUBE.items()}
    found = response([blocks["shell"].make(elements=4, harmonic=harmonic, modes=2)], known, force, dt=dt)
    kept = modal_twin.modal(force[None], dt, omega[:2] / (2 * np.pi), zeta[:2], np.ones((1, 2)), share[None, :2])[0]
    np.testing.assert_allclose(found, kept + (1 - share[:2].sum()) * force, rtol=0, atol=1e-9 * np.ptp(force))
    assert 1e-3 < np.abs(found - expected).max() / np.ptp(force) < 0.2


def test_too_few_elements_for_a_mode_are_refused():
    with pytest.raises(InputError, match="12 elements are too few for mode 7"):
        blocks["shell"].make(modes=7)
    for harmonic, elements in product((0, 1, 2), (2, 6, 12)):
        modes = elements // 2
        assert np.all(frequencies(elements, harmonic)[:modes] / frequencies(48, harmonic)[:modes] < 1.05)
