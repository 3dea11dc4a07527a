"""The distributed rod against its dense twin, closed forms, and the numbers of the paper."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from pzt_ident.errors import InputError
from pzt_ident.mechanics import _linear, _rod
from pzt_ident.model.registry import blocks
from rig import response
from twins import lumped_twin, rod_twin

TABLE_1 = {
    "density": 7600.0,
    "area": 2.5e-5,
    "length": 0.02,
    "modulus": 7e10,
    "viscosity": 5e6,
    "end_mass": 4.015,
    "end_damping": 440.0,
    "end_stiffness": 8.49e-5,
}
REPAIRED = TABLE_1 | {"viscosity": 1.2125e8, "end_mass": 4.2062}
"""Smith et al., Table 1, the distributed row; and as it must be for eq. 22 to give the lumped row."""
FREE = TABLE_1 | {"viscosity": 2e4, "end_mass": 0.0, "end_damping": 0.0, "end_stiffness": 0.0}
SOFT = TABLE_1 | {"viscosity": 2e4, "end_mass": 2e-3, "end_damping": 50.0, "end_stiffness": 3e7}

HEAVY = FREE | {"end_mass": 0.03}


def end(word, rod, force, dt, **settings):
    """Displacement of the end; `force` as the displacement that it holds at rest."""
    known = {f"{word}.{name}": value for name, value in rod.items()}
    return response([blocks[word].make(**settings)], known, force, dt=dt)


def stiffness(rod):
    return rod["modulus"] * rod["area"] / rod["length"] + rod["end_stiffness"]


def sections(rod, elements, modes=0):
    return blocks["rod"].solve(own(rod, elements, modes))


def own(rod, elements, modes=0):
    """What a candidate's `solve` is given."""
    return SimpleNamespace(**rod, load=0.0, extra_damping=0.0, elements=elements, modes=modes)


def lumped(rod):
    """Mass, damping and stiffness by eq. 22."""
    mass = rod["density"] * rod["area"] * rod["length"] + rod["end_mass"]
    damping = rod["viscosity"] * rod["area"] / rod["length"] + rod["end_damping"]
    return mass, damping, stiffness(rod)


def walk(seed, samples=300):
    return np.random.default_rng(seed).normal(size=samples).cumsum()


@pytest.mark.parametrize("elements", [1, 2, 8])
@pytest.mark.parametrize("rod", [TABLE_1, REPAIRED, FREE, SOFT], ids=["table 1", "repaired", "free", "soft"])
@pytest.mark.parametrize("word", ["rod", "rod_trapezoid"])
def test_sections_in_parallel_are_the_whole_state(word, rod, elements):
    """Between them a twin of 16 states, its exponential good to 1e-9 where eigenvalues are 1e6 apart."""
    for dt in (2e-6, 1e-3):
        force = walk(1)
        step = {"rod": rod_twin.exact, "rod_trapezoid": rod_twin.trapezoid}[word]
        expected = step(elements, rod, stiffness(rod) * force, dt)
        found = end(word, rod, force, dt, elements=elements)
        np.testing.assert_allclose(found, expected, rtol=0, atol=2e-9 * np.ptp(force))


@pytest.mark.parametrize("word", ["rod", "rod_trapezoid"])
def test_at_rest_under_a_constant_force(word):
    np.testing.assert_array_equal(end(word, SOFT, np.full(300, 7.3), 1e-3), 7.3)


def test_trapezoid_is_of_second_order():
    """Halving the step divides the error by four; two periods of 5 kHz that begin smoothly, the first mode at 8 kHz."""
    fine = np.sin(2 * np.pi * np.linspace(0, 1, 12801)) ** 4
    truth = end("rod", HEAVY, fine, 2e-4 / 12800)
    errors = []
    for step in (32, 16, 8):
        found = end("rod_trapezoid", HEAVY, fine[::step], step * 2e-4 / 12800)
        errors.append(np.abs(found - truth[::step]).max())
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2, atol=0.05)


def wave_numbers(rod, count):
    """Roots of the free vibration of the continuous rod, omega = c k: a mass and a spring at the end."""
    c = np.sqrt(rod["modulus"] / rod["density"])
    axial = rod["modulus"] * rod["area"]

    def balance(k):
        ends = rod["end_stiffness"] - rod["end_mass"] * (c * k) ** 2
        return axial * k * np.cos(k * rod["length"]) + ends * np.sin(k * rod["length"])

    edges = np.pi * (np.arange(count + 1)) / rod["length"]
    return np.array([brentq(balance, low + 1e-9, high) for low, high in pairwise(edges)])


@pytest.mark.parametrize("rod", [FREE, SOFT, HEAVY], ids=["free", "soft", "heavy"])
def test_natural_frequencies_converge_with_the_square_of_the_element(rod):
    """From above to those of the wave equation."""
    rod = rod | {"end_damping": 0.0, "viscosity": 1e-3}
    exact = np.sqrt(rod["modulus"] / rod["density"]) * wave_numbers(rod, 3)
    errors = np.array([sections(rod, n)[0][:3] / exact - 1 for n in (8, 16, 32)])
    assert (errors > 0).all()
    np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), 2, atol=0.05)


def test_a_free_end_has_the_closed_frequencies():
    """(i - 1/2) pi c / l, of which N elements miss (k l / N)^2 / 24."""
    k = (np.arange(3) + 0.5) * np.pi / FREE["length"]
    np.testing.assert_allclose(wave_numbers(FREE, 3), k, rtol=1e-12)
    closed = k * np.sqrt(FREE["modulus"] / FREE["density"])
    errors = sections(FREE, 32)[0][:3] / closed - 1
    np.testing.assert_allclose(errors, (k * FREE["length"] / 32) ** 2 / 24, rtol=0.01)


@pytest.mark.parametrize("elements", [1, 2, 5, 40])
def test_static_deflection_is_exact_for_any_number_of_elements(elements):
    """u(l) = F l / (Y A) for the free end, and F / (Y A / l + k_l): the strain is the same everywhere."""
    for rod in (FREE, SOFT):
        for found, expected in zip(_rod.matrices(own(rod, elements)), rod_twin.matrices(elements, rod), strict=True):
            np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-13 * expected.max())
        deflection = np.linalg.solve(found, np.eye(elements)[-1])[-1]
        assert deflection == pytest.approx(1 / stiffness(rod), rel=1e-11)
        assert sections(rod, elements)[2].sum() == pytest.approx(1, abs=1e-10)


def test_lumped_rod_is_lumped_mechanics_by_equation_22():
    """Table 1's distributed row gives m = 4.0188, c = 6690, not what its lumped row prints; the repaired one does."""
    assert lumped(TABLE_1) == pytest.approx((4.0188, 6690, 8.75e7), rel=1e-4)
    assert lumped(REPAIRED) == pytest.approx((4.21, 1.52e5, 8.75e7), rel=1e-4)
    for rod in (TABLE_1, REPAIRED, SOFT):
        expected = lumped_twin.lumped(walk(2), 1e-4, *lumped(rod))
        found = end("lumped_rod", rod, walk(2), 1e-4)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.ptp(walk(2)))


def test_table_1_is_damped_as_it_says():
    """The lumped row is overdamped, zeta = 3.96 at 726 Hz; eq. 22 gives 743 Hz and 0.178."""
    for rod, hertz, ratio in ((REPAIRED, 726, 3.96), (TABLE_1, 743, 0.178)):
        mass, damping, spring = lumped(rod)
        assert np.sqrt(spring / mass) / (2 * np.pi) == pytest.approx(hertz, rel=1e-3)
        assert damping / (2 * np.sqrt(spring * mass)) == pytest.approx(ratio, rel=3e-3)


def sine(hertz, dt):
    """Displacements of 100 um, 8 periods from the lowest point: the span of Smith et al., Fig. 10."""
    return 50e-6 * (1 - np.cos(2 * np.pi * hertz * dt * np.arange(round(8 / (hertz * dt)))))


@pytest.mark.parametrize(("hertz", "dt", "most"), [(1, 1e-3, 5e-12), (27.9, 1e-4, 1e-10)])
def test_rod_and_lumped_rod_are_one_by_the_same_stepper(hertz, dt, most):
    """The two models of the paper differ by far less than the 5e-10 m of its Fig. 12."""
    force = sine(hertz, dt)
    mass, damping, spring = lumped(TABLE_1)
    one = TABLE_1 | {"density": 1e-9, "end_mass": mass, "viscosity": 1e-9, "end_damping": damping}
    distributed = end("rod_trapezoid", TABLE_1, force, dt)
    together = end("rod_trapezoid", one | {"modulus": spring * 800, "end_stiffness": 0.0}, force, dt, elements=1)
    assert np.abs(distributed - together).max() < most


@pytest.mark.parametrize("rod", [TABLE_1, REPAIRED], ids=["eq. 22", "repaired"])
@pytest.mark.parametrize("hertz", [0.279, 0.5])
def test_figure_12_shows_the_error_of_the_step(rod, hertz):
    """The trapezoid of 1 ms against the exact lumped model, up to 0.5 Hz: at most 6e-10 m, most of it the step's."""
    force = sine(hertz, 1e-3)
    exact = end("lumped_rod", rod, force, 1e-3)
    shown = np.abs(end("rod_trapezoid", rod, force, 1e-3) - exact).max()
    assert 1e-11 < shown <= 6e-10
    assert np.abs(end("rod", rod, force, 1e-3) - exact).max() < 0.1 * shown


def test_two_elements_do_as_well_as_eight():
    force = sine(1, 1e-3)
    assert np.abs(np.subtract(*(end("rod", TABLE_1, force, 1e-3, elements=n) for n in (2, 8)))).max() < 1e-14


@settings(deadline=None, max_examples=40, derandomize=True)
@given(st.integers(1, 12), st.floats(2, 9), st.floats(0, 1e5), st.floats(0, 1e8), st.floats(0, 1))
def test_every_section_is_stable_and_all_hold_the_force(elements, viscosity, damper, spring, mass):
    rod = TABLE_1 | {"viscosity": 10**viscosity, "end_damping": damper, "end_stiffness": spring, "end_mass": mass}
    omega, zeta, share, _ = sections(rod, elements)
    assert (omega > 0).all() and (zeta > 0).all() and (np.diff(omega) >= 0).all()
    assert share.sum() == pytest.approx(1, abs=1e-6)


def test_higher_modes_left_out_follow_at_rest():
    """Of a slow force all that is seen of them; the first of the frequencies is kept as it is."""
    force = np.sin(2 * np.pi * 500 * 1e-5 * np.arange(2000)) ** 3
    whole, part = (end("rod", SOFT, force, 1e-5, elements=9, modes=modes) for modes in (0, 1))
    assert 0 < np.abs(whole - part).max() < 1e-3
    np.testing.assert_array_equal(sections(SOFT, 9, 3)[0], sections(SOFT, 9)[0][:3])


@pytest.mark.parametrize("elements", [2, 8, 40])
@pytest.mark.parametrize("rod", [TABLE_1, REPAIRED, SOFT, FREE], ids=["table 1", "repaired", "soft", "free"])
def test_forms_are_well_posed_with_the_closed_constants(rod, elements):
    """H1 to H5: c1 = c2 = 1 where the inner product of V is sigma1. Of sigma2, C A / (Y A + k l) and C / Y + c l / Y A
    bound c4 and c3 for every rod, as |u(l)|^2 <= l int u'^2, and are reached without a spring, c3 by u = x."""
    _, damping, spring = _rod.matrices(own(rod, elements))
    found = _linear.forms(damping, spring, spring)
    assert found.c1 == pytest.approx(1) and found.c2 == pytest.approx(1) and found.skew < 1e-12
    axial = rod["modulus"] * rod["area"]
    low = rod["viscosity"] * rod["area"] / (axial + rod["end_stiffness"] * rod["length"])
    high = rod["viscosity"] / rod["modulus"] + rod["end_damping"] * rod["length"] / axial
    assert low * (1 - 1e-9) <= found.c4 <= found.c3 <= high * (1 + 1e-9)
    if rod["end_stiffness"] < 1:
        assert (found.c4, found.c3) == pytest.approx((low, high), rel=1e-9)


def test_constants_of_table_1():
    _, damping, spring = _rod.matrices(own(TABLE_1, 8))
    found = _linear.forms(damping, spring, spring)
    assert (found.c4, found.c3) == pytest.approx((7.142857e-5, 7.645714e-5), rel=1e-6)


def test_without_damping_sigma2_is_not_elliptic():
    _, damping, spring = _rod.matrices(own(TABLE_1 | {"viscosity": 0.0}, 8))
    assert _linear.forms(damping, spring, spring).c4 == pytest.approx(0, abs=1e-15)


def test_forms_see_what_is_not_symmetric():
    spring = _rod.matrices(own(FREE, 3))[2]
    turned = spring + spring.max() * np.triu(np.ones((3, 3)), 1) - spring.max() * np.tril(np.ones((3, 3)), -1)
    found = _linear.forms(spring, turned, spring)
    assert found.skew > 0.1 and found.c1 > 1.1 and found.c2 == pytest.approx(1)


def test_too_few_elements_for_a_mode_are_refused():
    with pytest.raises(InputError, match="8 elements are too few for mode 3") as raised:
        blocks["rod"].make(modes=3)
    assert "elements: 9" in raised.value.remedy
    exact = np.sqrt(FREE["modulus"] / FREE["density"]) * wave_numbers(FREE, 3)
    assert sections(FREE, 9, 3)[0][-1] / exact[-1] - 1 < 0.05


@pytest.mark.parametrize("value", [0, 101, 2.5, True, "two"])
def test_number_of_elements_is_a_whole_number(value):
    with pytest.raises(InputError, match="whole number from 1 to 100") as raised:
        blocks["rod"].make(elements=value)
    assert raised.value.where == "rod.elements"
